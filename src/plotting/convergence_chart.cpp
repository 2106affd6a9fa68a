#include "camera_self_calibration/plotting/convergence_chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/plotting/axes.h"
#include "chart_text.h"

namespace camera_self_calibration {
namespace {

constexpr double kHeaderHeight = 78.0;
constexpr double kFooterHeight = 34.0;
constexpr double kQueueHeight = 74.0;
constexpr double kStateHeight = 3.0;
constexpr double kTitleHeight = 17.0;  // above each panel
constexpr double kLeft = 58.0;
constexpr double kRight = 16.0;
constexpr double kLabel = 7.5;  // letters [px]
// Where rows of one column would be lower than this there are two [px].
constexpr double kLowestRow = 70.0;

/// Draws the parts of one chart one below the other.
class Chart {
 public:
  Chart(const ConvergenceHistory& history, const ConvergenceStyle& style)
      : history_(history),
        style_(style),
        report_(history.latest()),
        points_(pointsOfModel(history)),
        colours_(palette(style.theme)),
        sheet_(style.width, style.height, colours_.background) {
    time_.low = points_.front().seconds;
    time_.high = std::max(points_.back().seconds, time_.low + 1.0);
  }

  cv::Mat draw() {
    drawHeader();
    const double queue_top = style_.height - kQueueHeight - kFooterHeight;
    drawCurves({0.0, kHeaderHeight, double(style_.width), queue_top - kHeaderHeight});
    drawQueue(panelIn({0.0, queue_top, double(style_.width), kQueueHeight}));
    return sheet_.image();
  }

 private:
  /// The parameters, and then the expected error in what is left of the last row.
  void drawCurves(const cv::Rect2d& area) {
    const int parameters = report_.camera.parameterCount();
    const bool one_column = area.height >= kLowestRow * (parameters + 1);
    const int columns = one_column ? 1 : 2;
    const double width = area.width / columns;
    const int rows = parameters / columns + 1;
    const double height = area.height / rows;
    const auto corner = [&](int i) {
      const int row = i / columns;
      return cv::Point2d(width * (i % columns), area.y + height * row);
    };
    for (int i = 0; i < parameters; ++i) {
      drawParameter(i, panelIn(cv::Rect2d(corner(i), cv::Size2d(width, height))));
    }
    const cv::Point2d last = corner(parameters);
    drawPixelError(panelIn({last.x, last.y, area.width - last.x, height}));
  }

  /// Only those of the newest model: a chart cannot show the parameters of two.
  static std::vector<ConvergencePoint> pointsOfModel(const ConvergenceHistory& history) {
    std::vector<ConvergencePoint> all = history.points();
    const CameraModel model = all.back().model;
    all.erase(std::remove_if(all.begin(), all.end(),
                             [model](const ConvergencePoint& p) { return p.model != model; }),
              all.end());
    return all;
  }

  static cv::Rect2d panelIn(const cv::Rect2d& cell) {
    return {cell.x + kLeft, cell.y + kTitleHeight, cell.width - kLeft - kRight,
            std::max(10.0, cell.height - kTitleHeight - 6.0)};
  }

  void title(const cv::Rect2d& panel, const std::string& left, const std::string& right) {
    const double baseline = panel.y - 5.0;
    sheet_.text(left, {panel.x, baseline}, kLabel, colours_.text, Align::kLeft, true);
    sheet_.text(right, {panel.x + panel.width, baseline}, kLabel, colours_.faint_text,
                Align::kRight);
  }

  void drawHeader() {
    const Colour colour = stateColour(report_.state);
    const std::string state = toString(report_.state);
    const double pill = Sheet::textWidth(state, 9.0, true) + 20.0;
    sheet_.fill({16.0, 12.0, pill, 22.0}, colour);
    sheet_.text(state, {26.0, 27.5}, 9.0, {255, 255, 255}, Align::kLeft, true);
    sheet_.text(modelText(report_.camera), {style_.width - kRight, 27.5}, 8.5, colours_.text,
                Align::kRight);
    const std::string error = errorText(report_);
    sheet_.text(error, {pill + 30.0, 27.5}, 9.0, colours_.text);
    // The first clause of the sentence: the error stands above, the checks below.
    const std::string words = report_.hint.empty()
                                  ? report_.sentence.substr(0, report_.sentence.find(';'))
                                  : report_.hint;
    double y = 52.0;
    for (const std::string& line : {asSentence(words), asSentence(checksInWords(report_))}) {
      sheet_.text(fitted(line, style_.width - 32.0, kLabel), {16.0, y}, kLabel,
                  colours_.faint_text);
      y += 14.0;
    }
  }

  void drawParameter(int index, const cv::Rect2d& panel) {
    Axes axes = {panel, time_, valueRange(index), false};
    sheet_.fill(panel, colours_.panel);
    std::vector<cv::Point2d> upper, lower, middle;
    for (const ConvergencePoint& point : points_) {
      if (index >= point.values.size() || std::isnan(point.sigmas[index])) continue;
      const double value = point.values[index];
      const double spread = 3.0 * point.sigmas[index];
      middle.push_back(axes.at(point.seconds, value));
      upper.push_back(axes.at(point.seconds, value + spread));
      lower.push_back(axes.at(point.seconds, value - spread));
    }
    std::vector<cv::Point2d> band = upper;
    band.insert(band.end(), lower.rbegin(), lower.rend());
    sheet_.polygon(band, colours_.band, panel);
    drawAxes(axes, colours_, &sheet_);
    drawXTicks(axes, false, "", colours_, &sheet_);
    if (const auto truth = truthOf(index)) {
      sheet_.dashes(axes.at(time_.low, *truth), axes.at(time_.high, *truth), colours_.truth, 1.0);
    }
    sheet_.curve(middle, colours_.curve, 1.4, panel);
    states(axes);
    marks(axes);
    title(panel, parameterTitle(report_.camera, index),
          valueText(report_.camera.parameters()[index], points_.back().sigmas[index]));
  }

  void drawPixelError(const cv::Rect2d& panel) {
    Axes axes = {panel, time_, errorRange(), true};
    sheet_.fill(panel, colours_.panel);
    drawAxes(axes, colours_, &sheet_);
    drawXTicks(axes, false, "", colours_, &sheet_);
    std::vector<cv::Point2d> line;
    for (const ConvergencePoint& point : points_) {
      if (!(point.pixel_rms > 0.0) || std::isinf(point.pixel_rms)) continue;
      line.push_back(axes.at(point.seconds, point.pixel_rms));
    }
    if (style_.threshold_px > axes.y.low && style_.threshold_px < axes.y.high) {
      sheet_.dashes(axes.at(time_.low, style_.threshold_px),
                    axes.at(time_.high, style_.threshold_px),
                    stateColour(CalibrationState::kConverged));
    }
    sheet_.curve(line, colours_.curve, 1.4, panel);
    states(axes);
    marks(axes);
    title(panel, "expected error [px rms]", "");
  }

  void drawQueue(const cv::Rect2d& panel) {
    const Axes axes = {panel, time_, {0.0, 1.0}, false};
    sheet_.fill(panel, colours_.panel);
    drawXTicks(axes, true, "", colours_, &sheet_);
    const std::vector<SegmentReport>& segments = report_.queue.segments;
    const double step = panel.height / std::max<std::size_t>(1, segments.size());
    for (std::size_t i = 0; i < segments.size(); ++i) {
      const auto span = history_.span(segments[i].sequence);
      if (!span) continue;
      const double x0 = std::max(panel.x, axes.at(span->begin, 0.0).x);
      const double x1 = std::min(panel.x + panel.width, axes.at(span->end, 0.0).x);
      if (x1 < panel.x || x0 > panel.x + panel.width) continue;
      sheet_.fill({x0, panel.y + step * i + 0.15 * step, std::max(2.0, x1 - x0), 0.7 * step},
                  scoreColour(scoreShare(segments[i], report_.queue)));
    }
    sheet_.outline(panel, colours_.grid);
    title(panel, "queue: " + std::to_string(segments.size()) + " segments of video", "");
    drawScoreScale(panel);
    sheet_.text("time [s]", {panel.x + panel.width, panel.y + panel.height + 28.0}, 6.5,
                colours_.faint_text, Align::kRight);
  }

  /// The colours and what they mean, at the right above the panel.
  void drawScoreScale(const cv::Rect2d& panel) {
    constexpr double kWidth = 90.0;
    const double y = panel.y - 12.0;
    const double right = panel.x + panel.width;
    const double worst = Sheet::textWidth("informs least", kLabel) + 6.0;
    const double x = right - worst - kWidth;
    for (int i = 0; i < 30; ++i) {
      sheet_.fill({x + i * kWidth / 30.0, y, kWidth / 30.0 + 0.5, 7.0}, scoreColour(i / 29.0));
    }
    sheet_.text("informs least", {right, panel.y - 5.0}, kLabel, colours_.faint_text,
                Align::kRight);
    sheet_.text("most", {x - 6.0, panel.y - 5.0}, kLabel, colours_.faint_text, Align::kRight);
  }

  /// A strip along the top: the state at each time.
  void states(const Axes& axes) {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double end = i + 1 < points_.size() ? points_[i + 1].seconds : time_.high;
      const double x0 = axes.at(points_[i].seconds, axes.y.high).x;
      const double x1 = axes.at(end, axes.y.high).x;
      sheet_.fill({x0, axes.area.y, x1 - x0 + 0.5, kStateHeight}, stateColour(points_[i].state));
    }
  }

  /// Vertical lines where something happened.
  void marks(const Axes& axes) {
    const double top = axes.area.y;
    const double bottom = top + axes.area.height;
    for (std::size_t i = 1; i < points_.size(); ++i) {
      const double x = axes.at(points_[i].seconds, axes.y.low).x;
      if (points_[i].epoch != points_[i - 1].epoch) {
        sheet_.line({x, top}, {x, bottom}, stateColour(CalibrationState::kDegenerate), 1.2);
      } else if (points_[i].handed_over && !points_[i - 1].handed_over) {
        sheet_.dashes({x, top}, {x, bottom}, colours_.faint_text, 0.8);
      }
    }
  }

  std::optional<double> truthOf(int index) const {
    if (!style_.truth || style_.truth->model() != report_.camera.model()) return std::nullopt;
    const Intrinsics& values = style_.truth->parameters();
    return index < values.size() ? values[index] : 0.0;  // k3 that is not there is 0
  }

  /// Wide enough for most of the curve and its band; the wild beginning is cut off.
  Range valueRange(int index) const {
    const double centre = report_.camera.parameters()[index];
    std::vector<double> reach;
    for (const ConvergencePoint& point : points_) {
      if (index >= point.values.size() || std::isnan(point.sigmas[index])) continue;
      reach.push_back(std::abs(point.values[index] - centre) + 3.0 * point.sigmas[index]);
    }
    double half = 0.0;
    if (!reach.empty()) {
      const auto most = reach.begin() + static_cast<std::ptrdiff_t>(reach.size() * 8 / 10);
      std::nth_element(reach.begin(), most, reach.end());
      half = *most;
    }
    if (const auto truth = truthOf(index)) half = std::max(half, std::abs(*truth - centre));
    half = std::max({1.25 * half, 1e-6 * std::abs(centre), 1e-9});
    if (!std::isfinite(half)) half = std::max(1.0, std::abs(centre));
    return {centre - half, centre + half};
  }

  Range errorRange() const {
    Range range = {1.0, 1.0};
    for (const ConvergencePoint& point : points_) {
      if (!(point.pixel_rms > 0.0) || std::isinf(point.pixel_rms)) continue;
      range.low = std::min(range.low, point.pixel_rms);
      range.high = std::max(range.high, point.pixel_rms);
    }
    return {std::max(1e-4, range.low / 1.5), std::min(1e3, range.high * 1.5)};
  }

  const ConvergenceHistory& history_;
  const ConvergenceStyle& style_;
  const CalibrationReport& report_;
  const std::vector<ConvergencePoint> points_;
  const Palette& colours_;
  Sheet sheet_;
  Range time_;
};

cv::Mat drawWaiting(const ConvergenceStyle& style) {
  const Palette& colours = palette(style.theme);
  Sheet sheet(style.width, style.height, colours.background);
  sheet.text("waiting for the first keyframe", {0.5 * style.width, 0.5 * style.height}, 10.0,
             colours.faint_text, Align::kCentre);
  return sheet.image();
}

}  // namespace

cv::Mat drawConvergence(const ConvergenceHistory& history, const ConvergenceStyle& style) {
  ConvergenceStyle checked = style;
  checked.width = std::max(400, style.width);
  checked.height = std::max(400, style.height);
  return history.empty() ? drawWaiting(checked) : Chart(history, checked).draw();
}

std::string checksInWords(const CalibrationReport& report) {
  std::vector<std::string> words;
  if (report.cross_validation.compared) {
    words.push_back(report.cross_validation.agrees() ? "halves of the video agree"
                                                     : "halves of the video disagree");
  }
  if (report.lens_fit.compared) {
    words.push_back(report.lens_fit.refuted ? "lens model does not fit" : "lens model fits");
  }
  if (report.observed.share > 0.0) {
    words.push_back(formatted("features in %.0f %% of the image", 100.0 * report.observed.share));
  }
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

double scoreShare(const SegmentReport& segment, const QueueReport& queue) {
  double best = segment.entropy;
  double worst = segment.entropy;
  for (const SegmentReport& other : queue.segments) {
    best = std::min(best, other.entropy);
    worst = std::max(worst, other.entropy);
  }
  return worst > best ? (segment.entropy - best) / (worst - best) : 0.0;
}

}  // namespace camera_self_calibration
