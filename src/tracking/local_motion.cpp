#include "camera_self_calibration/tracking/local_motion.h"

#include <array>
#include <cmath>
#include <numeric>

#include "camera_self_calibration/base/cpu_clones.h"
#include "camera_self_calibration/base/median.h"

namespace camera_self_calibration {
namespace {

// Far pairs count a little, so that a lonely point follows the image as a whole.
constexpr float kFarWeight = 0.02f;
constexpr std::size_t kMinPairs = 6;
constexpr double kMinMiss = 1.0;  // [px] Up to here nothing is an outlier.

constexpr std::size_t kLanes = 8;
enum Moment { kSum, kFromX, kFromY, kToX, kToY, kSquares, kDots, kCrosses, kMoments };

// Weighted sums about (x, y), of each lane.
SELFCAL_CPU_CLONES void sumUp(const float* from_x, const float* from_y, const float* to_x,
                              const float* to_y, const float* weights, std::size_t count, float x,
                              float y, float nearness, float (*sums)[kLanes]) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float px = from_x[i + lane] - x, py = from_y[i + lane] - y;
      const float qx = to_x[i + lane] - x, qy = to_y[i + lane] - y;
      const float square = px * px + py * py;
      const float far = square * nearness;
      const float w = weights[i + lane] * (kFarWeight + 1.0f / (1.0f + far * far));
      sums[kSum][lane] += w;
      sums[kFromX][lane] += w * px;
      sums[kFromY][lane] += w * py;
      sums[kToX][lane] += w * qx;
      sums[kToY][lane] += w * qy;
      sums[kSquares][lane] += w * square;
      sums[kDots][lane] += w * (px * qx + py * qy);
      sums[kCrosses][lane] += w * (px * qy - py * qx);
    }
  }
}

}  // namespace

void LocalMotion::clear() {
  count_ = 0;
  for (auto* values : {&from_x_, &from_y_, &to_x_, &to_y_, &weights_}) values->clear();
}

void LocalMotion::add(const cv::Point2f& from, const cv::Point2f& to) {
  if (count_ == weights_.size()) {
    for (auto* values : {&from_x_, &from_y_, &to_x_, &to_y_, &weights_}) {
      values->resize(count_ + kLanes, 0.0f);
    }
  }
  from_x_[count_] = from.x;
  from_y_[count_] = from.y;
  to_x_[count_] = to.x;
  to_y_[count_] = to.y;
  weights_[count_++] = 1.0f;
}

// Distance of a feature from where it is expected.
double LocalMotion::miss(std::size_t i) const {
  const Eigen::Vector2d expected = at({from_x_[i], from_y_[i]}).pixel;
  return (expected - Eigen::Vector2d(to_x_[i], to_y_[i])).norm();
}

bool LocalMotion::expectsMoreThan(int count) const {
  if (count_ < kMinPairs) return false;
  int expected = 0;
  for (std::size_t i = 0; i < count_ && expected <= count; ++i) expected += miss(i) < kMinMiss;
  return expected > count;
}

void LocalMotion::weighOutliers() {
  scatter_ = 0.0;
  if (count_ < kMinPairs) return;
  misses_.clear();
  for (std::size_t i = 0; i < count_; ++i) misses_.push_back(miss(i));
  sorted_ = misses_;
  scatter_ = 2.0 * medianInPlace(&sorted_) + kMinMiss;
  for (std::size_t i = 0; i < count_; ++i) {
    const double square = misses_[i] * misses_[i] / (scatter_ * scatter_);
    weights_[i] = static_cast<float>(1.0 / (1.0 + square * square));
  }
}

LocalMotion::Motion LocalMotion::at(const Eigen::Vector2d& pixel) const {
  if (count_ < kMinPairs) return {pixel, Eigen::Matrix2d::Identity()};
  alignas(32) float lanes[kMoments][kLanes] = {};
  sumUp(from_x_.data(), from_y_.data(), to_x_.data(), to_y_.data(), weights_.data(),
        weights_.size(), static_cast<float>(pixel.x()), static_cast<float>(pixel.y()),
        static_cast<float>(1.0 / (reach_ * reach_)), lanes);
  std::array<double, kMoments> moments{};
  for (int k = 0; k < kMoments; ++k) {
    moments[k] = std::accumulate(std::begin(lanes[k]), std::end(lanes[k]), 0.0);
  }
  // Least squares for to - mean = [a -b; b a] (from - mean), by moments about the pixel.
  const double sum = moments[kSum];
  const Eigen::Vector2d from = Eigen::Vector2d(moments[kFromX], moments[kFromY]) / sum;
  const Eigen::Vector2d to = Eigen::Vector2d(moments[kToX], moments[kToY]) / sum;
  const double spread = 1e-9 + moments[kSquares] - sum * from.squaredNorm();
  const double a = moments[kDots] - sum * from.dot(to);
  const double b = moments[kCrosses] - sum * (from.x() * to.y() - from.y() * to.x());
  Motion motion;
  motion.linear << a, -b, b, a;
  motion.linear /= spread;
  motion.pixel = pixel + to - motion.linear * from;
  return motion;
}

}  // namespace camera_self_calibration
