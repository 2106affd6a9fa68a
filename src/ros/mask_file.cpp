#include "camera_self_calibration/ros/mask_file.h"

#include <ros/package.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace camera_self_calibration {
namespace {

std::string sizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

/// Empty where the package is not known.
std::string pathOf(const std::string& url) {
  const std::string file = "file://";
  const std::string package = "package://";
  if (url.compare(0, file.size(), file) == 0) return url.substr(file.size());
  if (url.compare(0, package.size(), package) != 0) return url;
  const std::size_t slash = std::min(url.find('/', package.size()), url.size());
  const std::string folder =
      ros::package::getPath(url.substr(package.size(), slash - package.size()));
  return folder.empty() ? "" : folder + url.substr(slash);
}

}  // namespace

MaskReading readMask(const std::string& url) {
  if (url.empty()) return {};
  const std::string path = pathOf(url);
  if (path.empty()) return {std::nullopt, "the package of mask_url '" + url + "' is not known"};
  try {
    const auto image = std::make_shared<cv::Mat>(cv::imread(path, cv::IMREAD_GRAYSCALE));
    if (image->empty()) {
      return {std::nullopt, "mask_url '" + url + "' is no image that can be read (" + path + ")"};
    }
    if (cv::countNonZero(*image) == 0) {
      return {std::nullopt, "the mask " + path + " is black all over: no feature would be allowed"};
    }
    return {ImageView{image, image->data, image->cols, image->rows,
                      static_cast<int>(image->step[0]), 0},
            {}};
  } catch (const std::exception& e) {
    return {std::nullopt, "mask_url '" + url + "' cannot be read: " + e.what()};
  }
}

std::string maskMisfit(const ImageView& mask, int width, int height) {
  constexpr double kTolerance = 0.01;
  const double shape = static_cast<double>(mask.width) * height / mask.height / width;
  if (std::abs(shape - 1.0) < kTolerance) return {};
  return "the mask of mask_url is " + sizeText(mask.width, mask.height) +
         " and does not fit images of " + sizeText(width, height) +
         "; give one of the images' size, or of the same shape";
}

}  // namespace camera_self_calibration
