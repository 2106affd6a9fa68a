#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "camera_self_calibration/tracking/local_motion.h"
#include "camera_self_calibration/tracking/lucas_kanade.h"
#include "camera_self_calibration/tracking/pyramid.h"
#include "camera_self_calibration/tracking/stripes.h"

namespace camera_self_calibration {

/// Where the features of one image are in the next, to about a pixel: pyramidal Lucas-Kanade, and a
/// check back on the finest level. A few scouts are sought over all levels of the pyramid; what
/// they find corrects the guesses of the others, which the two finest levels then suffice for. What
/// is not found that way is sought over all levels, too. Between images of different exposure the
/// first is taken as bright as the second. Its errors do not matter beyond that, for registration
/// follows.
class FlowPrediction {
 public:
  /// `predicted` holds a first guess for each point; on return the positions in `to`.
  void run(const ImagePyramid& from, const ImagePyramid& to, const std::vector<cv::Point2f>& points,
           std::vector<cv::Point2f>* predicted);

  /// Whether the i-th point of the last run was found, and leads back to where it came from.
  bool found(std::size_t i) const { return found_[i] != 0; }

  /// Brightness of the second image of the last run against that of the first.
  float gain() const { return gain_; }

 private:
  void follow(const ImagePyramid& from, const ImagePyramid& to, int coarsest,
              const std::vector<cv::Point2f>& points, std::vector<cv::Point2f>* predicted);
  void correctGuesses(double reach, std::vector<cv::Point2f>* predicted);
  template <typename Chosen>
  void choose(const Chosen& chosen) {
    chosen_.clear();
    for (std::size_t i = 0; i < found_.size(); ++i) {
      if (chosen(i)) chosen_.push_back(i);
    }
  }

  std::array<LucasKanade, kStripes> lucas_kanade_;
  float gain_ = 1.0f;  // brightness of the second image against that of the first
  std::vector<std::uint8_t> found_;
  std::vector<std::size_t> chosen_;  // points that are followed together
  std::vector<cv::Point2f> guesses_;
  LocalMotion correction_;
};

}  // namespace camera_self_calibration
