#include "camera_self_calibration/tools/fleet_report.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/plotting/line_chart.h"
#include "camera_self_calibration/plotting/palette.h"
#include "html_page.h"
#include "report_numbers.h"

namespace camera_self_calibration {
namespace {

// What a page can hold and a reader look at.
constexpr std::size_t kCharts = 40;
constexpr std::size_t kRows = 200;
constexpr std::size_t kBestBags = 20;
constexpr double kSecondsInADay = 86400.0;

using Row = std::vector<std::string>;

Colour colourOf(CameraVerdict verdict) {
  switch (verdict) {
    case CameraVerdict::kSteady:
      return stateColour(CalibrationState::kConverged);
    case CameraVerdict::kChanged:
      return stateColour(CalibrationState::kInitializing);
    case CameraVerdict::kOutlier:
      return stateColour(CalibrationState::kDegenerate);
    case CameraVerdict::kVague:
      return stateColour(CalibrationState::kConverging);
    case CameraVerdict::kUnknown:
      break;
  }
  return stateColour(CalibrationState::kWaitingForMotion);
}

// Those that need a look first; within a kind by name.
std::vector<const CameraResult*> byUrgency(const std::vector<CameraResult>& cameras) {
  std::vector<const CameraResult*> order;
  order.reserve(cameras.size());
  for (const CameraResult& camera : cameras) order.push_back(&camera);
  std::stable_sort(order.begin(), order.end(), [](const CameraResult* a, const CameraResult* b) {
    return verdictOf(*a) > verdictOf(*b);
  });
  return order;
}

std::size_t countOf(const std::vector<CameraResult>& cameras, CameraVerdict verdict) {
  return static_cast<std::size_t>(
      std::count_if(cameras.begin(), cameras.end(),
                    [&](const CameraResult& camera) { return verdictOf(camera) == verdict; }));
}

std::string inAll(std::size_t shown, std::size_t all, const std::string& where) {
  if (shown >= all) return "";
  return " The first " + std::to_string(shown) + " of " + std::to_string(all) + "; all are in " +
         where + ".";
}

void addHead(const std::vector<CameraResult>& cameras, const std::vector<std::string>& problems,
             HtmlPage* page) {
  std::size_t bags = 0;
  for (const CameraResult& camera : cameras) bags += camera.history.bags.size();
  const std::size_t steady = countOf(cameras, CameraVerdict::kSteady);
  const bool well = steady == cameras.size();
  page->verdict(well ? "ALL STEADY" : std::to_string(cameras.size() - steady) + " TO LOOK AT",
                cssColour(colourOf(well ? CameraVerdict::kSteady : CameraVerdict::kVague)),
                std::to_string(steady) + " of " + std::to_string(cameras.size()) +
                    " cameras have had one lens in all their bags, known well enough.");
  page->figures({{std::to_string(cameras.size()), "cameras"},
                 {std::to_string(bags), "bags with a result"},
                 {std::to_string(problems.size()), "bags without a result"},
                 {std::to_string(countOf(cameras, CameraVerdict::kChanged)), "changed"},
                 {std::to_string(countOf(cameras, CameraVerdict::kOutlier)), "outliers"},
                 {std::to_string(countOf(cameras, CameraVerdict::kVague)), "vague"},
                 {std::to_string(countOf(cameras, CameraVerdict::kUnknown)), "unknown"}});
}

std::string withSigma(const EpochResult& epoch, Eigen::Index i) {
  if (!epoch.solved || i >= epoch.lens.estimatedCount()) return "-";
  const double sigma = std::sqrt(epoch.solution.covariance(i, i));
  const int digits = decimalsFor(sigma);
  return number(epoch.lens.parameters()(i), digits) + " \u00b1 " + number(sigma, digits);
}

void addCameras(const std::vector<const CameraResult*>& cameras, HtmlPage* page) {
  const std::size_t shown = std::min(kRows, cameras.size());
  page->section("Cameras",
                "The present lens. Sigmas are of noise and of what bags disagree; the error "
                "contains a misfit of the lens model too." +
                    inAll(shown, cameras.size(), "fleet.json"));
  std::vector<Row> rows = {{"camera", "verdict", "bags", "epochs", "model", "fx [px]", "fy [px]",
                            "cx [px]", "cy [px]", "error [px rms]"}};
  for (std::size_t i = 0; i < shown; ++i) {
    const CameraResult& camera = *cameras[i];
    const EpochResult& present = camera.present();
    Row row = {camera.history.name, toString(verdictOf(camera)),
               std::to_string(camera.history.bags.size()), std::to_string(camera.history.epochs()),
               toString(camera.history.lens.model())};
    for (Eigen::Index k = 0; k < 4; ++k) row.push_back(withSigma(present, k));
    row.push_back(present.solved ? number(present.solution.uncertainty_px, 3) : "-");
    rows.push_back(std::move(row));
  }
  page->table(rows);
}

Curve levelCurve(double begin, double end, double value, double sigma, const Colour& colour) {
  Curve curve;
  curve.colour = colour;
  curve.x = {begin, end};
  curve.y = {value, value};
  curve.spread = {3.0 * sigma, 3.0 * sigma};
  return curve;
}

struct TimeAxis {
  std::int64_t origin_ns = 0;
  double least = 0.0;  // half the width of a bag, so that it is seen
  double at(std::int64_t stamp_ns) const {
    return toSeconds(stamp_ns - origin_ns) / kSecondsInADay;
  }
};

TimeAxis axisOf(const CameraHistory& history) {
  TimeAxis axis{history.bags.front().record.begin_ns, 0.0};
  axis.least = std::max(1e-6, axis.at(history.bags.back().record.end_ns)) / 200.0;
  return axis;
}

std::vector<Curve> curvesOf(const CameraResult& camera, Eigen::Index i) {
  const Palette& colours = palette(Theme::kLight);
  const TimeAxis axis = axisOf(camera.history);
  std::vector<Curve> curves;
  std::vector<double> begins(camera.epochs.size(), INFINITY), ends(camera.epochs.size(), 0.0);
  for (const HistoricBag& bag : camera.history.bags) {
    if (!bag.problem.empty()) continue;
    const double begin = axis.at(bag.record.begin_ns) - axis.least;
    const double end = axis.at(bag.record.end_ns) + axis.least;
    curves.push_back(levelCurve(begin, end, bag.used.lens.parameters()(i),
                                std::sqrt(bag.used.covariance(i, i)),
                                bag.epoch < 0 ? colours.faint_text : colours.curve));
    if (bag.epoch < 0) continue;
    const auto e = static_cast<std::size_t>(bag.epoch);
    begins[e] = std::min(begins[e], begin);
    ends[e] = std::max(ends[e], end);
  }
  if (!curves.empty()) curves.front().name = "a bag, 3 sigma";
  for (std::size_t e = 0; e < camera.epochs.size(); ++e) {
    const EpochResult& epoch = camera.epochs[e];
    if (!epoch.solved) continue;
    curves.push_back(levelCurve(begins[e], ends[e], epoch.lens.parameters()(i),
                                std::sqrt(epoch.solution.covariance(i, i)), colours.truth));
    if (e == 0) curves.back().name = "all bags of an epoch, 3 sigma";
  }
  return curves;
}

Sheet drawHistory(const CameraResult& camera) {
  const std::vector<std::string> names = camera.history.lens.parameterNames();
  const TimeAxis axis = axisOf(camera.history);
  std::vector<LineChart> charts;
  for (Eigen::Index i = 0; i < camera.history.lens.estimatedCount(); ++i) {
    LineChart chart;
    chart.title = names[static_cast<std::size_t>(i)] + (i < 4 ? " [px]" : "");
    chart.curves = curvesOf(camera, i);
    for (const EpochBoundary& change : camera.history.changes) {
      chart.marks.push_back(axis.at(camera.history.bags[change.first].record.begin_ns) -
                            axis.least);
    }
    charts.push_back(std::move(chart));
  }
  LineChartSheet sheet;
  sheet.title = camera.history.name;
  sheet.x_label = "days since " + timeText(axis.origin_ns);
  sheet.panel_height = 120;
  sheet.quantile = 1.0;
  return drawLineCharts(charts, sheet);
}

void addHistories(const std::vector<const CameraResult*>& cameras, HtmlPage* page) {
  const std::size_t shown = std::min(kCharts, cameras.size());
  page->section("Values over time",
                "What each bag said, and what all bags of an epoch say together. A line marks the "
                "first bag after a change of the lens." +
                    inAll(shown, cameras.size(), "NAME.history.csv"));
  for (std::size_t i = 0; i < shown; ++i) {
    const CameraVerdict verdict = verdictOf(*cameras[i]);
    page->verdict(toString(verdict), cssColour(colourOf(verdict)),
                  cameras[i]->history.name + ": " + sentenceOf(*cameras[i]));
    page->charts({{drawHistory(*cameras[i]), "Values over time of " + cameras[i]->history.name}});
  }
}

void addSiblings(const std::vector<const CameraResult*>& cameras, HtmlPage* page) {
  std::vector<Row> rows = {
      {"camera", "siblings", "from their mean [px rms]", "they differ by [px rms]", "p", ""}};
  for (const CameraResult* camera : cameras) {
    const SiblingVerdict& verdict = camera->siblings;
    if (verdict.siblings == 0 || rows.size() > kRows) continue;
    rows.push_back({camera->history.name, std::to_string(verdict.siblings),
                    number(verdict.distance_px, 2), number(verdict.spread_px, 2),
                    pText(verdict.p_value), verdict.outlier ? "outlier" : ""});
  }
  page->section(
      "Siblings",
      "Cameras of one type: the same name after the last slash (robot7/front), model and image "
      "size. An "
      "outlier is further from the mean of the others than its uncertainty, theirs and "
      "the spread of the type allow.");
  if (rows.size() > 1) {
    page->table(rows);
  } else {
    page->paragraph("No type has three cameras. Of two that differ, either may be off.");
  }
}

struct RankedBag {
  const CameraResult* camera;
  std::size_t bag;
  const BagWorth& worth() const { return camera->worth[bag]; }
  const HistoricBag& historic() const { return camera->history.bags[bag]; }
};

std::string growthText(const BagWorth& worth) {
  if (worth.segments == 0) return "-";
  return (std::isfinite(worth.growth) ? "+" : "") + percent(worth.growth);
}

Row rowOf(const RankedBag& bag) {
  return {bag.historic().record.bag, bag.camera->history.name,
          timeText(bag.historic().record.begin_ns), std::to_string(bag.worth().segments),
          growthText(bag.worth())};
}

void addBags(const std::vector<const CameraResult*>& cameras, HtmlPage* page) {
  std::vector<RankedBag> best, idle;
  for (const CameraResult* camera : cameras) {
    for (std::size_t i = 0; i < camera->worth.size(); ++i) {
      (camera->worth[i].segments > 0 ? best : idle).push_back({camera, i});
    }
  }
  std::stable_sort(best.begin(), best.end(), [](const RankedBag& a, const RankedBag& b) {
    return a.worth().growth > b.worth().growth;
  });
  const Row header = {"bag", "camera", "from", "segments in use", "error without it"};
  const auto table = [&](const std::vector<RankedBag>& bags, std::size_t most) {
    std::vector<Row> rows = {header};
    for (std::size_t i = 0; i < std::min(most, bags.size()); ++i) rows.push_back(rowOf(bags[i]));
    page->table(rows);
  };
  page->section("Most informative bags", "The calibrations rest on segments of " +
                                             std::to_string(best.size()) + " bags." +
                                             inAll(kBestBags, best.size(), "bags.csv"));
  table(best, kBestBags);
  page->section("Bags that could be deleted",
                "No calibration rests on a segment of these " + std::to_string(idle.size()) +
                    " bags: better ones are known of their epoch. What they said of the lens stays "
                    "in the states." +
                    inAll(kRows, idle.size(), "bags.csv"));
  if (!idle.empty()) table(idle, kRows);
}

void addProblems(const std::vector<std::string>& problems, HtmlPage* page) {
  if (problems.empty()) return;
  page->section("Bags without a result", inAll(kRows, problems.size(), "the output"));
  std::vector<Row> rows = {{"bag or file, and why"}};
  for (std::size_t i = 0; i < std::min(kRows, problems.size()); ++i) rows.push_back({problems[i]});
  page->table(rows);
}

}  // namespace

std::string fleetHtml(const std::vector<CameraResult>& cameras,
                      const std::vector<std::string>& problems) {
  const std::vector<const CameraResult*> order = byUrgency(cameras);
  HtmlPage page("Cameras of the fleet");
  addHead(cameras, problems, &page);
  addCameras(order, &page);
  addHistories(order, &page);
  addSiblings(order, &page);
  addBags(order, &page);
  addProblems(problems, &page);
  return page.text();
}

}  // namespace camera_self_calibration
