#pragma once

#include <fuzzer/FuzzedDataProvider.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

namespace camera_self_calibration {

/// Ends the fuzzer, which keeps the input, unless what must hold does.
inline void require(bool holds, const std::string& what) {
  if (holds) return;
  std::cerr << "does not hold: " << what << '\n';
  std::abort();
}

/// A number that bounds like to be tried with: any bits, or a plain one.
inline double anyNumber(FuzzedDataProvider* data) {
  if (data->ConsumeBool()) return data->ConsumeFloatingPoint<double>();
  return data->ConsumeIntegralInRange<int>(-100000, 100000) * 0.01;
}

}  // namespace camera_self_calibration
