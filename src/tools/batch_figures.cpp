#include "batch_figures.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "camera_self_calibration/plotting/line_chart.h"

namespace camera_self_calibration {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
const Colour kQueueColour(190, 100, 24);
const Colour kBatchColour(20, 110, 226);

double sigmaOf(const IntrinsicsMatrix& covariance, Eigen::Index i) {
  return i < covariance.rows() ? std::sqrt(covariance(i, i)) : kNone;
}

/// A figure cannot show the parameters of two models: the last one counts.
template <typename Estimate>
bool ofLastModel(const Estimate& estimate, const std::vector<Estimate>& all) {
  return estimate.camera.model() == all.back().camera.model();
}

double valueOf(const Camera& camera, Eigen::Index i) {
  return i < camera.parameters().size() ? camera.parameters()(i) : kNone;
}

/// log10 |Sigma'|, from h = 1/2 ln |2 pi e Sigma'|: twice the sum of log10 of the normalised sigmas
/// along the axes of the ellipsoid of uncertainty.
double logDeterminant(double entropy, Eigen::Index count) {
  if (count == 0 || !std::isfinite(entropy)) return kNone;
  const double n = static_cast<double>(count);
  return (2.0 * entropy - n * std::log(2.0 * M_PI * M_E)) / std::log(10.0);
}

Curve parameterCurve(const std::vector<CalibrationReport>& reports, Eigen::Index i) {
  Curve curve;
  curve.name = "queue";
  curve.colour = kQueueColour;
  for (const CalibrationReport& report : reports) {
    if (!ofLastModel(report, reports)) continue;
    const double sigma = sigmaOf(report.covariance, i);
    curve.x.push_back(static_cast<double>(report.keyframes));
    curve.y.push_back(std::isnan(sigma) ? kNone : valueOf(report.camera, i));
    curve.spread.push_back(3.0 * sigma);
  }
  return curve;
}

Curve parameterCurve(const std::vector<BatchEstimate>& estimates, Eigen::Index i) {
  Curve curve;
  curve.name = estimates.empty() ? "" : "batch of the whole trajectory";
  curve.colour = kBatchColour;
  curve.dashed = true;
  for (const BatchEstimate& estimate : estimates) {
    if (!ofLastModel(estimate, estimates)) continue;
    curve.x.push_back(estimate.keyframes);
    curve.y.push_back(valueOf(estimate.camera, i));
    curve.spread.push_back(3.0 * sigmaOf(estimate.covariance, i));
  }
  return curve;
}

LineChart determinantChart(const std::vector<CalibrationReport>& reports,
                           const BatchComparison& comparison) {
  LineChart chart;
  chart.title = "uncertainty of all parameters, log10 (lower is better)";
  Curve queue{"queue", kQueueColour, false, {}, {}, {}};
  for (const CalibrationReport& report : reports) {
    if (!ofLastModel(report, reports)) continue;
    queue.x.push_back(static_cast<double>(report.keyframes));
    queue.y.push_back(logDeterminant(report.entropy, report.covariance.rows()));
  }
  Curve batch{comparison.batch.empty() ? "" : "batch", kBatchColour, true, {}, {}, {}};
  for (const BatchEstimate& estimate : comparison.batch) {
    if (!ofLastModel(estimate, comparison.batch)) continue;
    batch.x.push_back(estimate.keyframes);
    batch.y.push_back(logDeterminant(estimate.entropy, estimate.covariance.rows()));
  }
  chart.curves = {queue, batch};
  return chart;
}

std::optional<double> levelOf(const std::optional<Camera>& reference, const Camera& camera,
                              Eigen::Index i) {
  if (!reference || reference->model() != camera.model()) return std::nullopt;
  const double value = valueOf(*reference, i);
  return std::isnan(value) ? std::nullopt : std::optional<double>(value);
}

void markHandover(const std::vector<CalibrationReport>& reports, std::vector<LineChart>* charts) {
  for (const CalibrationReport& report : reports) {
    if (!report.handed_over) continue;
    for (LineChart& chart : *charts) chart.marks = {static_cast<double>(report.keyframes)};
    return;
  }
}

LineChart parameterChart(const std::vector<CalibrationReport>& reports,
                         const BatchComparison& comparison, const std::optional<Camera>& reference,
                         Eigen::Index i) {
  const Camera& camera = reports.back().camera;
  LineChart chart;
  chart.title = camera.parameterNames()[static_cast<std::size_t>(i)];
  if (i < 4) chart.title += " [px]";
  chart.curves = {parameterCurve(reports, i), parameterCurve(comparison.batch, i)};
  chart.level = levelOf(reference, camera, i);
  return chart;
}

LineChartSheet sheetOf(const std::string& title, const std::optional<Camera>& reference) {
  LineChartSheet sheet;
  sheet.title = title;
  sheet.x_label = "keyframes";
  sheet.level_name = reference ? "reference calibration" : "";
  return sheet;
}

std::vector<LineChart> parameterCharts(const std::vector<CalibrationReport>& reports,
                                       const BatchComparison& comparison,
                                       const std::optional<Camera>& reference) {
  std::vector<LineChart> charts;
  const Eigen::Index count = reports.back().camera.estimatedCount();
  for (Eigen::Index i = 0; i < count; ++i) {
    charts.push_back(parameterChart(reports, comparison, reference, i));
  }
  charts.push_back(determinantChart(reports, comparison));
  markHandover(reports, &charts);
  return charts;
}

void writePng(const std::string& path, const Sheet& sheet) {
  if (cv::imwrite(path, sheet.fineImage())) return;
  throw std::runtime_error(path + " cannot be written");
}

}  // namespace

Sheet drawParameterFigure(const std::vector<CalibrationReport>& reports,
                          const BatchComparison& comparison,
                          const std::optional<Camera>& reference) {
  return drawLineCharts(
      parameterCharts(reports, comparison, reference),
      sheetOf("Parameters with bounds of 3 sigma; upright dashes: hand-over to the queue",
              reference));
}

std::vector<Sheet> drawParameterPanels(const std::vector<CalibrationReport>& reports,
                                       const BatchComparison& comparison,
                                       const std::optional<Camera>& reference, int width) {
  LineChartSheet style = sheetOf("", reference);
  style.columns = 1;
  style.width = width;
  style.panel_height = 180;
  std::vector<Sheet> panels;
  for (LineChart& chart : parameterCharts(reports, comparison, reference)) {
    // With nothing to compare there is one curve, which needs no legend.
    if (comparison.batch.empty() && !reference) {
      for (Curve& curve : chart.curves) curve.name.clear();
    }
    panels.push_back(drawLineCharts({chart}, style));
  }
  return panels;
}

Sheet drawFocalLengthFigure(const std::vector<CalibrationReport>& reports,
                            const BatchComparison& comparison,
                            const std::optional<Camera>& reference) {
  std::vector<LineChart> charts = {parameterChart(reports, comparison, reference, 0),
                                   determinantChart(reports, comparison)};
  markHandover(reports, &charts);
  LineChartSheet sheet = sheetOf("Focal length, and uncertainty of all parameters", reference);
  sheet.columns = 1;
  sheet.panel_height = 230;
  return drawLineCharts(charts, sheet);
}

Sheet drawQueueSizeFigure(const BatchComparison& comparison, const std::optional<Camera>& reference,
                          int width) {
  LineChart chart;
  chart.title = "fx [px]";
  for (std::size_t i = 0; i < comparison.sizes.size(); ++i) {
    const QueueSizeRun& run = comparison.sizes[i];
    Curve curve = parameterCurve(run.reports, 0);
    curve.name = "queue of " + std::to_string(run.segments);
    const double share = static_cast<double>(i) / static_cast<double>(comparison.sizes.size());
    curve.colour = scoreColour(0.25 + 0.75 * share);
    curve.spread.clear();
    chart.curves.push_back(curve);
    if (!run.reports.empty()) chart.level = levelOf(reference, run.reports.back().camera, 0);
  }
  Curve batch = parameterCurve(comparison.batch, 0);
  batch.spread.clear();
  chart.curves.push_back(batch);
  LineChartSheet sheet = sheetOf("Queues of different size", reference);
  sheet.width = width;
  sheet.columns = 1;
  sheet.panel_height = 320;
  sheet.quantile = 0.93;
  return drawLineCharts({chart}, sheet);
}

void writeBatchFigures(const std::string& folder, const std::vector<CalibrationReport>& reports,
                       const BatchComparison& comparison, const std::optional<Camera>& reference) {
  if (reports.empty()) return;
  const std::filesystem::path path(folder);
  writePng((path / "fig4_parameters.png").string(),
           drawParameterFigure(reports, comparison, reference));
  writePng((path / "fig5_focal_length.png").string(),
           drawFocalLengthFigure(reports, comparison, reference));
  writePng((path / "fig7_queue_sizes.png").string(),
           drawQueueSizeFigure(comparison, reference, 1000));
}

}  // namespace camera_self_calibration
