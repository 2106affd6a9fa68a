#pragma once

#include <Eigen/Core>
#include <array>

#include "camera_self_calibration/tracking/pyramid.h"
#include "camera_self_calibration/tracking/reference_patch.h"
#include "camera_self_calibration/tracking/smooth_window.h"

namespace camera_self_calibration {

/// Maps an offset u from the centre of the reference patch, in pixels of the level from which it
/// was cut, to the image: pixel + linear * u.
struct Warp {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Matrix2d linear = Eigen::Matrix2d::Identity();
};

struct Registration {
  enum class Status {
    kGood,
    kOutside,      ///< The patch reaches out of the image.
    kDeformed,     ///< The warp enlarges, shrinks, shears or mirrors beyond what can be matched.
    kNotConverged  ///< No minimum near the start.
  };
  Status status = Status::kNotConverged;
  Warp warp;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< Of the reference's anchor.
  double gain = 1.0;      ///< Gray values of the image over those of the reference.
  double residual = 0.0;  ///< Weighted mean square of the remaining difference [gray^2].
  double contrast = 0.0;  ///< Weighted variance of the reference seen through the gain [gray^2].
  int iterations = 0;
  /// Of `pixel` [px^2], for white noise of one gray value in the difference of the images.
  Eigen::Matrix2d unit_covariance = Eigen::Matrix2d::Zero();
};

/// Finds a reference patch in an image by inverse-compositional Gauss-Newton over an affine warp,
/// gain and offset. Both patches are compared at equal blur, measured in the reference: where the
/// warp enlarges, the image is blurred or taken from a coarser level; where it shrinks, the
/// reference is blurred.
class PatchRegistration {
 public:
  PatchRegistration() { noise_.fill(1.0); }

  /// Noise of the difference of two patches [gray^2], for references cut from that level and
  /// prepared from now on.
  void setNoise(int level, double noise) { noise_[static_cast<std::size_t>(level)] = noise; }

  /// Prepares a reference for the first time, at the scale at which it was cut.
  bool prepare(ReferencePatch* reference) const;

  /// `start` is within about 2 px of the truth. Prepares `reference` anew if the scale asks for it.
  Registration run(ReferencePatch* reference, const ImagePyramid& image, const Warp& start);

 private:
  bool extractWindow(const ReferencePatch& reference, const cv::Mat& level, const Warp& warp);
  bool sampleAt(const Warp& warp);
  Registration::Status iterate(const ReferencePatch& reference, const cv::Mat& level,
                               Registration* result);
  void measureResidual(const ReferencePatch& reference, const ReferencePatch::Vector& projected,
                       const ReferencePatch::Vector& solution, Registration* result) const;

  double noiseOf(const ReferencePatch& reference) const {
    return noise_[static_cast<std::size_t>(reference.level())];
  }

  std::array<double, ReferencePatch::kLevels> noise_;
  SmoothWindow window_;
  alignas(16) std::array<float, PatchPoints::kCount> x_;
  alignas(16) std::array<float, PatchPoints::kCount> y_;
  alignas(16) std::array<float, PatchPoints::kCount> values_;
};

}  // namespace camera_self_calibration
