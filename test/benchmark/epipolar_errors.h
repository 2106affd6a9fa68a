#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/simulation/tum_file.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

/// Where the calibration and the poses are known: how far a track is from the epipolar line of the
/// pixel in which it was detected. That is one of the two components of its error.
class EpipolarErrors {
 public:
  /// Throws std::runtime_error where a file cannot be read.
  EpipolarErrors(const std::string& calibration, const std::string& poses);

  void add(std::int64_t stamp_ns, const std::vector<Track>& tracks);

  double median() const;        ///< Of the magnitude [px]; not a number without any.
  double outlierShare() const;  ///< Off by more than a pixel.
  double rmsZ() const;          ///< Against the stated sigma, of the others.

 private:
  struct Detection {
    Rigid3 world_from_camera;
    Eigen::Vector3d ray;
  };

  Camera camera_;
  std::vector<StampedPose> poses_;
  std::map<std::int64_t, Detection> detections_;  // by track
  std::vector<double> lengths_;
  double z2_ = 0.0;
  std::int64_t fair_ = 0;
};

}  // namespace camera_self_calibration
