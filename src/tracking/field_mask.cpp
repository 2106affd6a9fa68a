#include "camera_self_calibration/tracking/field_mask.h"

#include <algorithm>

namespace camera_self_calibration {
namespace {

constexpr int kLevel = 2;     // Of the pyramid; small images have fewer.
constexpr int kDarkest = 32;  // [gray] Nothing brighter is counted as dark.

}  // namespace

void FieldMask::add(const ImagePyramid& image) {
  level_ = std::min(kLevel, image.levels() - 1);
  const cv::Mat& level = image.level(level_);
  if (brightest_.size() != level.size()) {
    level.copyTo(brightest_);
  } else {
    cv::max(brightest_, level, brightest_);
  }
}

void FieldMask::update() {
  // Flood from the border inwards: a dark object in the scene is no part of the lens.
  dark_.create(brightest_.size(), CV_8UC1);
  dark_.setTo(0);
  const auto visit = [&](int x, int y) {
    if (x < 0 || y < 0 || x >= dark_.cols || y >= dark_.rows) return;
    if (dark_.at<std::uint8_t>(y, x) || brightest_.at<std::uint8_t>(y, x) > kDarkest) return;
    dark_.at<std::uint8_t>(y, x) = 1;
    pending_.emplace_back(x, y);
  };
  for (int x = 0; x < dark_.cols; ++x) visit(x, 0), visit(x, dark_.rows - 1);
  for (int y = 0; y < dark_.rows; ++y) visit(0, y), visit(dark_.cols - 1, y);
  while (!pending_.empty()) {
    const cv::Point p = pending_.back();
    pending_.pop_back();
    visit(p.x - 1, p.y), visit(p.x + 1, p.y), visit(p.x, p.y - 1), visit(p.x, p.y + 1);
  }
}

bool FieldMask::touches(int x, int y, int radius) const {
  if (dark_.empty()) return false;
  const int x1 = std::min((x + radius) >> level_, dark_.cols - 1);
  const int y1 = std::min((y + radius) >> level_, dark_.rows - 1);
  for (int row = std::max(0, (y - radius) >> level_); row <= y1; ++row) {
    for (int column = std::max(0, (x - radius) >> level_); column <= x1; ++column) {
      if (dark_.at<std::uint8_t>(row, column)) return true;
    }
  }
  return false;
}

ImageField FieldMask::field(int width, int height) const {
  ImageField field;
  for (int row = 0; row < ImageField::kRows; ++row) {
    for (int column = 0; column < ImageField::kColumns; ++column) {
      const Eigen::Vector2i at =
          ImageField::pixel(column, row, width, height).array().round().cast<int>();
      if (touches(at.x(), at.y(), 0)) field.setDark(column, row);
    }
  }
  return field.share() > 0.0 ? field : ImageField();
}

}  // namespace camera_self_calibration
