#pragma once

#include <fuzzer/FuzzedDataProvider.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

namespace camera_self_calibration {

/// Ends the fuzzer, which keeps the input, unless what must hold does.
inline void require(bool holds, const std::string& what) {
  if (holds) return;
  std::cerr << "does not hold: " << what << '\n';
  std::abort();
}

/// Counts an input, and whether it is a sound one, on which more than a refusal is checked. A
/// fuzzer that refuses all of its inputs checks next to nothing, and ends with an error.
inline void countInput(bool sound) {
  struct Count {
    std::int64_t inputs = 0;
    bool any_sound = false;
    ~Count() {
      constexpr int kEnough = 100;  // fewer are a corpus, or an input that is tried again
      if (inputs < kEnough || any_sound) return;
      std::cerr << "does not hold: some inputs are sound\n";
      std::_Exit(1);
    }
  };
  static Count count;
  ++count.inputs;
  count.any_sound = count.any_sound || sound;
}

/// A number that bounds like to be tried with: a plain one, any finite one, or one of those that
/// comparisons and arithmetic forget.
inline double anyNumber(FuzzedDataProvider* data) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  if (!data->ConsumeBool()) return data->ConsumeIntegralInRange<int>(-100000, 100000) * 0.01;
  if (data->ConsumeBool()) return data->ConsumeFloatingPoint<double>();
  return data->PickValueInArray({kInfinity, -kInfinity, kNan, 1e300, -1e300, 1e-320, 0.0});
}

}  // namespace camera_self_calibration
