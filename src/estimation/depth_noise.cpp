#include "camera_self_calibration/estimation/depth_noise.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "camera_self_calibration/estimation/pseudo_inverse.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/estimation/transfer.h"

namespace camera_self_calibration {
namespace {

// Least share of H that A keeps in any direction. There the estimate is no longer normal, and what
// a scene of typical depths allows is far better than 0; 0.1 fits simulated segments from a scale
// of motion where parallax is plain to none at all (see doc/degenerate.md).
constexpr double kLeastShare = 0.1;
// Largest share of noise that changes nothing worth the work: 0.1 % of a sigma.
constexpr double kNegligible = 1e-3;

// What one observation tells of translation and of inverse depth.
struct DepthView {
  Matrix23d d_translation;  // of the camera relative to the reference, in the world; with rho
  Eigen::Vector3d square;   // J_rho^T J_rho and J_rho^T J_bearing
  Eigen::Matrix2d bearing;  // J_bearing^T J_bearing
};

bool viewDepth(const SegmentBlock& block, const Observation& observation, const Camera& camera,
               double huber, Transfers* transfers, DepthView* view) {
  const Segment& segment = *block.segment;
  const Landmark& landmark = segment.landmarks[observation.landmark];
  const Transfer& transfer = transfers->between(landmark.reference, observation.keyframe);
  Eigen::Vector3d ray;
  Eigen::Vector2d pixel;
  Matrix23d d_point;
  if (!landmarkRay(segment.cameraOf(landmark.reference, camera), landmark, &ray, nullptr) ||
      !segment.cameraOf(observation.keyframe, camera)
           .project(transfer(ray, landmark.inverse_depth), &pixel, &d_point)) {
    return false;
  }
  const double sigma = observation.sigma * block.sigma_scale;
  const HuberLoss loss(((observation.pixel - pixel) / sigma).squaredNorm(), huber);
  d_point *= loss.root_weight / sigma;
  const Eigen::Vector2d d_depth = d_point * transfer.translation;
  const Eigen::Matrix<double, 2, 2> d_bearing =
      d_point * transfer.rotation * tangentBasis(landmark.bearing);
  view->square << d_depth.squaredNorm(), d_bearing.transpose() * d_depth;
  view->bearing = d_bearing.transpose() * d_bearing;
  view->d_translation = landmark.inverse_depth * d_point *
                        transfers->poses()[observation.keyframe].rotation.transpose();
  return true;
}

// Information about one inverse depth, its bearing eliminated.
double depthInformation(const Landmark& landmark, const Eigen::Vector3d& square,
                        const Eigen::Matrix2d& bearing) {
  if (landmark.anchored) return square(0);
  const Eigen::Vector2d coupling = square.tail<2>();
  const double rest = square(0) - coupling.dot(bearing.ldlt().solve(coupling));
  return std::isfinite(rest) ? std::max(0.0, rest) : 0.0;
}

// Takes out what is told of the scale, which is the gauge's: N - N v v^T N / (v^T N v), v the
// change of all positions that changes nothing but the scale.
void forgetScale(const SegmentBlock& block, Eigen::MatrixXd* noise) {
  if (block.fixed_keyframes != 1) return;  // others hold the scale
  const std::vector<Keyframe>& keyframes = block.segment->keyframes;
  Eigen::VectorXd scaling(noise->rows());
  for (Eigen::Index k = 0; 3 * k < scaling.size(); ++k) {
    scaling.segment<3>(3 * k) =
        keyframes[k + 1].world_from_camera.translation - keyframes[0].world_from_camera.translation;
  }
  const Eigen::VectorXd told = *noise * scaling;
  const double square = scaling.dot(told);
  if (square > 0.0) *noise -= told * told.transpose() / square;
}

// Columns B with B B^T = N, in all of a pose's six rows.
Eigen::MatrixXd rootOf(const Eigen::MatrixXd& noise) {
  const Eigen::LDLT<Eigen::MatrixXd> factor(noise);
  Eigen::MatrixXd root = factor.matrixL();
  root = factor.transpositionsP().transpose() * root;
  root *= factor.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(2 * noise.rows(), noise.cols());
  for (Eigen::Index k = 0; 3 * k < noise.rows(); ++k) {
    result.middleRows<3>(6 * k) = root.middleRows<3>(3 * k);
  }
  return result;
}

// For each direction of the translations that noise tells of: how it shows in the gradient of the
// intrinsics, and by how much its share of the covariance grows. Empty where that is negligible.
struct Feigned {
  Eigen::MatrixXd shows;
  Eigen::VectorXd growth;
};

// `unit` scales the intrinsics' information to that of `factor`.
Feigned feignedBy(const Eigen::MatrixXd& noise, const LinearSegment& linear, const Intrinsics& unit,
                  const Eigen::LLT<Eigen::MatrixXd>& factor) {
  const Eigen::MatrixXd root = rootOf(noise);
  Eigen::MatrixXd shares;  // of noise, B^T S^-1 B: S is H without the landmarks
  Eigen::MatrixXd shows;
  linear.crossPoses(root, &shares, &shows);
  shows = (unit.asDiagonal() * shows).eval();
  shares += shows.transpose() * factor.solve(shows);
  if (!shares.allFinite() || shares.trace() < kNegligible) return {};
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(shares);
  // The covariance is sum w w^T / left^2 over the directions w = S^-1 B u / sqrt(share).
  const auto growth = [](double share) {
    if (share < 1e-12) return 0.0;
    const double left = std::max(kLeastShare, 1.0 - share);
    return (1.0 / (left * left) - 1.0) / share;
  };
  return {shows * eigen.eigenvectors(), eigen.eigenvalues().unaryExpr(growth)};
}

// The information I where the covariance grows from I^-1 by I^-1 G D G^T I^-1.
IntrinsicsMatrix lessened(const IntrinsicsMatrix& information,
                          const Eigen::LLT<Eigen::MatrixXd>& factor, const Feigned& feigned) {
  const Eigen::MatrixXd g = feigned.shows * feigned.growth.cwiseSqrt().asDiagonal();
  Eigen::MatrixXd inner = g.transpose() * factor.solve(g);
  inner.diagonal().array() += 1.0;
  return information - g * inner.ldlt().solve(g.transpose());
}

}  // namespace

Eigen::MatrixXd depthNoise(const SegmentBlock& block, const Camera& camera, double huber) {
  const Segment& segment = *block.segment;
  std::vector<DepthView> views(segment.observations.size());
  std::vector<char> seen(views.size());
  std::vector<Eigen::Vector3d> squares(segment.landmarks.size(), Eigen::Vector3d::Zero());
  std::vector<Eigen::Matrix2d> bearings(squares.size(), Eigen::Matrix2d::Zero());
  Transfers transfers(segment);
  for (std::size_t o = 0; o < views.size(); ++o) {
    const Observation& observation = segment.observations[o];
    seen[o] = viewDepth(block, observation, camera, huber, &transfers, &views[o]);
    if (seen[o] == 0) continue;
    squares[observation.landmark] += views[o].square;
    bearings[observation.landmark] += views[o].bearing;
  }
  const int fixed = block.fixed_keyframes;
  const int free = std::max<int>(0, static_cast<int>(segment.keyframes.size()) - fixed);
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(3 * free, 3 * free);
  for (std::size_t o = 0; o < views.size(); ++o) {
    const int l = segment.observations[o].landmark;
    const Landmark& landmark = segment.landmarks[l];
    const int i = 3 * (segment.observations[o].keyframe - fixed);
    const int r = 3 * (landmark.reference - fixed);
    if (seen[o] == 0 || i == r) continue;
    const double depth = depthInformation(landmark, squares[l], bearings[l]);
    const double share = 1.0 / (1.0 + landmark.inverse_depth * landmark.inverse_depth * depth);
    const Eigen::Matrix3d own = share * views[o].d_translation.transpose() * views[o].d_translation;
    if (i >= 0) noise.block<3, 3>(i, i) += own;
    if (r >= 0) noise.block<3, 3>(r, r) += own;
    if (i < 0 || r < 0) continue;
    noise.block<3, 3>(i, r) -= own;
    noise.block<3, 3>(r, i) -= own;
  }
  forgetScale(block, &noise);
  return noise;
}

ReducedInformation reducedInformation(const LinearSegment& linear) {
  return {linear.reducedHessian(), linear.hasScores() ? linear.trackScores() : IntrinsicsMatrix(),
          linear.reducedGradient()};
}

ReducedInformation discountedInformation(const SegmentBlock& block, const Camera& camera,
                                         double huber, const LinearSegment& linear) {
  const ReducedInformation plain = reducedInformation(linear);
  const Intrinsics unit = plain.information.diagonal().unaryExpr(&inverseRoot);
  const IntrinsicsMatrix scaled = unit.asDiagonal() * plain.information * unit.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> factor(scaled);
  if (linear.poseColumns() == 0 || factor.info() != Eigen::Success) return plain;
  const Feigned feigned = feignedBy(depthNoise(block, camera, huber), linear, unit, factor);
  if (feigned.growth.size() == 0) return plain;
  const IntrinsicsMatrix honest = lessened(scaled, factor, feigned);
  const Eigen::LLT<Eigen::MatrixXd> honest_factor(honest);
  if (!honest.allFinite() || honest_factor.info() != Eigen::Success) return plain;
  const auto back = unit.cwiseInverse().asDiagonal();
  ReducedInformation result;
  result.information = back * honest * back;
  result.gradient = back * (honest * factor.solve(unit.cwiseProduct(plain.gradient)));
  if (plain.track_scores.size() == 0) return result;
  // With I = L L^T and I' = L' L'^T: T = L' L^-1 makes I' = T I T^T.
  const Eigen::MatrixXd inverse = factor.matrixL().solve(Eigen::MatrixXd(unit.asDiagonal()));
  const Eigen::MatrixXd turn = back * Eigen::MatrixXd(honest_factor.matrixL()) * inverse;
  result.track_scores = turn * plain.track_scores * turn.transpose();
  return result;
}

}  // namespace camera_self_calibration
