#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "camera_self_calibration/plotting/palette.h"

namespace camera_self_calibration {

enum class Align { kLeft, kCentre, kRight };

/// What a sheet consists of. Coordinates and widths are pixels of the sheet, from its upper left
/// corner.
namespace shape {

struct Fill {
  cv::Rect2d area;
  Colour colour;
  double opacity = 1.0;
};

struct Outline {
  cv::Rect2d area;
  Colour colour;
};

/// Connected points, cut off at the border of `area`, if there is one.
struct Curve {
  std::vector<cv::Point2d> points;
  Colour colour;
  double width = 1.0;
  bool dashed = false;
  std::optional<cv::Rect2d> area;
};

/// Filled, cut off at the border of `area`.
struct Polygon {
  std::vector<cv::Point2d> points;
  Colour colour;
  double opacity = 1.0;
  cv::Rect2d area;
};

struct Disc {
  cv::Point2d centre;
  double radius = 1.0;
  Colour colour;
};

struct Text {
  std::string text;
  cv::Point2d anchor;
  double size = 1.0;
  Colour colour;
  Align align = Align::kLeft;
  bool bold = false;
};

}  // namespace shape

using Shape = std::variant<shape::Fill, shape::Outline, shape::Curve, shape::Polygon, shape::Disc,
                           shape::Text>;

/// A drawing: a list of shapes, later ones above earlier ones, which becomes a picture or SVG.
class Sheet {
 public:
  Sheet(int width, int height, const Colour& background);

  void fill(const cv::Rect2d& area, const Colour& colour, double opacity = 1.0);
  void outline(const cv::Rect2d& area, const Colour& colour);
  void line(const cv::Point2d& from, const cv::Point2d& to, const Colour& colour,
            double width = 1.0);
  void dashes(const cv::Point2d& from, const cv::Point2d& to, const Colour& colour,
              double width = 1.0);
  void disc(const cv::Point2d& centre, double radius, const Colour& colour);
  void curve(const std::vector<cv::Point2d>& points, const Colour& colour, double width,
             const cv::Rect2d& area, bool dashed = false);
  void polygon(const std::vector<cv::Point2d>& points, const Colour& colour, const cv::Rect2d& area,
               double opacity = 1.0);

  /// `anchor` is on the baseline of the text, at its left end, middle or right end; `size` is the
  /// height of capital letters [px]. ASCII and the plus-minus sign.
  void text(const std::string& text, const cv::Point2d& anchor, double size, const Colour& colour,
            Align align = Align::kLeft, bool bold = false);
  /// Width of a text in image() [px]; in an SVG it is narrower.
  static double textWidth(const std::string& text, double size, bool bold = false);

  int width() const { return width_; }
  int height() const { return height_; }

  /// The picture, BGR with 8 bits a channel, of the size given, with smooth lines and letters.
  cv::Mat image() const;
  /// The same with twice as many pixels each way, for fine print.
  cv::Mat fineImage() const;

  /// An <svg> element to stand in a web page, which may show it at any size. Colours of the light
  /// palette become the variables of paletteCss(), so that the page can be dark. `description` is
  /// for those who cannot see it.
  std::string svg(const std::string& description) const;

 private:
  int width_;
  int height_;
  Colour background_;
  std::vector<Shape> shapes_;
};

/// The declarations of a theme's colours for a style sheet: "--background:rgb(255,255,255);...".
std::string paletteCss(Theme theme);

/// "rgb(32,38,46)".
std::string cssColour(const Colour& colour);

/// A text with the characters escaped that mean something in HTML.
std::string htmlEscaped(const std::string& text);

}  // namespace camera_self_calibration
