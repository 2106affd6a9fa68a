#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/plotting/sheet.h"

namespace camera_self_calibration {
namespace {

// Height of capital letters of common sans serif fonts, as a share of the font's size.
constexpr double kCapShare = 0.72;

using Named = std::pair<const char*, Colour>;

std::array<Named, 8> named(const Palette& colours) {
  return {{{"background", colours.background},
           {"panel", colours.panel},
           {"grid", colours.grid},
           {"text", colours.text},
           {"faint-text", colours.faint_text},
           {"curve", colours.curve},
           {"band", colours.band},
           {"truth", colours.truth}}};
}

/// A colour of the light palette by its name, so that the page decides. White stays white: what
/// stands on colours is white, too.
std::string themed(const Colour& colour) {
  const Palette& light = palette(Theme::kLight);
  for (const auto& [name, value] : named(light)) {
    if (value == colour && value != light.background) return "var(--" + std::string(name) + ")";
  }
  return cssColour(colour);
}

/// A coordinate to a hundredth of a pixel, without zeros at the end.
std::string coordinate(double value) {
  constexpr double kFar = 1e5;
  std::string text = formatted("%.2f", std::clamp(value, -kFar, kFar));
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

std::string attribute(const char* name, double value) {
  return std::string(" ") + name + "=\"" + coordinate(value) + "\"";
}

std::string rectangle(const cv::Rect2d& area) {
  return attribute("x", area.x) + attribute("y", area.y) + attribute("width", area.width) +
         attribute("height", area.height);
}

std::string points(const std::vector<cv::Point2d>& points) {
  std::string text = " points=\"";
  for (const cv::Point2d& point : points) {
    text += coordinate(point.x) + "," + coordinate(point.y) + " ";
  }
  text.back() = '"';
  return text;
}

std::string opacityOf(double opacity) {
  return opacity < 1.0 ? attribute("fill-opacity", opacity) : std::string();
}

/// Writes shapes one after the other. An inner <svg> cuts off what lies outside its area.
class SvgWriter {
 public:
  void operator()(const shape::Fill& fill) {
    cutAt(std::nullopt);
    text_ += "<rect" + rectangle(fill.area) + filled(fill.colour) + opacityOf(fill.opacity) + "/>";
  }

  void operator()(const shape::Outline& outline) {
    cutAt(std::nullopt);
    text_ += "<rect" + rectangle(outline.area) + stroked(outline.colour, 0.5) + "/>";
  }

  void operator()(const shape::Curve& curve) {
    cutAt(curve.area);
    text_ += "<polyline" + points(curve.points) + stroked(curve.colour, curve.width) +
             (curve.dashed ? " stroke-dasharray=\"5\"" : "") + "/>";
  }

  void operator()(const shape::Polygon& polygon) {
    if (polygon.points.size() < 3) return;
    cutAt(polygon.area);
    text_ += "<polygon" + points(polygon.points) + filled(polygon.colour) +
             opacityOf(polygon.opacity) + "/>";
  }

  void operator()(const shape::Disc& disc) {
    cutAt(std::nullopt);
    text_ += "<circle" + attribute("cx", disc.centre.x) + attribute("cy", disc.centre.y) +
             attribute("r", disc.radius) + filled(disc.colour) + "/>";
  }

  void operator()(const shape::Text& text) {
    cutAt(std::nullopt);
    const char* anchor = text.align == Align::kLeft     ? ""
                         : text.align == Align::kCentre ? " text-anchor=\"middle\""
                                                        : " text-anchor=\"end\"";
    text_ += "<text" + attribute("x", text.anchor.x) + attribute("y", text.anchor.y) +
             attribute("font-size", text.size / kCapShare) + filled(text.colour) + anchor +
             (text.bold ? " font-weight=\"bold\">" : ">") + htmlEscaped(text.text) + "</text>";
  }

  std::string finish() {
    cutAt(std::nullopt);
    return std::move(text_);
  }

 private:
  static std::string filled(const Colour& colour) {
    return " style=\"fill:" + themed(colour) + "\"";
  }
  static std::string stroked(const Colour& colour, double width) {
    return " style=\"fill:none;stroke:" + themed(colour) + "\"" + attribute("stroke-width", width);
  }

  void cutAt(const std::optional<cv::Rect2d>& area) {
    if (area == area_) return;
    if (area_) text_ += "</svg>";
    area_ = area;
    if (!area_) return;
    text_ += "<svg" + rectangle(*area_) + " viewBox=\"" + coordinate(area_->x) + " " +
             coordinate(area_->y) + " " + coordinate(area_->width) + " " +
             coordinate(area_->height) + "\">";
  }

  std::string text_;
  std::optional<cv::Rect2d> area_;
};

}  // namespace

std::string Sheet::svg(const std::string& description) const {
  SvgWriter writer;
  for (const Shape& shape : shapes_) std::visit(writer, shape);
  return formatted("<svg viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"", width_, height_) +
         htmlEscaped(description) + "\">" + writer.finish() + "</svg>";
}

std::string paletteCss(Theme theme) {
  std::string text;
  for (const auto& [name, value] : named(palette(theme))) {
    text += "--" + std::string(name) + ":" + cssColour(value) + ";";
  }
  return text;
}

std::string cssColour(const Colour& colour) {
  return formatted("rgb(%.0f,%.0f,%.0f)", colour[2], colour[1], colour[0]);
}

std::string htmlEscaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

}  // namespace camera_self_calibration
