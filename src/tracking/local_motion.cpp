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
  // Least squares for to - mean = [a -b; b a] (from - mean), by moments about the pixel.
  double sum = 0.0, squares = 0.0, dots = 0.0, crosses = 0.0;
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), to = Eigen::Vector2d::Zero();
  const double nearness = 1.0 / (reach_ * reach_);
  for (const Pair& pair : pairs_) {
    const Eigen::Vector2d p = pair.from - pixel, q = pair.to - pixel;
    const double distance2 = p.squaredNorm() * nearness;
    const double w = pair.weight * (kFarWeight + 1.0 / (1.0 + distance2 * distance2));
    sum += w;
    from += w * p;
    to += w * q;
    squares += w * p.squaredNorm();
    dots += w * p.dot(q);
    crosses += w * (p.x() * q.y() - p.y() * q.x());
  }
  from /= sum;
  to /= sum;
  const double spread = 1e-9 + squares - sum * from.squaredNorm();
  const double a = dots - sum * from.dot(to);
  const double b = crosses - sum * (from.x() * to.y() - from.y() * to.x());
  Motion motion;
  motion.linear << a, -b, b, a;
  motion.linear /= spread;
  motion.pixel = pixel + to - motion.linear * from;
  return motion;
}

}  // namespace camera_self_calibration
