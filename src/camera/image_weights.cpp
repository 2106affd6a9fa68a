#include "camera_self_calibration/camera/image_weights.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace camera_self_calibration {
namespace {

int nearest(double pixel, int size, int points) {
  return static_cast<int>(std::lround(std::clamp(pixel / (size - 1.0), 0.0, 1.0) * (points - 1)));
}

}  // namespace

void ImageWeights::count(const Eigen::Vector2d& pixel) {
  if (!pixel.allFinite()) return;
  weights_[index(nearest(pixel.x(), width_, ImageField::kColumns),
                 nearest(pixel.y(), height_, ImageField::kRows))] += 1.0F;
}

double ImageWeights::sum() const { return std::accumulate(weights_.begin(), weights_.end(), 0.0); }

double ImageWeights::distance(std::size_t i, const Eigen::Vector2d& centre) const {
  const int column = static_cast<int>(i) % ImageField::kColumns;
  const int row = static_cast<int>(i) / ImageField::kColumns;
  return (ImageField::pixel(column, row, width_, height_) - centre).norm();
}

double ImageWeights::radiusHolding(double share, const Eigen::Vector2d& centre) const {
  std::vector<std::size_t> order(weights_.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return distance(a, centre) < distance(b, centre);
  });
  const double wanted = share * sum();
  double held = 0.0;
  for (const std::size_t i : order) {
    held += weights_[i];
    if (held >= wanted) return distance(i, centre);
  }
  return distance(order.back(), centre);
}

ImageWeights ImageWeights::within(double radius_px, const Eigen::Vector2d& centre) const {
  ImageWeights result = *this;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    if (distance(i, centre) > radius_px) result.weights_[i] = 0.0F;
  }
  return result;
}

ImageWeights ImageWeights::beyond(double radius_px, const Eigen::Vector2d& centre) const {
  ImageWeights result = *this;
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    if (distance(i, centre) <= radius_px) result.weights_[i] = 0.0F;
  }
  return result;
}

}  // namespace camera_self_calibration
