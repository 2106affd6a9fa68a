#include "camera_self_calibration/estimation/inverse_depth_noise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "camera_self_calibration/base/decompositions.h"
#include "camera_self_calibration/estimation/pseudo_inverse.h"
#include "camera_self_calibration/estimation/robust.h"

namespace camera_self_calibration {
namespace {

// Least share of H that A keeps in any direction. There the estimate is no longer normal, and what
// a scene of typical depths allows is far better than 0; 0.1 fits simulated segments from a scale
// of motion where parallax is plain to none at all (see doc/degenerate.md).
constexpr double kLeastShare = 0.1;
// Largest share of noise that changes nothing worth the work: 0.1 % of a sigma.
constexpr double kNegligible = 1e-3;

// Information about one inverse depth, its bearing eliminated.
double inverseDepthInformation(const Landmark& landmark, const Eigen::Matrix3d& h) {
  if (landmark.anchored) return h(0, 0);
  const double determinant = h(1, 1) * h(2, 2) - h(2, 1) * h(2, 1);
  const double bearing =
      h(2, 2) * h(1, 0) * h(1, 0) - 2.0 * h(2, 1) * h(1, 0) * h(2, 0) + h(1, 1) * h(2, 0) * h(2, 0);
  const double rest = h(0, 0) - bearing / determinant;
  return std::isfinite(rest) ? std::max(0.0, rest) : 0.0;
}

// Of each pair of keyframes, [reference * keyframes + observing]: noise in what its observations
// tell of the translation between the two.
std::vector<Eigen::Matrix3d> noiseBetween(const Segment& segment, const LinearSegment& linear) {
  const std::size_t keyframes = segment.keyframes.size();
  std::vector<double> shares(segment.landmarks.size());
  for (std::size_t l = 0; l < shares.size(); ++l) {
    const Landmark& landmark = segment.landmarks[l];
    const double information = inverseDepthInformation(landmark, linear.landmarkInformation(l));
    shares[l] = 1.0 / (1.0 + landmark.inverse_depth * landmark.inverse_depth * information);
  }
  std::vector<Eigen::Matrix3d> noise(keyframes * keyframes, Eigen::Matrix3d::Zero());
  for (std::size_t o = 0; o < segment.observations.size(); ++o) {
    const Observation& observation = segment.observations[o];
    const int reference = segment.landmarks[observation.landmark].reference;
    const Matrix32d& view = linear.translationView(o);
    noise[reference * keyframes + observation.keyframe] +=
        shares[observation.landmark] * view.lazyProduct(view.transpose());
  }
  return noise;
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

// W f(M) W^T for columns W and M symmetric, with f(m) = (1 / l^2 - 1) / m, l = max(kLeastShare,
// 1 - m).
Eigen::MatrixXd grown(const Eigen::MatrixXd& w, const Eigen::MatrixXd& m) {
  const auto one = Eigen::MatrixXd::Identity(m.rows(), m.cols());
  if (Eigen::LLT<Eigen::MatrixXd>((1.0 - kLeastShare) * one - m).info() == Eigen::Success) {
    // No l at its bound: f(M) = (1 - M)^-1 (2 - M) (1 - M)^-1.
    const Eigen::MatrixXd x = Eigen::LLT<Eigen::MatrixXd>(one - m).solve(w.transpose());
    return x.transpose() * (2.0 * x - m * x);
  }
  const SymmetricEigen eigen = symmetricEigen(m);
  const auto growth = [](double share) {
    if (share < 1e-12) return 0.0;
    const double left = std::max(kLeastShare, 1.0 - share);
    return (1.0 / (left * left) - 1.0) / share;
  };
  const Eigen::MatrixXd along = w * eigen.vectors;
  return along * eigen.values.unaryExpr(growth).asDiagonal() * along.transpose();
}

// K, where the covariance grows from I^-1 by I^-1 K I^-1. Empty where that is negligible. `unit`
// scales the intrinsics' information to I, `factor` its factor.
Eigen::MatrixXd spuriousBy(const Eigen::MatrixXd& noise, const LinearSegment& linear,
                           const Intrinsics& unit, const Eigen::LLT<Eigen::MatrixXd>& factor) {
  const Eigen::MatrixXd root = rootOf(noise);  // B with B B^T = N
  // Of all that H says, N takes the shares M = B^T (H^-1)_pp B; S is H without the landmarks.
  Eigen::MatrixXd shares;  // B^T S_pp^-1 B at first
  Eigen::MatrixXd shows;   // S_cp S_pp^-1 B: a change B of the poses in the intrinsics' gradient
  linear.crossPoses(root, &shares, &shows);
  shows = (unit.asDiagonal() * shows).eval();
  shares += shows.transpose() * factor.solve(shows);
  if (!shares.allFinite() || shares.trace() < kNegligible) return {};
  // A^-1 H A^-1 = H^-1 + H^-1 B f(M) B^T H^-1.
  return grown(shows, shares);
}

}  // namespace

Eigen::MatrixXd inverseDepthNoise(const SegmentBlock& block, const LinearSegment& linear) {
  const int keyframes = static_cast<int>(block.segment->keyframes.size());
  const int fixed = block.fixed_keyframes;
  const int free = std::max(0, keyframes - fixed);
  const std::vector<Eigen::Matrix3d> between = noiseBetween(*block.segment, linear);
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(3 * free, 3 * free);
  for (int reference = 0; reference < keyframes; ++reference) {
    for (int observing = 0; observing < keyframes; ++observing) {
      if (reference == observing) continue;
      const Eigen::Matrix3d& own = between[reference * keyframes + observing];
      const int r = 3 * (reference - fixed);
      const int i = 3 * (observing - fixed);
      if (i >= 0) noise.block<3, 3>(i, i) += own;
      if (r >= 0) noise.block<3, 3>(r, r) += own;
      if (i < 0 || r < 0) continue;
      noise.block<3, 3>(i, r) -= own;
      noise.block<3, 3>(r, i) -= own;
    }
  }
  forgetScale(block, &noise);
  return noise;
}

ReducedInformation reducedInformation(const LinearSegment& linear) {
  return {linear.reducedHessian(), linear.trackScores(), linear.reducedGradient()};
}

ReducedInformation discountedInformation(const SegmentBlock& block, const LinearSegment& linear) {
  const ReducedInformation plain = reducedInformation(linear);
  const Intrinsics unit = plain.information.diagonal().unaryExpr(&inverseRoot);
  const Eigen::MatrixXd scaled = unit.asDiagonal() * plain.information * unit.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> factor(scaled);
  if (linear.poseColumns() == 0 || factor.info() != Eigen::Success) return plain;
  const Eigen::MatrixXd spurious =
      spuriousBy(inverseDepthNoise(block, linear), linear, unit, factor);
  if (spurious.size() == 0) return plain;
  // (I^-1 + I^-1 K I^-1)^-1 = I (I + K)^-1 I
  const Eigen::LLT<Eigen::MatrixXd> grown_factor(scaled + spurious);
  const Eigen::MatrixXd half = grown_factor.matrixL().solve(scaled);
  const Eigen::MatrixXd honest = half.transpose() * half;
  const Eigen::LLT<Eigen::MatrixXd> honest_factor(honest);
  if (!honest.allFinite() || honest_factor.info() != Eigen::Success) return plain;
  const auto back = unit.cwiseInverse().asDiagonal();
  ReducedInformation result;
  result.information = back * honest * back;
  result.gradient = back * (honest * factor.solve(unit.cwiseProduct(plain.gradient)));
  // With I = L L^T and I' = L' L'^T: T = L' L^-1 makes I' = T I T^T.
  const Eigen::MatrixXd inverse = factor.matrixL().solve(Eigen::MatrixXd(unit.asDiagonal()));
  const Eigen::MatrixXd turn = back * Eigen::MatrixXd(honest_factor.matrixL()) * inverse;
  result.track_scores = turn * plain.track_scores * turn.transpose();
  return result;
}

}  // namespace camera_self_calibration
