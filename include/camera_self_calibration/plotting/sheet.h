#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "camera_self_calibration/plotting/palette.h"

namespace camera_self_calibration {

enum class Align { kLeft, kCentre, kRight };

/// A sheet to draw on, with smooth lines and letters: drawn at twice the size and shrunk. All
/// coordinates are pixels of the final picture, from its upper left corner.
class Sheet {
 public:
  Sheet(int width, int height, const Colour& background);

  void fill(const cv::Rect2d& area, const Colour& colour);
  void outline(const cv::Rect2d& area, const Colour& colour);
  void line(const cv::Point2d& from, const cv::Point2d& to, const Colour& colour,
            double width = 1.0);
  void dashes(const cv::Point2d& from, const cv::Point2d& to, const Colour& colour,
              double width = 1.0);
  void disc(const cv::Point2d& centre, double radius, const Colour& colour);
  /// Connected points, cut off at the border of `area`.
  void curve(const std::vector<cv::Point2d>& points, const Colour& colour, double width,
             const cv::Rect2d& area);
  /// A filled polygon, cut off at the border of `area`.
  void polygon(const std::vector<cv::Point2d>& points, const Colour& colour,
               const cv::Rect2d& area);
  /// A picture scaled to `area`.
  void picture(const cv::Mat& bgr, const cv::Rect2d& area);

  /// `anchor` is on the baseline of the text, at its left end, middle or right end; `size` is the
  /// height of capital letters [px]. ASCII and the plus-minus sign.
  void text(const std::string& text, const cv::Point2d& anchor, double size, const Colour& colour,
            Align align = Align::kLeft, bool bold = false);
  /// Width of a text [px].
  static double textWidth(const std::string& text, double size, bool bold = false);

  /// The picture, BGR with 8 bits a channel, of the size given.
  cv::Mat image() const;
  /// The same with twice as many pixels each way, for fine print and web pages.
  cv::Mat fineImage() const { return large_.clone(); }

 private:
  cv::Mat part(const cv::Rect2d& area, cv::Point* offset);

  cv::Mat large_;
};

}  // namespace camera_self_calibration
