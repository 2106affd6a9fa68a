#include "camera_self_calibration/lens_change/innovation_monitor.h"

#include <algorithm>
#include <cmath>

namespace camera_self_calibration {
namespace {

constexpr int kFramesToLearn = 10;
constexpr double kMemory = 200.0;      // frames over which mean and spread are formed
constexpr double kLeastSpread = 0.08;  // of a logarithm: the median of some 100 residuals
constexpr double kAllowance = 1.5;     // spreads above the mean that do not count
constexpr double kMaxStep = 6.0;       // spreads that one frame may add
constexpr double kLimit = 10.0;        // spreads that make a suspicion: two frames at least

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
