#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/simulation/simulated_sequence.h"

namespace camera_self_calibration {

/// What can be wrong with images.
struct Roughness {
  std::string name;
  double readout_s = 0.0;         ///< Rolling shutter, of the whole image.
  double exposure_s = 0.0;        ///< Motion blur.
  double motion_speed = 1.0;      ///< Factor.
  double noise_sigma = 2.0;       ///< [gray levels]
  double vignetting = 0.0;        ///< Share lost in the farthest corner.
  double exposure_jumps_s = 0.0;  ///< Mean time between jumps of the gain; 0: none.
  int jpeg_quality = 0;           ///< 0: not compressed.
  double dropped_share = 0.0;     ///< Of the images, one by one and in runs of up to 10.
  double moving_share = 0.0;      ///< Of the image, covered by objects that move by themselves,
  double carried_share = 0.0;     ///< or else by objects that are fixed to the camera.
  bool text_overlay = false;
  bool auto_exposure = false;
};

/// The kinds of roughness that the benchmark knows, the clean images first.
std::vector<Roughness> roughnessKinds();

/// A room, a lens and a motion, the same (but for the motion's speed) whatever the roughness.
struct RoughVideo {
  CameraModel model = CameraModel::kFov;
  std::uint64_t seed = 1;
  double duration_s = 30.0;
  double rate_hz = 30.0;
  double scale = 1.0;  ///< Of the image's sides, from 640 x 480.
};

/// Renders a video with this roughness, and hands each image that is not dropped to `take`. Returns
/// the true camera.
Camera renderRough(const RoughVideo& video, const Roughness& roughness,
                   const std::function<void(const ImageView&)>& take);

}  // namespace camera_self_calibration
