#include "camera_self_calibration/simulation/auto_exposure.h"

#include <algorithm>
#include <cmath>

namespace camera_self_calibration {
namespace {

constexpr double kTarget = 140.0;  // [gray levels]
constexpr double kLagImages = 6.0;
constexpr double kLargestGain = 8.0;

}  // namespace

void AutoExposure::see(const cv::Mat& image) {
  const double mean = std::max(1.0, cv::mean(image)[0]);
  gain_ *= std::pow(kTarget / mean, 1.0 / kLagImages);
  gain_ = std::clamp(gain_, 1.0 / kLargestGain, kLargestGain);
}

}  // namespace camera_self_calibration
