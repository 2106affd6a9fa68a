#include "camera_self_calibration/model_choice/free_displacement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "camera_self_calibration/base/decompositions.h"
#include "camera_self_calibration/camera/pixel_grid.h"
#include "camera_self_calibration/estimation/linear_segment.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/pseudo_inverse.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/model_choice/displacement_basis.h"
#include "camera_self_calibration/model_choice/displacement_marginal.h"

namespace camera_self_calibration {
namespace {

constexpr int kCoefficients = DisplacementBasis::kCount;
// [px^-2] The test asks for displacements of a pixel, so that directions in which not even these
// would show do not dilute it.
constexpr double kSoughtWeight = 1.0;
// Of the estimated variance of the coefficients.
constexpr double kVarianceSettled = 0.01;
constexpr int kMaxVarianceSteps = 200;

// What the observations say of the coefficients with the intrinsics eliminated, along axes in which
// these are independent.
struct Coefficients {
  Eigen::MatrixXd axes;         // orthonormal columns
  Eigen::VectorXd information;  // along each [px^-2]
  Eigen::VectorXd gradient;
  Eigen::MatrixXd track_scores;
};

// How the intrinsics follow.
struct Following {
  Eigen::MatrixXd covariance;  // with the coefficients held
  Eigen::VectorXd step;        // at coefficients of zero
  Eigen::MatrixXd slope;       // n_c per coefficient
};

// Nothing where the observations do not determine the intrinsics.
std::optional<Following> followingOf(const DisplacementMarginal& marginal, int n) {
  const Eigen::MatrixXd& all = marginal.sum.information;
  const auto covariance = covarianceFromInformation(all.topLeftCorner(n, n));
  if (!covariance) return std::nullopt;
  Following following;
  following.covariance = *covariance;
  following.step = *covariance * marginal.sum.gradient.head(n);
  following.slope = -*covariance * all.topRightCorner(n, kCoefficients);
  return following;
}

Coefficients coefficientsOf(const DisplacementMarginal& marginal, const Following& following) {
  const Eigen::Index n = following.step.size();
  Eigen::MatrixXd map(n + kCoefficients, kCoefficients);
  map << following.slope, Eigen::MatrixXd::Identity(kCoefficients, kCoefficients);
  const SymmetricEigen eigen = symmetricEigen(map.transpose() * marginal.sum.information * map);
  Coefficients coefficients;
  coefficients.axes = eigen.vectors;
  coefficients.information = eigen.values.cwiseMax(0.0);
  const Eigen::MatrixXd along = map * coefficients.axes;
  coefficients.gradient = along.transpose() * marginal.sum.gradient;
  coefficients.track_scores = along.transpose() * marginal.track_scores * along;
  return coefficients;
}

// The squared step towards the displacement that is sought, in sigmas, and what chance makes of it.
struct SoughtSquare {
  double value = 0.0;
  double expected = 0.0;       // where residuals are independent
  double design_effect = 1.0;  // factor from what is correlated along tracks
  double freedom = 0.0;  // of the chi-square of the same mean and variance (Satterthwaite 1946)
};

SoughtSquare soughtSquare(const Coefficients& coefficients) {
  const Eigen::VectorXd root = (coefficients.information.array() + kSoughtWeight).rsqrt();
  SoughtSquare square;
  square.value = root.cwiseProduct(coefficients.gradient).squaredNorm();
  square.expected = root.cwiseAbs2().dot(coefficients.information);
  const Eigen::MatrixXd scores = root.asDiagonal() * coefficients.track_scores * root.asDiagonal();
  const double correlated = scores.trace();
  square.design_effect = std::max(1.0, correlated / square.expected);
  square.freedom = correlated * correlated / scores.squaredNorm();
  return square;
}

// How far the segments disagree under their joint lens with its displacement: each one's way to its
// own optimum, in its own sigmas, with what is sought for a prior. The degrees of freedom are what
// is to be expected of the sum of squares.
Scatter scatterOf(const DisplacementMarginal& marginal) {
  const Eigen::MatrixXd& total = marginal.sum.information;
  Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(total.rows(), total.cols());
  prior.diagonal().tail(kCoefficients).setConstant(kSoughtWeight);
  PseudoInverse inverse;
  inverse.compute(total + prior, LinearSegment::kRankTolerance);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(total.rows(), total.cols());
  const Eigen::MatrixXd covariance = inverse.solve(one);
  const Eigen::VectorXd joint = covariance * marginal.sum.gradient;
  const Eigen::MatrixXd of_joint = covariance * total * covariance;
  Scatter scatter;
  double expected = 0.0;
  for (const DisplacementMarginal::System& share : marginal.shares) {
    const Eigen::MatrixXd& own = share.information;
    inverse.compute(own + prior, LinearSegment::kRankTolerance);
    const Eigen::VectorXd gradient = share.gradient - own * joint;
    scatter.chi_square += gradient.dot(inverse.solve(gradient).col(0));
    const Eigen::MatrixXd noise = own + own * (of_joint - 2.0 * covariance) * own;
    expected += inverse.solve(noise).trace();
  }
  scatter.freedom = std::isfinite(expected) ? static_cast<int>(std::lround(expected)) : 0;
  return scatter;
}

// The smaller of this one and that of the lens in use; that one, where this says nothing.
Scatter disagreementOf(const LensObservations& observations, const DisplacementMarginal& marginal) {
  const Scatter own = scatterOf(marginal);
  const bool sound = own.freedom > 0 && own.chi_square >= 0.0 && std::isfinite(own.chi_square);
  return sound ? disagreement(observations, own) : observations.scatter;
}

// Variance of the coefficients under which the gradients are likeliest (expectation maximisation),
// where their own is `variance` times the information [px^2].
double varianceOf(const Coefficients& coefficients, double variance) {
  double prior = 1.0;
  for (int i = 0; i < kMaxVarianceSteps; ++i) {
    const Eigen::ArrayXd share = prior / (variance + prior * coefficients.information.array());
    const double next =
        ((share * coefficients.gradient.array()).square() + variance * share).mean();
    const bool settled = std::abs(next - prior) < kVarianceSettled * prior;
    prior = next;
    if (settled) break;
  }
  return prior;
}

// The change and its covariance, where the variance of the observations is `noise` times what their
// sigmas say.
void setEstimate(const Coefficients& coefficients, const Following& following, double noise,
                 FreeDisplacement* free) {
  const double prior = varianceOf(coefficients, noise);
  const Eigen::ArrayXd share = prior / (noise + prior * coefficients.information.array());
  const Eigen::VectorXd best = coefficients.axes * (share * coefficients.gradient.array()).matrix();
  const Eigen::MatrixXd known =
      coefficients.axes * (noise * share).matrix().asDiagonal() * coefficients.axes.transpose();
  const Eigen::MatrixXd cross = following.slope * known;
  const Eigen::Index unknowns = following.step.size() + kCoefficients;
  free->change.resize(unknowns);
  free->change << following.step + following.slope * best, best;
  free->covariance.resize(unknowns, unknowns);
  free->covariance << noise * following.covariance + cross * following.slope.transpose(), cross,
      cross.transpose(), known;
}

// The displacement of one pixel by each unknown, what a rotation of the camera absorbs removed.
using PixelChange = Eigen::Matrix<double, 2, Eigen::Dynamic>;

std::vector<PixelChange> compensatedChanges(const Camera& camera, const ImageField& field) {
  const DisplacementBasis basis(camera.width(), camera.height());
  const int n = camera.estimatedCount();
  std::vector<PixelChange> changes;
  std::vector<Matrix23d> rotations;
  Eigen::Matrix3d btb = Eigen::Matrix3d::Zero();
  Eigen::MatrixXd bta = Eigen::MatrixXd::Zero(3, n + kCoefficients);
  for (const PixelRay& point : pixelGrid(camera, field)) {
    Eigen::Vector2d pixel;
    Matrix23d d_ray;
    PixelIntrinsicsJacobian d_parameters;
    if (!camera.project(point.ray, &pixel, &d_ray, &d_parameters)) continue;
    changes.emplace_back(2, n + kCoefficients);
    changes.back() << d_parameters.leftCols(n), basis.at(point.pixel);
    rotations.emplace_back(-d_ray * skew(point.ray));
    btb += rotations.back().transpose() * rotations.back();
    bta += rotations.back().transpose() * changes.back();
  }
  const Eigen::MatrixXd absorbed = btb.ldlt().solve(bta);
  for (std::size_t i = 0; i < changes.size(); ++i) changes[i] -= rotations[i] * absorbed;
  return changes;
}

template <typename Square>
PixelError errorOver(const std::vector<PixelChange>& changes, const Square& square) {
  if (changes.empty()) return PixelError::unknown();
  PixelError error;
  double sum = 0.0;
  for (const PixelChange& change : changes) {
    const double squared = std::max(0.0, square(change));
    sum += squared;
    error.max = std::max(error.max, std::sqrt(squared));
  }
  error.rms = std::sqrt(sum / static_cast<double>(changes.size()));
  return error;
}

}  // namespace

PixelError FreeDisplacement::distance(const ImageField& field) const {
  return errorOver(compensatedChanges(camera, field),
                   [this](const PixelChange& by) { return (by * change).squaredNorm(); });
}

PixelError FreeDisplacement::uncertainty(const ImageField& field) const {
  return errorOver(compensatedChanges(camera, field), [this](const PixelChange& by) {
    return (by * covariance).cwiseProduct(by).sum();
  });
}

FreeDisplacement freeDisplacement(const LensObservations& observations, const LensTrial& trial,
                                  int threads) {
  std::vector<Segment> segments = trial.segments;
  Camera camera = trial.camera;
  const DisplacementMarginal marginal = displacementMarginal(
      problemOf(observations, &segments, &camera), SolverOptions().huber, threads);
  FreeDisplacement free;
  free.camera = camera;
  const std::optional<Following> following = followingOf(marginal, camera.estimatedCount());
  if (!trial.usable || !following) return free;
  const Coefficients coefficients = coefficientsOf(marginal, *following);
  const SoughtSquare square = soughtSquare(coefficients);
  const Scatter scatter = disagreementOf(observations, marginal);
  // On the safe side: a displacement that is there adds to both, and to the segments' sigmas.
  const double scale = std::max(marginal.residualVariance(), square.design_effect);
  ScatterVariance variance = scatter.variance();
  variance.factor *= scale;
  free.p_value =
      variance.exceedance(square.value / square.expected * square.freedom, square.freedom);

  const double noise = scatter.birgeRatio() * scatter.birgeRatio() * scale;
  setEstimate(coefficients, *following, noise, &free);
  return free;
}

}  // namespace camera_self_calibration
