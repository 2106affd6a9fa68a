#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {

/// Draws in metres (x right, y down) on a gray image of twice the final resolution.
class Canvas {
 public:
  /// Texels of the finished image per metre; filled with `gray`.
  Canvas(double width_m, double height_m, double texels_per_metre, double gray);

  double width() const { return width_m_; }    ///< [m]
  double height() const { return height_m_; }  ///< [m]

  void rectangle(double left, double top, double right, double bottom, double gray);
  /// The outline of a rectangle, `line_width` inwards.
  void frame(double left, double top, double right, double bottom, double line_width, double gray);
  void polygon(const std::vector<cv::Point2d>& points, double gray);
  void circle(double x, double y, double radius, double gray);
  void line(double x0, double y0, double x1, double y1, double line_width, double gray);
  /// Letters whose capitals are `size` high, from the lower left; `vertical` reads downwards.
  void text(const std::string& letters, double x, double y, double size, double gray,
            bool vertical = false);
  /// Small marks of random shape, `per_square_metre` of them, 4 to 30 mm wide, whose gray differs
  /// from what is below by up to `contrast`.
  void speckles(double per_square_metre, double contrast, Random* random);

  /// The picture at its final resolution, with smooth clouds of several sizes added.
  cv::Mat finish(double cloud_contrast, Random* random) const;

 private:
  cv::Point point(double x, double y) const;

  double width_m_;
  double height_m_;
  double scale_;  // drawing pixels per metre
  cv::Mat image_;
};

/// Capitals and digits at random.
std::string randomLetters(int count, Random* random);

}  // namespace camera_self_calibration
