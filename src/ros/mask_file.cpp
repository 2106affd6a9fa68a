#include "camera_self_calibration/ros/mask_file.h"

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/ros/calibration_url.h"

namespace camera_self_calibration {

MaskReading readMaskUrl(const std::string& url) {
  if (url.empty()) return {};
  const ResolvedPath resolved = resolvePath(url, "camera");
  return resolved.error.empty() ? readMask(resolved.path)
                                : MaskReading{std::nullopt, resolved.error};
}

MaskReading readMask(const std::string& path) {
  const FileContents file = readFile(path);
  if (!file.exists) return {std::nullopt, "there is no file " + path};
  if (!file.error.empty()) return {std::nullopt, file.error};
  try {
    const cv::Mat bytes(1, static_cast<int>(file.bytes.size()), CV_8U,
                        const_cast<char*>(file.bytes.data()));
    const auto image = std::make_shared<cv::Mat>();
    if (!file.bytes.empty()) *image = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
    if (image->empty()) {
      return {std::nullopt, path + " is no image that can be read"};
    }
    if (cv::countNonZero(*image) == 0) {
      return {std::nullopt, path + " is black all over: no feature would be allowed"};
    }
    return {ImageView{image, image->data, image->cols, image->rows,
                      static_cast<int>(image->step[0]), 0},
            {}};
  } catch (const std::exception& e) {
    return {std::nullopt, path + " cannot be read: " + e.what()};
  }
}

std::string maskMisfit(const ImageView& mask, int width, int height) {
  constexpr double kTolerance = 0.01;
  const double shape = static_cast<double>(mask.width) * height / mask.height / width;
  if (std::abs(shape - 1.0) < kTolerance) return {};
  return "the mask is " + sizeText(mask.width, mask.height) + " and does not fit images of " +
         sizeText(width, height) + "; give one of the images' size, or of the same shape";
}

}  // namespace camera_self_calibration
