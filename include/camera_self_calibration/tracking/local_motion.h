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
    clear();
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (found(i)) add(from[i], to[i]);
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

  /// How far features that are followed rightly are from where their neighbours expect them, by
  /// parallax and the flow's errors [px]; 0 where too few say anything of their neighbourhood.
  double scatter() const { return scatter_; }

  /// Whether more than `count` of the features are within a pixel of where their neighbours expect
  /// them; looks at no more of them than it takes.
  bool expectsMoreThan(int count) const;

 private:
  void clear();
  void add(const cv::Point2f& from, const cv::Point2f& to);
  double miss(std::size_t i) const;
  void weighOutliers();

  // Pairs side by side, filled up with weights of zero to a multiple of the lanes that are summed
  // up together.
  std::size_t count_ = 0;
  std::vector<float> from_x_, from_y_, to_x_, to_y_, weights_;
  std::vector<double> misses_;
  std::vector<double> sorted_;
  double reach_ = 1.0;
  double scatter_ = 0.0;
};

}  // namespace camera_self_calibration
