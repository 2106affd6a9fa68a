#include "camera_self_calibration/tracking/scene_correlation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "camera_self_calibration/base/median.h"

namespace camera_self_calibration {
namespace {

constexpr int kBlock = 8;             // [px of the level]
constexpr int kLeastSide = 80;        // [px of the level] For enough blocks.
constexpr std::size_t kFewest = 10;   // Blocks that tell, for their median to tell.
constexpr double kMinVariance = 4.0;  // [gray^2] Below lies what noise leaves at this level.

// Sums over the pixels of a block.
struct Sums {
  double count = 0.0, a = 0.0, b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;

  void add(double in_a, double in_b) {
    ++count;
    a += in_a;
    b += in_b;
    aa += in_a * in_a;
    bb += in_b * in_b;
    ab += in_a * in_b;
  }
  double varianceOfA() const { return (aa - a * a / count) / count; }
  double varianceOfB() const { return (bb - b * b / count) / count; }
  double covariance() const { return (ab - a * b / count) / count; }
};

int coarseLevel(const ImagePyramid& image) {
  int level = image.levels() - 1;
  while (level > 0 && std::max(image.level(level).cols, image.level(level).rows) < kLeastSide) {
    --level;
  }
  return level;
}

bool inside(const cv::Mat& image, const Eigen::Vector2d& at) {
  return at.x() >= 0.0 && at.y() >= 0.0 && at.x() <= image.cols - 1 && at.y() <= image.rows - 1;
}

// Of the block from (x, y) on; nothing where most of it left the image, or shows nothing.
std::optional<double> correlationOf(const cv::Mat& before, const cv::Mat& now, int x, int y,
                                    const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                    const Eigen::Matrix2d& linear) {
  Sums sums;
  for (int row = y; row < y + kBlock; ++row) {
    for (int column = x; column < x + kBlock; ++column) {
      const Eigen::Vector2d at = to + linear * (Eigen::Vector2d(column, row) - from);
      if (!inside(now, at)) continue;
      const int nearest_row = static_cast<int>(std::lround(at.y()));
      const int nearest_column = static_cast<int>(std::lround(at.x()));
      sums.add(before.at<unsigned char>(row, column),
               now.at<unsigned char>(nearest_row, nearest_column));
    }
  }
  if (2.0 * sums.count < kBlock * kBlock || sums.varianceOfA() < kMinVariance) return std::nullopt;
  return sums.covariance() / std::sqrt(sums.varianceOfA() * std::max(1.0, sums.varianceOfB()));
}

}  // namespace

double sceneCorrelation(const ImagePyramid& before, const ImagePyramid& now,
                        const LocalMotion& motion) {
  if (before.empty() || now.empty()) return 1.0;
  const int level = coarseLevel(before);
  const cv::Mat& a = before.level(level);
  const cv::Mat& b = now.level(level);
  const double pixel = std::ldexp(1.0, level);
  std::vector<double> correlations;
  for (int y = 0; y + kBlock <= a.rows; y += kBlock) {
    for (int x = 0; x + kBlock <= a.cols; x += kBlock) {
      const Eigen::Vector2d middle(x + 0.5 * (kBlock - 1), y + 0.5 * (kBlock - 1));
      const LocalMotion::Motion moved = motion.at(pixel * middle);
      const std::optional<double> correlation =
          correlationOf(a, b, x, y, middle, moved.pixel / pixel, moved.linear);
      if (correlation) correlations.push_back(*correlation);
    }
  }
  if (correlations.size() < kFewest) return 1.0;
  return medianInPlace(&correlations);
}

}  // namespace camera_self_calibration
