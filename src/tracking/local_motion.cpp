#include "camera_self_calibration/tracking/local_motion.h"

#include <algorithm>
#include <cmath>

namespace camera_self_calibration {
namespace {

// Far pairs count a little, so that a lonely point follows the image as a whole.
constexpr double kFarWeight = 0.02;
constexpr std::size_t kMinPairs = 6;
constexpr double kMinMiss = 1.0;  // [px] Up to here nothing is an outlier.

}  // namespace

void LocalMotion::weighOutliers() {
  if (pairs_.size() < kMinPairs) return;
  std::vector<double>& misses = misses_;
  misses.clear();
  for (const Pair& pair : pairs_) misses.push_back((at(pair.from).pixel - pair.to).norm());
  sorted_ = misses;
  const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(sorted_.size() / 2);
  std::nth_element(sorted_.begin(), middle, sorted_.end());
  const double scale = 2.0 * *middle + kMinMiss;
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    pairs_[i].weight = 1.0 / (1.0 + std::pow(misses[i] / scale, 4));
  }
}

LocalMotion::Motion LocalMotion::at(const Eigen::Vector2d& pixel) const {
  if (pairs_.size() < kMinPairs) return {pixel, Eigen::Matrix2d::Identity()};
  const auto weigh = [&](const Pair& pair) {
    const double distance2 = (pair.from - pixel).squaredNorm() / (reach_ * reach_);
    return pair.weight * (kFarWeight + 1.0 / (1.0 + distance2 * distance2));
  };
  double sum = 0.0;
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), to = Eigen::Vector2d::Zero();
  for (const Pair& pair : pairs_) {
    const double w = weigh(pair);
    sum += w;
    from += w * pair.from;
    to += w * pair.to;
  }
  from /= sum;
  to /= sum;
  // Least squares for to - mean = [a -b; b a] (from - mean).
  double spread = 1e-9, a = 0.0, b = 0.0;
  for (const Pair& pair : pairs_) {
    const double w = weigh(pair);
    const Eigen::Vector2d p = pair.from - from, q = pair.to - to;
    spread += w * p.squaredNorm();
    a += w * p.dot(q);
    b += w * (p.x() * q.y() - p.y() * q.x());
  }
  Motion motion;
  motion.linear << a, -b, b, a;
  motion.linear /= spread;
  motion.pixel = to + motion.linear * (pixel - from);
  return motion;
}

}  // namespace camera_self_calibration
