#include "camera_self_calibration/plotting/difference_chart.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/plotting/axes.h"

namespace camera_self_calibration {
namespace {

constexpr int kWidth = 500;
constexpr double kMargin = 16.0;
constexpr double kTop = 58.0;
constexpr double kScaleHeight = 50.0;
// One arrow in so many points of the grid of 40 x 30, in x and in y.
constexpr int kArrowEvery = 3;
constexpr double kGridColumns = 40.0;
constexpr double kGridRows = 30.0;

/// Nearly all differences lie below; the few at the border of the field that do not would make all
/// others look alike.
double scaleEnd(const PixelDifference& difference) {
  std::vector<double> sizes;
  for (const auto& point : difference.points) sizes.push_back(point.offset.norm());
  if (sizes.empty()) return 1.0;
  const auto most = sizes.begin() + static_cast<std::ptrdiff_t>((sizes.size() - 1) * 95 / 100);
  std::nth_element(sizes.begin(), most, sizes.end());
  return std::max(1e-12, std::min(difference.error.max, 1.2 * *most));
}

class DifferenceChart {
 public:
  DifferenceChart(const Camera& a, const PixelDifference& difference)
      : a_(a),
        difference_(difference),
        colours_(palette(Theme::kLight)),
        scale_((kWidth - 2.0 * kMargin) / a.width()),
        area_(kMargin, kTop, a.width() * scale_, a.height() * scale_),
        largest_(scaleEnd(difference)),
        sheet_(kWidth, static_cast<int>(kTop + area_.height + kScaleHeight), colours_.background) {}

  Sheet draw() {
    const PixelError& error = difference_.error;
    sheet_.text(formatted("%.3g px rms, %.3g px at most", error.rms, error.max), {kMargin, 26.0},
                10.0, colours_.text, Align::kLeft, true);
    sheet_.text(
        formatted("after the rotation of %.3g deg that fits best", difference_.rotation_deg),
        {kMargin, 46.0}, 7.5, colours_.faint_text);
    drawCells();
    const double magnified = drawArrows();
    sheet_.text(formatted("arrows %.3g times as long", magnified), {kWidth - kMargin, 46.0}, 7.5,
                colours_.faint_text, Align::kRight);
    drawCentre();
    sheet_.outline(area_, colours_.faint_text);
    drawScale();
    return sheet_;
  }

 private:
  cv::Point2d at(const Eigen::Vector2d& pixel) const {
    return {area_.x + (pixel.x() + 0.5) * scale_, area_.y + (pixel.y() + 0.5) * scale_};
  }

  /// Pixels without a value keep the colour of the panel.
  void drawCells() {
    sheet_.fill(area_, colours_.panel);
    const double width = area_.width / (kGridColumns - 1.0);
    const double height = area_.height / (kGridRows - 1.0);
    for (const auto& point : difference_.points) {
      const cv::Point2d centre = at(point.pixel);
      const cv::Rect2d cell(centre.x - 0.5 * width, centre.y - 0.5 * height, width, height);
      sheet_.fill(cell & area_, errorColour(point.offset.norm() / largest_));
    }
  }

  /// Returns how much longer than the difference the arrows are.
  double drawArrows() {
    const double spacing = kArrowEvery * (a_.width() - 1) / (kGridColumns - 1.0);
    const double magnified = 0.9 * spacing / largest_;
    for (const auto& point : difference_.points) {
      const auto column = std::lround(point.pixel.x() * (kGridColumns - 1.0) / (a_.width() - 1));
      const auto row = std::lround(point.pixel.y() * (kGridRows - 1.0) / (a_.height() - 1));
      if (column % kArrowEvery != 1 || row % kArrowEvery != 1) continue;
      drawArrow(at(point.pixel), at(point.pixel + magnified * point.offset));
    }
    return magnified;
  }

  void drawArrow(const cv::Point2d& from, const cv::Point2d& to) {
    const Colour white(255, 255, 255);
    const Colour black(20, 20, 20);
    for (const auto& [colour, width] : {std::pair{black, 2.6}, std::pair{white, 1.2}}) {
      sheet_.curve({from, to}, colour, width, area_);
      sheet_.disc(from, 0.9 + 0.5 * width, colour);
    }
  }

  void drawCentre() {
    const cv::Point2d centre = at(a_.parameters().segment<2>(2));
    sheet_.line(centre - cv::Point2d(7.0, 0.0), centre + cv::Point2d(7.0, 0.0), colours_.truth,
                1.5);
    sheet_.line(centre - cv::Point2d(0.0, 7.0), centre + cv::Point2d(0.0, 7.0), colours_.truth,
                1.5);
  }

  void drawScale() {
    constexpr int kSteps = 100;
    const Axes axes = {{area_.x, area_.y + area_.height + 10.0, area_.width, 10.0},
                       {0.0, largest_},
                       {0.0, 1.0},
                       false};
    const double step = axes.area.width / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      sheet_.fill({axes.area.x + i * step, axes.area.y, step + 0.5, axes.area.height},
                  errorColour((i + 0.5) / kSteps));
    }
    const bool cut = difference_.error.max > 1.001 * largest_;
    drawXTicks(axes, true, cut ? "difference [px]; larger ones are yellow too" : "difference [px]",
               colours_, &sheet_);
  }

  const Camera& a_;
  const PixelDifference& difference_;
  const Palette& colours_;
  const double scale_;
  const cv::Rect2d area_;
  const double largest_;
  Sheet sheet_;
};

}  // namespace

Sheet drawDifference(const Camera& a, const PixelDifference& difference) {
  return DifferenceChart(a, difference).draw();
}

}  // namespace camera_self_calibration
