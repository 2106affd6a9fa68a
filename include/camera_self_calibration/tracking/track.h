#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "camera_self_calibration/camera/image_field.h"

namespace camera_self_calibration {

/// How a feature moves through the images, as they are stamped.
struct ImageMotion {
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();      ///< [px/s]
  Eigen::Vector2d acceleration = Eigen::Vector2d::Zero();  ///< [px/s^2]
  int images = 0;                                          ///< That they were measured in.
};

/// One feature in one image, registered against the patch of the image in which it was detected.
struct Track {
  std::int64_t id = 0;                              ///< Unique over the life of a tracker.
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< In this image.
  Eigen::Vector2d reference_pixel = Eigen::Vector2d::Zero();  ///< In the image of its detection.
  double sigma = 1.0;       ///< Standard deviation of `pixel` per axis [px], the tracker's own.
  ImageMotion motion = {};  ///< In this image; zero where it is not known.
};

/// The live tracks in one image.
struct TrackedFrame {
  std::int64_t stamp_ns = 0;
  int width = 0;   ///< Of the image [px].
  int height = 0;  ///< Of the image [px].
  std::vector<Track> tracks;
  /// Tracks that ended at this image because the camera carries along what they showed.
  std::vector<std::int64_t> carried = {};
  /// It shows nothing of what was tracked before, and was not searched for tracks: a cut, or
  /// something in front of the lens.
  bool unrelated = false;
  ImageField field = {};  ///< What is dark in all images so far is no part of it.
};

}  // namespace camera_self_calibration
