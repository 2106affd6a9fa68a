#include "camera_self_calibration/tracking/pyramid.h"

#include <algorithm>
#include <opencv2/video/tracking.hpp>

namespace camera_self_calibration {
namespace {

constexpr int kMaxLevel = 3;
constexpr int kSmallestLevel = 30;  // [px] A coarser level holds too little to match.

int coarsestLevel(int width, int height) {
  int level = 0;
  while (level < kMaxLevel && (std::min(width, height) >> (level + 1)) >= kSmallestLevel) ++level;
  return level;
}

}  // namespace

bool ImagePyramid::usable(const ImageView& image) {
  return image.data != nullptr && image.width > 0 && image.height > 0 &&
         image.stride >= image.width;
}

void ImagePyramid::build(const ImageView& image) {
  // OpenCV takes no const pointer; the image is only read.
  const cv::Mat view(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                     static_cast<std::size_t>(image.stride));
  const cv::Size border(kBorder, kBorder);
  cv::buildOpticalFlowPyramid(view, mats_, border, coarsestLevel(image.width, image.height), false,
                              cv::BORDER_REFLECT_101, cv::BORDER_REFLECT_101, false);
}

void ImagePyramid::clear() { mats_.clear(); }

}  // namespace camera_self_calibration
