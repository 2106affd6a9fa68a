#include "camera_self_calibration/queue/weak_directions.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <vector>

#include "camera_self_calibration/base/decompositions.h"
#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {
namespace {

// Of the largest: parameters that move the image less than this share of it do not count.
constexpr double kDominantShare = 0.5;
// Variances beyond this are not told from no information at all [px^2].
constexpr double kUnknownVariance = 1e14;

const char* const kAnyHint =
    "turn the camera about several axes (pan, tilt and roll) while moving it, with near and far "
    "objects in view";
const char* const kFocalHint =
    "turn the camera about several axes (pan, tilt and roll): translation alone does not determine "
    "the focal length";
const char* const kHorizontalHint = "pan left and right, or roll about the viewing direction";
const char* const kVerticalHint = "tilt up and down, or roll about the viewing direction";
const char* const kCentreHint =
    "roll about the viewing direction while panning and tilting, also with the camera upside down "
    "or on its side";
const char* const kDistortionHint =
    "turn the camera so that features cross the image into its corners";

enum Group { kFocal, kCentre, kDistortion };

Group groupOf(Eigen::Index parameter) {
  return parameter < 2 ? kFocal : parameter < 4 ? kCentre : kDistortion;
}

std::string nameOf(Group group, const std::vector<Eigen::Index>& members, const Camera& camera) {
  static const char* const kNames[] = {"the focal length", "the principal point", "the distortion"};
  std::string text = kNames[group];
  for (std::size_t i = 0; i < members.size(); ++i) {
    text += (i == 0 ? " (" : ", ") + camera.parameterNames()[static_cast<std::size_t>(members[i])];
  }
  return text + ")";
}

std::string hintFor(const std::vector<Eigen::Index>& parameters) {
  bool in_group[3] = {false, false, false};
  bool fx = false, fy = false;
  for (const Eigen::Index i : parameters) {
    in_group[groupOf(i)] = true;
    fx |= i == 0;
    fy |= i == 1;
  }
  if (fx && fy) return kFocalHint;
  if (fx) return kHorizontalHint;
  if (fy) return kVerticalHint;
  if (in_group[kDistortion]) return kDistortionHint;
  return in_group[kCentre] ? kCentreHint : kAnyHint;
}

}  // namespace

KnownDirections knownDirections(const Camera& camera, const IntrinsicsMatrix& information) {
  const int n = camera.estimatedCount();
  if (information.rows() != n || information.cols() != n || !information.allFinite()) return {};
  Eigen::MatrixXd metric = pixelMetric(camera);
  if (!metric.allFinite() || !(metric.trace() > 0.0)) return {};
  // What moves no pixel at all must not divide by zero.
  metric.diagonal() += 1e-12 * metric.diagonal() + Eigen::VectorXd::Constant(n, 1e-300);
  const Eigen::LLT<Eigen::MatrixXd> cholesky(metric);
  if (cholesky.info() != Eigen::Success) return {};
  const Eigen::MatrixXd root = cholesky.matrixL();  // metric = root root^T
  Eigen::MatrixXd scaled = root.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd(information));
  scaled = root.triangularView<Eigen::Lower>().solve(Eigen::MatrixXd(scaled.transpose()));
  const SymmetricEigen eigen = symmetricEigen(scaled);
  KnownDirections directions;
  directions.sigma_px = eigen.values.unaryExpr([](double value) {
    return value * kUnknownVariance > 1.0 ? 1.0 / std::sqrt(value)
                                          : std::numeric_limits<double>::infinity();
  });
  directions.axes = root.transpose().triangularView<Eigen::Upper>().solve(eigen.vectors);
  directions.coordinates = eigen.vectors.transpose() * root.transpose();
  return directions;
}

Camera withWeakDirectionsHeld(const Camera& estimate, const IntrinsicsMatrix& information,
                              const Camera& trusted, double limit_px) {
  const KnownDirections directions = knownDirections(trusted, information);
  if (directions.sigma_px.size() == 0) return trusted;
  const Eigen::Index n = directions.sigma_px.size();
  Eigen::VectorXd parts =
      directions.coordinates * (estimate.parameters() - trusted.parameters()).head(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!(directions.sigma_px(i) < limit_px)) parts(i) = 0.0;
  }
  Intrinsics parameters = trusted.parameters();
  parameters.head(n) += directions.axes * parts;
  Camera result = trusted;
  if (!parameters.allFinite()) return trusted;
  result.setParameters(parameters);
  return result.valid() ? result : trusted;
}

WeakDirection weakestDirection(const IntrinsicsMatrix& information, const Camera& camera) {
  const KnownDirections directions = knownDirections(camera, information);
  if (directions.sigma_px.size() == 0) return {"all parameters", kAnyHint};
  const Intrinsics weight = pixelMetric(camera).diagonal().cwiseSqrt();
  const Intrinsics share = directions.axes.col(0).cwiseAbs().cwiseProduct(weight);
  std::vector<Eigen::Index> dominant;
  std::vector<Eigen::Index> members[3];
  for (Eigen::Index i = 0; i < share.size(); ++i) {
    if (!(share(i) >= kDominantShare * share.maxCoeff())) continue;
    dominant.push_back(i);
    members[groupOf(i)].push_back(i);
  }
  WeakDirection weak;
  for (const Group group : {kFocal, kCentre, kDistortion}) {
    if (members[group].empty()) continue;
    weak.name += (weak.name.empty() ? "" : " with ") + nameOf(group, members[group], camera);
  }
  weak.hint = hintFor(dominant);
  return weak;
}

}  // namespace camera_self_calibration
