#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace camera_self_calibration {

/// How the neighbourhood of a point moved from one image to the next: shift, turn and scale, from
/// the flow of the features around it. Knows nothing of the camera.
class LocalMotion {
 public:
  /// `found(i)` tells whether the flow from from[i] to to[i] is to be believed; `reach` [px] is the
  /// standard deviation of a neighbourhood.
  template <typename Found>
  void fit(const std::vector<cv::Point2f>& from, const std::vector<cv::Point2f>& to,
           const Found& found, double reach) {
    pairs_.clear();
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (found(i)) pairs_.push_back({toVector(from[i]), toVector(to[i]), 1.0});
    }
    reach_ = reach;
    weighOutliers();
  }

  struct Motion {
    Eigen::Vector2d pixel;   ///< Where the point is expected now.
    Eigen::Matrix2d linear;  ///< Turn and scale of its neighbourhood.
  };

  /// The identity where nothing is known of the neighbourhood.
  Motion at(const Eigen::Vector2d& pixel) const;

 private:
  struct Pair {
    Eigen::Vector2d from;
    Eigen::Vector2d to;
    double weight;
  };

  static Eigen::Vector2d toVector(const cv::Point2f& p) { return {p.x, p.y}; }
  void weighOutliers();

  std::vector<Pair> pairs_;
  std::vector<double> misses_;
  std::vector<double> sorted_;
  double reach_ = 1.0;
};

}  // namespace camera_self_calibration
