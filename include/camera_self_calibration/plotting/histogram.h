#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace camera_self_calibration {

/// Residuals over their sigmas as bars between -5 and 5, beside the normal distribution that they
/// would have if the sigmas were right; `note` stands above, at the right. BGR, 8 bits; `fine`:
/// twice as many pixels.
cv::Mat drawResidualHistogram(const std::vector<double>& whitened, const std::string& note,
                              int width, int height, bool fine = false);

}  // namespace camera_self_calibration
