#include "report_pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/plotting/histogram.h"
#include "camera_self_calibration/plotting/image_map.h"
#include "camera_self_calibration/plotting/line_chart.h"
#include "camera_self_calibration/plotting/trajectory_chart.h"
#include "camera_self_calibration/queue/observed_area.h"
#include "camera_self_calibration/queue/queue_residuals.h"
#include "camera_self_calibration/reference/trajectory_comparison.h"

namespace camera_self_calibration {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
const Colour kOrange(20, 110, 226);

/// What falls into one cell of the image.
struct Cell {
  int count = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double squares = 0.0;
};

/// What lies at one distance from the principal point, or in one keyframe.
struct Ring {
  double count = 0.0;
  double radius = 0.0;  // sums of what they are called
  double outwards = 0.0;
  double squares = 0.0;

  void add(double at, double outward, const Eigen::Vector2d& residual) {
    count += 1.0;
    radius += at;
    outwards += outward;
    squares += residual.squaredNorm();
  }
};

LineChartSheet onePanel(const std::string& x_label) {
  LineChartSheet sheet;
  sheet.x_label = x_label;
  sheet.columns = 1;
  sheet.width = kChartWidth;
  sheet.panel_height = 250;
  sheet.quantile = 1.0;
  return sheet;
}

std::vector<QueueResidual> residualsOf(const Recording& recording) {
  if (!recording.learnt) return {};
  return queueResiduals(recording.learnt->segments, recording.learnt->camera);
}

std::vector<Cell> cellsOf(const Recording& recording) {
  const Camera& camera = recording.final_report.camera;
  std::vector<Cell> cells(kMapColumns * kMapRows);
  for (const QueueResidual& seen : residualsOf(recording)) {
    Cell& cell = cells[static_cast<std::size_t>(
        partOf(seen.pixel.y(), camera.height(), kMapRows) * kMapColumns +
        partOf(seen.pixel.x(), camera.width(), kMapColumns))];
    ++cell.count;
    cell.sum += seen.residual;
    cell.squares += seen.residual.squaredNorm();
  }
  return cells;
}

ImageMap mapOver(const Camera& camera, const std::string& title, const std::string& unit) {
  ImageMap map;
  map.title = title;
  map.unit = unit;
  map.image_width = camera.width();
  map.image_height = camera.height();
  return map;
}

Eigen::MatrixXd gridOf(const std::vector<Cell>& cells, double (*value)(const Cell&)) {
  Eigen::MatrixXd grid(kMapRows, kMapColumns);
  for (int r = 0; r < kMapRows; ++r) {
    for (int c = 0; c < kMapColumns; ++c) {
      grid(r, c) = value(cells[static_cast<std::size_t>(r * kMapColumns + c)]);
    }
  }
  return grid;
}

/// A power of ten, or 2 or 5 times one, that makes `longest` about `wanted` long.
double roundScale(double longest, double wanted) {
  if (!(longest > 0.0)) return 1.0;
  const double raw = wanted / longest;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  return power * (raw / power < 2.0 ? 1.0 : raw / power < 5.0 ? 2.0 : 5.0);
}

/// Right and forward of the first camera, made level: axes of a map seen from above.
struct GroundPlane {
  Eigen::Vector3d right = Eigen::Vector3d::UnitX();
  Eigen::Vector3d forward = Eigen::Vector3d::UnitZ();

  explicit GroundPlane(const std::vector<StampedCameraPose>& poses) {
    Eigen::Vector3d down = Eigen::Vector3d::Zero();
    for (const StampedCameraPose& pose : poses) {
      down += pose.world_from_camera.rotation * Eigen::Vector3d::UnitY();
    }
    if (poses.empty() || !(down.norm() > 1e-6)) return;
    down.normalize();
    const Eigen::Vector3d ahead =
        poses.front().world_from_camera.rotation * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d level = ahead - down * down.dot(ahead);
    if (!(level.norm() > 1e-6)) return;
    forward = level.normalized();
    right = down.cross(forward);
  }

  Eigen::Vector2d operator()(const Eigen::Vector3d& point) const {
    return {right.dot(point), forward.dot(point)};
  }
};

PlanePath pathOf(const std::string& name, const Colour& colour,
                 const std::vector<StampedCameraPose>& poses, const GroundPlane& plane) {
  PlanePath path;
  path.name = name;
  path.colour = colour;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i > 0 && poses[i].map_id != poses[i - 1].map_id) path.points.emplace_back(kNone, kNone);
    path.points.push_back(plane(poses[i].world_from_camera.translation));
  }
  return path;
}

// Centres of areas of two by two grid points that no feature reached.
std::vector<Eigen::Vector2d> unobservedPixels(const Recording& recording) {
  std::vector<Eigen::Vector2d> pixels;
  if (!recording.learnt) return pixels;
  const Camera& camera = recording.learnt->camera;
  const ImageField observed = observedArea(recording.learnt->segments, camera, {});
  for (int row = 0; row + 1 < ImageField::kRows; row += 2) {
    for (int column = 0; column + 1 < ImageField::kColumns; column += 2) {
      if (observed.sees(column, row) || observed.sees(column + 1, row + 1)) continue;
      const auto pixel = [&](int c, int r) {
        return ImageField::pixel(c, r, camera.width(), camera.height());
      };
      pixels.push_back(0.5 * (pixel(column, row) + pixel(column + 1, row + 1)));
    }
  }
  return pixels;
}

}  // namespace

int partOf(double position, int size, int parts) {
  return std::clamp(static_cast<int>((position + 0.5) / size * parts), 0, parts - 1);
}

Colour verdictColour(AuditVerdict verdict) {
  return stateColour(verdict == AuditVerdict::kGood    ? CalibrationState::kConverged
                     : verdict == AuditVerdict::kWrong ? CalibrationState::kDegenerate
                                                       : CalibrationState::kInitializing);
}

Sheet drawUncertainty(const Recording& recording) {
  const CalibrationReport& report = recording.final_report;
  ImageMap map = mapOver(report.camera, "error by noise (1 sigma); crosses: no features", "px");
  map.crosses = unobservedPixels(recording);
  map.values = Eigen::MatrixXd::Constant(30, 40, kNone);
  const double inflation = report.cross_validation.inflation();
  for (const UncertainPixel& point : uncertaintyOverImage(report.camera, report.covariance)) {
    const auto row = std::lround(point.pixel.y() / (report.camera.height() - 1) * 29.0);
    const auto column = std::lround(point.pixel.x() / (report.camera.width() - 1) * 39.0);
    map.values(std::clamp(row, 0L, 29L), std::clamp(column, 0L, 39L)) = inflation * point.sigma;
  }
  return drawImageMap(map, kChartWidth);
}

Sheet drawResidualMap(const Recording& recording) {
  const Camera& camera = recording.final_report.camera;
  const std::vector<Cell> cells = cellsOf(recording);
  ImageMap map = mapOver(camera, "residuals: rms (colour) and mean (arrows)", "px");
  map.values = gridOf(cells, [](const Cell& cell) {
    return cell.count > 3 ? std::sqrt(cell.squares / cell.count) : kNone;
  });
  double longest = 0.0;
  for (int r = 0; r < kMapRows; ++r) {
    for (int c = 0; c < kMapColumns; ++c) {
      const Cell& cell = cells[static_cast<std::size_t>(r * kMapColumns + c)];
      if (cell.count < 10) continue;
      const Eigen::Vector2d centre((c + 0.5) / kMapColumns * camera.width() - 0.5,
                                   (r + 0.5) / kMapRows * camera.height() - 0.5);
      map.arrows.push_back({centre, cell.sum / cell.count});
      longest = std::max(longest, map.arrows.back().offset.norm());
    }
  }
  map.arrow_scale = roundScale(longest, 1.2 * camera.width() / kMapColumns);
  return drawImageMap(map, kChartWidth);
}

Sheet drawCoverage(const Recording& recording) {
  ImageMap map = mapOver(recording.final_report.camera, "observations in the queue", "a cell");
  map.values = gridOf(cellsOf(recording), [](const Cell& cell) {
    return cell.count > 0 ? static_cast<double>(cell.count) : kNone;
  });
  return drawImageMap(map, kChartWidth);
}

Sheet drawResidualDistribution(const Recording& recording) {
  std::vector<WhitenedResidual> whitened;
  double squares = 0.0;
  for (const QueueResidual& seen : residualsOf(recording)) {
    const double expected = std::sqrt(seen.expected_square);
    whitened.push_back({seen.residual.x() / seen.sigma, expected});
    whitened.push_back({seen.residual.y() / seen.sigma, expected});
    squares += seen.residual.squaredNorm();
  }
  const double count = std::max<double>(1.0, static_cast<double>(whitened.size()));
  return drawResidualHistogram(
      whitened, formatted("rms %.3f px an axis", std::sqrt(squares / count)), kChartWidth, 300);
}

double residualRatio(const Recording& recording) {
  double found = 0.0;
  double expected = 0.0;
  for (const QueueResidual& seen : residualsOf(recording)) {
    found += seen.residual.squaredNorm() / (seen.sigma * seen.sigma);
    expected += 2.0 * seen.expected_square;
  }
  return expected > 0.0 ? std::sqrt(found / expected) : 0.0;
}

Sheet drawResidualsByRadius(const Recording& recording) {
  constexpr std::size_t kRings = 12;
  const Camera& camera = recording.final_report.camera;
  const Eigen::Vector2d centre = camera.parameters().segment<2>(2);
  const double reach = std::hypot(std::max(centre.x(), camera.width() - centre.x()),
                                  std::max(centre.y(), camera.height() - centre.y()));
  std::vector<Ring> rings(kRings);
  for (const QueueResidual& seen : residualsOf(recording)) {
    const Eigen::Vector2d from_centre = seen.pixel - centre;
    const double radius = from_centre.norm();
    const auto index = static_cast<std::size_t>(radius / reach * kRings);
    if (radius > 0.0 && index < kRings) {
      rings[index].add(radius, seen.residual.dot(from_centre) / radius, seen.residual);
    }
  }
  const Palette& colours = palette(Theme::kLight);
  Curve rms{"rms an axis", colours.curve, false, {}, {}, {}};
  Curve outwards{"mean, outwards, 3 sigma", kOrange, false, {}, {}, {}};
  for (const Ring& ring : rings) {
    if (ring.count < 10) continue;
    rms.x.push_back(ring.radius / ring.count);
    rms.y.push_back(std::sqrt(0.5 * ring.squares / ring.count));
    outwards.x.push_back(rms.x.back());
    outwards.y.push_back(ring.outwards / ring.count);
    outwards.spread.push_back(3.0 * rms.y.back() / std::sqrt(ring.count));
  }
  LineChart chart;
  chart.title = "residuals by distance from the centre [px]";
  chart.curves = {rms, outwards};
  return drawLineCharts({chart}, onePanel("distance [px]"));
}

Sheet drawResidualsOverTime(const Recording& recording, std::int64_t origin_ns) {
  std::map<std::pair<std::int64_t, std::int64_t>, Ring> keyframes;  // by segment and stamp
  for (const QueueResidual& seen : residualsOf(recording)) {
    keyframes[{seen.sequence, seen.stamp_ns}].add(0.0, 0.0, seen.residual);
  }
  // One curve a segment; they may overlap, and a curve that went on to the next would mean nothing.
  std::map<std::int64_t, Curve> segments;
  for (const auto& [key, ring] : keyframes) {
    Curve& curve = segments[key.first];
    curve.colour = palette(Theme::kLight).curve;
    curve.x.push_back(toSeconds(key.second - origin_ns));
    curve.y.push_back(std::sqrt(0.5 * ring.squares / ring.count));
  }
  LineChart chart;
  chart.title = "residuals by keyframe: rms an axis [px]";
  for (auto& [sequence, curve] : segments) chart.curves.push_back(std::move(curve));
  return drawLineCharts({chart}, onePanel("time [s]"));
}

Sheet drawTrajectory(const std::vector<StampedCameraPose>& own,
                     const std::vector<StampedCameraPose>& with_reference,
                     const std::vector<StampedCameraPose>& ground_truth, std::string unit) {
  const Colour blue = palette(Theme::kLight).curve, black = palette(Theme::kLight).text;
  std::vector<PlanePath> paths;
  if (!ground_truth.empty()) {
    const GroundPlane plane(alignedTo(ground_truth, own));
    unit = "units of the ground truth";
    paths = {
        pathOf("self-calibrating", blue, alignedTo(ground_truth, own), plane),
        pathOf("reference calibration", kOrange, alignedTo(ground_truth, with_reference), plane),
        pathOf("ground truth", black, ground_truth, plane)};
    paths.back().width = 3.0;
  } else if (!with_reference.empty()) {
    const GroundPlane plane(with_reference);
    paths = {pathOf("self-calibrating", blue, alignedTo(with_reference, own), plane),
             pathOf("reference calibration", kOrange, with_reference, plane)};
  } else {
    paths = {pathOf("", blue, own, GroundPlane(own))};
  }
  paths.erase(std::remove_if(paths.begin(), paths.end(),
                             [](const PlanePath& path) { return path.points.empty(); }),
              paths.end());
  return drawPaths(paths, "path of the camera from above", unit, kChartWidth, 330);
}

}  // namespace camera_self_calibration
