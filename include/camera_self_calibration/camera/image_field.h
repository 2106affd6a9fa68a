#pragma once

#include <Eigen/Core>
#include <bitset>

namespace camera_self_calibration {

/// Which part of the image sees the scene: some lenses leave the sensor's corners dark, and how
/// well they are calibrated there does not matter. A plain value over a grid of 40 x 30 points that
/// spans the image, its border included; at first all of it sees.
class ImageField {
 public:
  static constexpr int kColumns = 40;
  static constexpr int kRows = 30;

  /// Of an image of this size [px]; the grid's points in the order of rows.
  static Eigen::Vector2d pixel(int column, int row, int width, int height) {
    return {column * (width - 1) / (kColumns - 1.0), row * (height - 1) / (kRows - 1.0)};
  }

  bool sees(int column, int row) const { return !dark_[row * kColumns + column]; }
  void setDark(int column, int row) { dark_.set(row * kColumns + column); }

  /// Share of the grid's points that see, 0 to 1.
  double share() const { return 1.0 - static_cast<double>(dark_.count()) / (kColumns * kRows); }

 private:
  std::bitset<kColumns * kRows> dark_;
};

}  // namespace camera_self_calibration
