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
};

/// The kinds of roughness that the benchmark knows, the clean images first.
std::vector<Roughness> roughnessKinds();

/// Renders seed `seed` with this roughness, and hands each image that is not dropped to `take`.
/// The same seed has the same room, lens and motion (but its speed) whatever the roughness. 640 x
/// 480 at 30 Hz. Returns the true camera.
Camera renderRough(const Roughness& roughness, CameraModel model, double duration_s,
                   std::uint64_t seed, const std::function<void(const ImageView&)>& take);

}  // namespace camera_self_calibration
