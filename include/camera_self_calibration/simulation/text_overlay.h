#pragma once

#include <opencv2/core.hpp>

namespace camera_self_calibration {

/// Writes into an image (CV_8UC1) what recorders write: date and time, to the tenth of a second, at
/// the upper left, the camera's name at the lower right. White letters without a ground of their
/// own, a twentieth of the image high.
void writeOverlay(double time_s, cv::Mat* image);

}  // namespace camera_self_calibration
