#include "camera_self_calibration/base/frame_clock.h"

#include <algorithm>

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kSecond = 1000000000;
constexpr int kGapPeriods = 5;
constexpr std::size_t kEnough = 5;  // Steps from which a median is believed.

}  // namespace

FrameClock::Step FrameClock::add(std::int64_t step_ns) {
  const std::int64_t usual = period();
  Step step;
  step.gap = step_ns > kSecond && step_ns > kGapPeriods * usual;
  // Half a period of jitter is no missing image.
  if (usual > 0 && !step.gap && 2 * step_ns > 3 * usual) {
    step.missed = static_cast<int>((step_ns + usual / 2) / usual) - 1;
  }
  if (!step.gap) steps_[count_++ % steps_.size()] = step_ns;
  return step;
}

std::int64_t FrameClock::period() const {
  const std::size_t known = std::min(count_, steps_.size());
  if (known < kEnough) return 0;
  std::vector<std::int64_t> sorted = steps_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(known / 2);
  std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(known));
  // The mean of the usual steps, since jitter makes the median lean to one side.
  std::int64_t sum = 0;
  std::int64_t usual = 0;
  for (std::size_t i = 0; i < known; ++i) {
    if (2 * steps_[i] > 3 * *middle) continue;
    sum += steps_[i];
    ++usual;
  }
  return sum / usual;
}

double FrameClock::rate() const {
  const std::int64_t usual = period();
  return usual > 0 ? static_cast<double>(kSecond) / static_cast<double>(usual) : 0.0;
}

}  // namespace camera_self_calibration
