#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

struct SensorOptions {
  double noise_sigma = 2.0;  ///< Of each pixel, gaussian, independent [gray levels].
  double gain = 1.0;         ///< Factor on all gray values: exposure.
  double vignetting = 0.0;   ///< Share of the light that is lost at the farthest corner, [0, 1).

  /// Every violated bound in one sentence each; empty if all is well.
  std::vector<std::string> problems() const;
};

/// Turns light into 8-bit gray: vignetting, gain, noise, rounding.
class Sensor {
 public:
  Sensor(const SensorOptions& options, const Camera& camera);

  /// `light` is CV_32FC1 and is multiplied by `gain`, besides the options' own; the result is
  /// CV_8UC1 of the same size. The noise depends on the seed only. Pixels without light stay black,
  /// without noise.
  cv::Mat expose(const cv::Mat& light, std::uint64_t noise_seed, double gain = 1.0) const;

 private:
  SensorOptions options_;
  cv::Mat sensitivity_;       // gain times vignetting, CV_32FC1
  std::vector<float> noise_;  // a long table of gaussian numbers, entered at random per row
};

}  // namespace camera_self_calibration
