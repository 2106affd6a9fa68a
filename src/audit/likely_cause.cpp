#include "camera_self_calibration/audit/likely_cause.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/pixel_grid.h"

namespace camera_self_calibration {
namespace {

using Column = Intrinsics;  // how one free value changes the parameters
using Fits = std::function<bool(const Camera&)>;

struct Step {
  double cost = std::numeric_limits<double>::infinity();
  Eigen::VectorXd values;  // of the columns, Gauss-Newton
};

// No rotation is removed: it would hide where the principal point is.
Step stepOf(const Camera& camera, const std::vector<PixelRay>& samples,
            const std::vector<Column>& columns) {
  const auto count = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd change(camera.parameterCount(), count);
  for (Eigen::Index i = 0; i < count; ++i) change.col(i) = columns[static_cast<std::size_t>(i)];
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(count);
  double sum = 0.0;
  double projected = 0.0;
  for (const PixelRay& sample : samples) {
    Eigen::Vector2d pixel;
    PixelIntrinsicsJacobian d_parameters;
    if (!camera.project(sample.ray, &pixel, nullptr, &d_parameters)) continue;
    const Eigen::MatrixXd j = d_parameters * change;
    const Eigen::Vector2d residual = pixel - sample.pixel;
    h += sample.weight * j.transpose() * j;
    g += sample.weight * j.transpose() * residual;
    sum += sample.weight * residual.squaredNorm();
    projected += sample.weight;
  }
  Step step;
  if (projected > 0.0) step.cost = sum / projected;
  step.values = -h.ldlt().solve(g);
  return step;
}

// The values of the columns that bring the camera closest to what the samples say.
Camera fitted(Camera camera, const std::vector<PixelRay>& samples,
              const std::vector<Column>& columns) {
  constexpr int kSteps = 20;
  constexpr double kGain = 1e-6;  // of the cost, below which it has settled
  Step step = stepOf(camera, samples, columns);
  for (int i = 0; i < kSteps && step.values.allFinite(); ++i) {
    Intrinsics parameters = camera.parameters();
    for (std::size_t k = 0; k < columns.size(); ++k) {
      parameters += step.values(static_cast<Eigen::Index>(k)) * columns[k];
    }
    Camera next = camera;
    next.setParameters(parameters);
    const Step after = stepOf(next, samples, columns);
    if (!next.valid() || !(after.cost < step.cost)) break;
    camera = next;
    const bool settled = after.cost > (1.0 - kGain) * step.cost;
    step = after;
    if (settled) break;
  }
  return camera;
}

Column unit(const Camera& camera, int parameter) {
  return Column::Unit(camera.parameterCount(), parameter);
}

std::vector<Column> focalColumns(const Camera& camera) {
  Column column = Column::Zero(camera.parameterCount());
  column.head<2>() = camera.parameters().head<2>();
  return {column};
}

std::vector<Column> centreColumns(const Camera& camera) {
  return {unit(camera, 2), unit(camera, 3)};
}

std::vector<Column> distortionColumns(const Camera& camera) {
  std::vector<Column> columns;
  for (int i = 4; i < camera.parameterCount(); ++i) columns.push_back(unit(camera, i));
  return columns;
}

std::vector<Column> joined(std::vector<Column> a, const std::vector<Column>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// Pixel centres lie at integer coordinates.
Camera scaled(const Camera& camera, const Camera& image, double factor) {
  Intrinsics p = camera.parameters();
  p.head<2>() *= factor;
  p.segment<2>(2) = (p.segment<2>(2).array() + 0.5) * factor - 0.5;
  return Camera(camera.model(), image.width(), image.height(), p);
}

Camera withModel(const Camera& camera, CameraModel model, const Intrinsics& parameters) {
  return Camera(model, camera.width(), camera.height(), parameters);
}

// What a calibration in question is judged by.
struct Judge {
  std::vector<PixelRay> samples;
  const Fits& fits;

  // Or would with a slightly other focal length: a mistake seldom meets a calibration that is
  // right otherwise.
  bool nearlyFits(const Camera& camera) const {
    constexpr double kSlightly = 0.05;
    if (fits(camera)) return true;
    const Camera focal = fitted(camera, samples, focalColumns(camera));
    const double factor = focal.parameters()(0) / camera.parameters()(0);
    return std::abs(factor - 1.0) < kSlightly && fits(focal);
  }
};

std::optional<CauseFound> ofResolution(const Camera& calibration, const Camera& estimate,
                                       const Judge& judge) {
  std::vector<double> factors = {0.5, 2.0, 0.25, 4.0};
  if (calibration.width() != estimate.width()) {
    factors.insert(factors.begin(), static_cast<double>(estimate.width()) / calibration.width());
  }
  for (const double factor : factors) {
    const Camera camera = scaled(calibration, estimate, factor);
    if (!judge.nearlyFits(camera)) continue;
    return CauseFound{LikelyCause::kResolution,
                      formatted("another resolution or binning: K should be that of images %g "
                                "times as large",
                                factor)};
  }
  return std::nullopt;
}

// The usual mistake: four coefficients of the one under the name of the other.
std::optional<CauseFound> ofModel(const Camera& calibration, const Judge& judge) {
  const bool radtan = calibration.model() == CameraModel::kRadtan;
  if (!radtan && calibration.model() != CameraModel::kEquidistant) return std::nullopt;
  const CameraModel other = radtan ? CameraModel::kEquidistant : CameraModel::kRadtan;
  const Camera camera = withModel(calibration, other, calibration.parameters().head<8>());
  if (!judge.nearlyFits(camera)) return std::nullopt;
  return CauseFound{LikelyCause::kModel, "the coefficients are those of " + toString(other) +
                                             ", but are given as " + toString(calibration.model())};
}

std::optional<CauseFound> ofAxes(const Camera& calibration, const Judge& judge) {
  Intrinsics p = calibration.parameters();
  std::swap(p(0), p(1));
  std::swap(p(2), p(3));
  Camera camera = calibration;
  camera.setParameters(p);
  // As it is: with a square K the focal length alone could be wrong.
  if (!judge.fits(camera)) return std::nullopt;
  return CauseFound{LikelyCause::kAxes, "x and y are swapped in K: the images were turned"};
}

std::string focalText(const Camera& calibration, const Camera& righted) {
  const double ratio = calibration.parameters()(0) / righted.parameters()(0) - 1.0;
  return formatted("the focal length is %.1f %% too %s", 100.0 * std::abs(ratio),
                   ratio > 0.0 ? "long" : "short");
}

std::string centreText(const Camera& calibration, const Camera& righted) {
  const Eigen::Vector2d off = (calibration.parameters() - righted.parameters()).segment<2>(2);
  return formatted("the principal point is off by (%.1f, %.1f) px", off.x(), off.y());
}

// With free values, from the fewest on.
std::optional<CauseFound> ofFreeValues(const Camera& calibration, const Judge& judge) {
  const auto& [samples, fits] = judge;
  const Camera focal = fitted(calibration, samples, focalColumns(calibration));
  if (fits(focal)) {
    return CauseFound{
        LikelyCause::kFocalLength,
        focalText(calibration, focal) + ": focus or zoom has changed, or the file was never right"};
  }
  const Camera centre = fitted(calibration, samples, centreColumns(calibration));
  if (fits(centre)) {
    return CauseFound{LikelyCause::kPrincipalPoint,
                      centreText(calibration, centre) +
                          ": another camera's file, a lens that was moved, or another part of the "
                          "sensor"};
  }
  const Camera both =
      fitted(calibration, samples, joined(focalColumns(calibration), centreColumns(calibration)));
  if (fits(both)) {
    return CauseFound{LikelyCause::kBoth,
                      focalText(calibration, both) + " and " + centreText(calibration, both) +
                          ": another camera's file, or a lens that was exchanged"};
  }
  return std::nullopt;
}

std::optional<CauseFound> ofDistortion(const Camera& calibration, const Judge& judge) {
  if (calibration.model() == CameraModel::kPinhole) return std::nullopt;
  const Camera camera = fitted(calibration, judge.samples, distortionColumns(calibration));
  if (!judge.fits(camera)) return std::nullopt;
  return CauseFound{LikelyCause::kDistortion, "the distortion coefficients alone are wrong"};
}

// All else may be a little off then: nobody calibrates a pinhole where there is distortion.
std::optional<CauseFound> ofMissingDistortion(const Camera& calibration, const Judge& judge) {
  if (calibration.model() != CameraModel::kPinhole) return std::nullopt;
  Intrinsics p = Intrinsics::Zero(kMaxIntrinsics);
  p.head<4>() = calibration.parameters();
  Camera camera = withModel(calibration, CameraModel::kRadtan, p);
  camera = fitted(camera, judge.samples, distortionColumns(camera));
  camera = fitted(
      camera, judge.samples,
      joined(joined(focalColumns(camera), centreColumns(camera)), distortionColumns(camera)));
  if (!judge.fits(camera)) return std::nullopt;
  return CauseFound{LikelyCause::kDistortion, "the distortion coefficients are missing"};
}

}  // namespace

std::string toString(LikelyCause cause) {
  const char* const names[] = {"none",
                               "resolution",
                               "model",
                               "axes",
                               "focal_length",
                               "principal_point",
                               "focal_length_and_principal_point",
                               "distortion",
                               "unknown"};
  return names[static_cast<int>(cause)];
}

CauseFound likelyCause(const Camera& calibration, const Camera& estimate,
                       const ImageWeights& weights, const Fits& fits) {
  const Camera start(calibration.model(), estimate.width(), estimate.height(),
                     calibration.parameters());
  const Judge judge{pixelGrid(estimate, weights), fits};
  if (fits(start)) {
    return {LikelyCause::kResolution,
            "only the image size differs, as where another part of the sensor is read"};
  }
  if (auto found = ofResolution(calibration, estimate, judge)) return *found;
  if (auto found = ofModel(start, judge)) return *found;
  if (auto found = ofAxes(start, judge)) return *found;
  if (auto found = ofFreeValues(start, judge)) return *found;
  if (auto found = ofDistortion(start, judge)) return *found;
  if (auto found = ofMissingDistortion(start, judge)) return *found;
  return {LikelyCause::kUnknown, "unknown; perhaps another camera's file, or another lens"};
}

}  // namespace camera_self_calibration
