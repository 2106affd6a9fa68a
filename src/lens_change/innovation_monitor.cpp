#include "camera_self_calibration/lens_change/innovation_monitor.h"

#include <algorithm>
#include <cmath>

namespace camera_self_calibration {
namespace {

// A suspicion that is for nothing costs a closer look, so that these set time spent, not errors.
constexpr int kFramesToLearn = 10;  // a spread from so many is good to a quarter
constexpr double kMemory = 200.0;   // frames over which mean and spread are formed: ten seconds
// Of a logarithm: what chance does to the median of some 100 residuals.
constexpr double kLeastSpread = 0.08;
// Spreads above the mean that do not count: half of the smallest step that is to be seen, as usual
// for a cumulative sum (Page 1954).
constexpr double kAllowance = 1.5;
constexpr double kMaxStep = 6.0;  // spreads that one frame may add, and
constexpr double kLimit = 10.0;   // that make a suspicion: one bad frame is none

}  // namespace

bool InnovationMonitor::add(std::int64_t stamp_ns, double residual_scale) {
  if (suspicious_ || !(residual_scale > 0.0) || !std::isfinite(residual_scale)) return suspicious_;
  const double value = std::log(residual_scale);
  if (frames_ >= kFramesToLearn) {
    const double spread = std::max(spread_, kLeastSpread);
    if (sum_ <= 0.0) onset_ns_ = stamp_ns;
    sum_ += std::min(kMaxStep, (value - mean_) / spread - kAllowance);
    sum_ = std::max(0.0, sum_);
    if (sum_ > kLimit) {
      suspicious_ = true;
      return true;
    }
  }
  // What is already in doubt teaches little of what is usual.
  const double share = 1.0 / std::min(kMemory, ++frames_ + 0.0) / (1.0 + sum_);
  mean_ += share * (value - mean_);
  spread_ += share * (std::abs(value - mean_) - spread_);
  return false;
}

}  // namespace camera_self_calibration
