#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "camera_self_calibration/plotting/sheet.h"

namespace camera_self_calibration {

/// A quantity over the image of a camera, and arrows on it.
struct ImageMap {
  struct Arrow {
    Eigen::Vector2d pixel;
    Eigen::Vector2d offset;  ///< [px], drawn `arrow_scale` times as long.
  };
  std::string title;
  std::string unit;      ///< Of the values, at the scale of colours.
  int image_width = 0;   ///< [px]
  int image_height = 0;  ///< [px]
  /// A grid over the whole image, row by row; not a number where there is nothing to show.
  Eigen::MatrixXd values;
  double highest = 0.0;  ///< Upper end of the colours; 0: the largest value.
  std::vector<Arrow> arrows;
  double arrow_scale = 1.0;
  std::vector<Eigen::Vector2d> crosses;  ///< Pixels marked with a small cross.
};

/// The map, `width` wide, one cell a value, with its scale of colours.
Sheet drawImageMap(const ImageMap& map, int width);

}  // namespace camera_self_calibration
