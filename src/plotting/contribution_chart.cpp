#include "camera_self_calibration/plotting/contribution_chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/plotting/axes.h"

namespace camera_self_calibration {
namespace {

constexpr double kRow = 20.0;
constexpr double kTop = 44.0;
constexpr double kLeft = 66.0;
// Growth of an error that has the darkest colour.
constexpr double kFull = 0.5;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double opacityOf(double growth) {
  return 0.06 + 0.94 * std::sqrt(std::clamp(growth / kFull, 0.0, 1.0));
}

void drawKey(double right, const Palette& colours, Sheet* sheet) {
  double x = right;
  for (const auto& [growth, text] :
       {std::make_pair(kFull, "+50 % or more"), {0.1, "+10 %"}, {0.02, "+2 %"}}) {
    x -= Sheet::textWidth(text, 7.0) + 26.0;
    sheet->fill({x, 24.0, 14.0, 9.0}, colours.curve, opacityOf(growth));
    sheet->text(text, {x + 18.0, 32.0}, 7.0, colours.faint_text);
  }
}

}  // namespace

SegmentContribution contributionOf(const Camera& camera, const IntrinsicsMatrix& all,
                                   const IntrinsicsMatrix& own) {
  SegmentContribution result;
  result.image = kInfinity;
  result.values.assign(static_cast<std::size_t>(all.rows()), kInfinity);
  const auto with = covarianceFromInformation(all);
  const auto without = covarianceFromInformation(all - own);
  if (!with || !without) return result;
  result.image = pixelUncertainty(camera, *without).rms / pixelUncertainty(camera, *with).rms - 1.0;
  for (Eigen::Index i = 0; i < all.rows(); ++i) {
    result.values[static_cast<std::size_t>(i)] = std::sqrt((*without)(i, i) / (*with)(i, i)) - 1.0;
  }
  return result;
}

std::vector<SegmentContribution> contributions(const std::vector<Candidate>& queue,
                                               const Camera& camera, std::int64_t origin_ns) {
  const Eigen::Index n = camera.estimatedCount();
  IntrinsicsMatrix all = IntrinsicsMatrix::Zero(n, n);
  std::vector<const Candidate*> segments;
  for (const Candidate& candidate : queue) {
    if (candidate.information.rows() != n) continue;
    all += candidate.information;
    segments.push_back(&candidate);
  }
  const auto seconds = [origin_ns](std::int64_t stamp_ns) {
    return toSeconds(stamp_ns - origin_ns);
  };
  std::vector<SegmentContribution> result;
  for (const Candidate* candidate : segments) {
    result.push_back(contributionOf(camera, all, candidate->information));
    result.back().begin_s = seconds(candidate->segment.beginNs());
    result.back().end_s = seconds(candidate->segment.endNs());
    result.back().keyframes = static_cast<int>(candidate->segment.keyframes.size());
    result.back().landmarks = static_cast<int>(candidate->segment.landmarks.size());
    result.back().observations = static_cast<int>(candidate->segment.observations.size());
  }
  std::sort(result.begin(), result.end(),
            [](const SegmentContribution& a, const SegmentContribution& b) {
              return a.begin_s < b.begin_s;
            });
  return result;
}

Sheet drawContributions(const std::vector<SegmentContribution>& segments,
                        const std::vector<std::string>& names, double duration_s, int width) {
  const Palette& colours = palette(Theme::kLight);
  const double rows = 1.0 + static_cast<double>(names.size());
  Sheet sheet(width, static_cast<int>(kTop + rows * kRow + 34.0), colours.background);
  const Axes axes{{kLeft, kTop, width - kLeft - 16.0, rows * kRow},
                  {0.0, std::max(1e-3, duration_s)},
                  {0.0, rows},
                  false};
  sheet.fill(axes.area, colours.panel);
  drawXTicks(axes, true, "time [s]", colours, &sheet);
  sheet.text("how much larger the error would be without each segment", {kLeft, 16.0}, 8.0,
             colours.text, Align::kLeft, true);
  drawKey(width - 10.0, colours, &sheet);
  for (int row = 0; row < static_cast<int>(rows); ++row) {
    const double y = kTop + kRow * row;
    const auto parameter = static_cast<std::size_t>(std::max(0, row - 1));
    sheet.text(row == 0 ? "image" : names[parameter], {kLeft - 8.0, y + 13.5}, 7.5, colours.text,
               Align::kRight, row == 0);
    for (const SegmentContribution& segment : segments) {
      const double x0 = axes.at(segment.begin_s, 0.0).x;
      const double x1 = axes.at(segment.end_s, 0.0).x;
      const double growth = row == 0 ? segment.image : segment.values[parameter];
      sheet.fill({x0, y + 2.0, std::max(3.0, x1 - x0), kRow - 4.0}, colours.curve,
                 opacityOf(growth));
    }
    sheet.line({kLeft, y + kRow}, {width - 16.0, y + kRow}, colours.grid, row == 0 ? 1.5 : 0.5);
  }
  return sheet;
}

}  // namespace camera_self_calibration
