#include "camera_self_calibration/tracking/secant_steps.h"

#include <cmath>

namespace camera_self_calibration {
namespace {

constexpr double kMaxStretch = 4.0;      // Of a step by what was learned.
constexpr double kMinDenominator = 0.1;  // Of the update, against the square of the step.
constexpr double kLinearScale = 4.0;     // [px] Makes the linear part a displacement, as the shift.

}  // namespace

WarpStep SecantSteps::next(const WarpStep& proposed) {
  WarpStep step = proposed;
  step.tail<4>() *= kLinearScale;
  if (started_) {
    learn(step);
  } else {
    inverse_.setIdentity();
    started_ = true;
  }
  last_proposed_ = step;
  last_taken_ = inverse_ * step;
  const double limit = kMaxStretch * step.norm();
  if (last_taken_.norm() > limit) last_taken_ *= limit / last_taken_.norm();
  WarpStep taken = last_taken_;
  taken.tail<4>() /= kLinearScale;
  return taken;
}

void SecantSteps::learn(const WarpStep& proposed) {
  const WarpStep change = last_proposed_ - proposed;
  const WarpStep row = inverse_.transpose() * last_taken_;
  const double denominator = row.dot(change);
  if (std::abs(denominator) < kMinDenominator * last_taken_.squaredNorm()) return;
  inverse_ += (last_taken_ - inverse_ * change) * row.transpose() / denominator;
}

}  // namespace camera_self_calibration
