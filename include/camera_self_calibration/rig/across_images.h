#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "camera_self_calibration/rig/rig_segment.h"
#include "camera_self_calibration/tracking/patch_registration.h"
#include "camera_self_calibration/tracking/track_gate.h"

namespace camera_self_calibration {

/// A feature of one camera, and where another one should see it at the same time.
struct ExpectedAcross {
  std::int64_t track_id = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();   ///< In the camera that follows it.
  double sigma = 1.0;                                ///< Of this [px].
  Warp there;                                        ///< From its surroundings to the other image.
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();  ///< Of the epipolar line there, unit.
};

/// Finds features of the camera `from` in the image of `to`: those that it is sure of, with pixel
/// and sigma; `frame` of the result is for the caller to set.
using FindAcross = std::function<std::vector<SeenAcross>(
    const RigFrame& frame, int from, int to, const std::vector<ExpectedAcross>& expected)>;

/// Registers the patch around a feature, as it is now in one camera's image, in that of the other:
/// what the tracker does along time. Several starts along the epipolar line make up for a depth
/// that is not well known.
class AcrossImages {
 public:
  /// Those of `expected` that are found in the image of `to`, with sigma: that of the registration
  /// and that of the feature itself [px]. Calls come frame by frame: the pyramids of one frame are
  /// kept. Nothing where an image is missing.
  std::vector<SeenAcross> operator()(const RigFrame& frame, int from, int to,
                                     const std::vector<ExpectedAcross>& expected);

 private:
  const ImagePyramid& pyramidOf(const RigFrame& frame, int camera);
  bool find(const ImagePyramid& from, const ImagePyramid& to, const ExpectedAcross& expected,
            SeenAcross* seen);

  std::int64_t stamp_ns_ = -1;  // of the pyramids
  std::map<int, ImagePyramid> pyramids_;
  PatchRegistration registration_;
  TrackGate gate_;
  std::vector<Registration> accepted_;
};

}  // namespace camera_self_calibration
