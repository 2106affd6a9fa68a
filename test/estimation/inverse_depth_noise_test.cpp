#include "camera_self_calibration/estimation/inverse_depth_noise.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/estimation/solver.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

constexpr double kHuber = 2.0;

// A solved segment; with `pixel_sigma` of a pixel its depths are more or less noise.
struct Solved {
  Segment segment;
  Camera camera;

  Solved(const Camera& truth, double pixel_sigma, LandmarkOrigin origin = LandmarkOrigin::kMixed)
      : segment(smallSegment(truth, origin, pixel_sigma, 5, 8, 40).segment), camera(truth) {
    SolverOptions options;
    options.huber = kHuber;
    options.max_iterations = 100;
    solve({&camera, true, {freeBlock(&segment, camera)}}, options);
  }

  Marginal marginal(InverseDepthNoise noise) {
    return marginalize({&camera, true, {freeBlock(&segment, camera)}}, kHuber, 1, noise);
  }
};

// Eigenvalues of I' in the metric of I: 1 where nothing changes.
Eigen::VectorXd sharesKept(const Marginal& honest, const Marginal& plain) {
  const Eigen::MatrixXd a = honest.information;
  const Eigen::MatrixXd b = plain.information;
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(a, b, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

// Of the landmarks' inverse depths and, unless they are anchored, bearings.
std::vector<Eigen::Matrix3d> landmarkInformation(const Segment& segment,
                                                 const std::vector<PredictionJacobians>& views) {
  std::vector<Eigen::Matrix3d> information(segment.landmarks.size(), Eigen::Matrix3d::Zero());
  for (std::size_t o = 0; o < views.size(); ++o) {
    const Observation& observation = segment.observations[o];
    const Landmark& landmark = segment.landmarks[observation.landmark];
    Eigen::Matrix<double, 2, 3> own;
    own << views[o].inverse_depth, views[o].ray * tangentBasis(landmark.bearing);
    information[observation.landmark] += own.transpose() * own / std::pow(observation.sigma, 2);
  }
  return information;
}

// As inverse_depth_noise.h says it, from every observation's derivatives; other keyframes hold the
// scale.
Eigen::MatrixXd expectedNoise(const Segment& segment, const Camera& camera, int fixed) {
  std::vector<PredictionJacobians> views(segment.observations.size());
  for (std::size_t o = 0; o < views.size(); ++o) {
    const Observation& observation = segment.observations[o];
    const Landmark& landmark = segment.landmarks[observation.landmark];
    Eigen::Vector3d ray;
    Eigen::Vector2d pixel;
    EXPECT_TRUE(landmarkRay(camera, landmark, &ray, nullptr));
    EXPECT_TRUE(
        predictPixel(camera, PoseMatrices(segment.keyframes[landmark.reference].world_from_camera),
                     PoseMatrices(segment.keyframes[observation.keyframe].world_from_camera), ray,
                     landmark.inverse_depth, false, &pixel, &views[o]));
  }
  const std::vector<Eigen::Matrix3d> information = landmarkInformation(segment, views);
  const auto count = static_cast<Eigen::Index>(segment.keyframes.size());
  Eigen::MatrixXd noise = Eigen::MatrixXd::Zero(3 * count, 3 * count);
  for (std::size_t o = 0; o < views.size(); ++o) {
    const Observation& observation = segment.observations[o];
    const Landmark& landmark = segment.landmarks[observation.landmark];
    if (observation.keyframe == landmark.reference) continue;
    const Eigen::Matrix3d& told = information[observation.landmark];
    const double variance =
        landmark.anchored ? 1.0 / told(0, 0) : Eigen::Matrix3d(told.inverse())(0, 0);
    const double share = variance / (variance + std::pow(landmark.inverse_depth, 2));
    Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(2, 3 * count);
    moves.middleCols<3>(3 * observation.keyframe) = views[o].observing_pose.leftCols<3>();
    moves.middleCols<3>(3 * landmark.reference) = -views[o].observing_pose.leftCols<3>();
    noise += share * moves.transpose() * moves / std::pow(observation.sigma, 2);
  }
  return noise.bottomRightCorner(3 * (count - fixed), 3 * (count - fixed));
}

TEST(InverseDepthNoiseTest, IsTheUncertainDepthsShare) {
  for (const Camera& truth : ordinaryCameras()) {
    Solved solved(truth, 1.0);
    SegmentBlock block = freeBlock(&solved.segment, solved.camera);
    block.fixed_keyframes = 2;
    LinearSegment linear;
    linear.linearize(block, solved.camera, truth.estimatedCount(), 1e6, true);
    const Eigen::MatrixXd expected = expectedNoise(solved.segment, solved.camera, 2);
    EXPECT_LT((inverseDepthNoise(block, linear) - expected).norm(), 1e-6 * expected.norm())
        << toString(truth.model());
  }
}

TEST(InverseDepthNoiseTest, NothingChangesWhereDepthsAreKnown) {
  for (const Camera& truth : ordinaryCameras()) {
    Solved solved(truth, 0.003);
    const Eigen::VectorXd kept = sharesKept(solved.marginal(InverseDepthNoise::kDiscounted),
                                            solved.marginal(InverseDepthNoise::kCounts));
    EXPECT_GT(kept.minCoeff(), 0.995) << toString(truth.model());
    EXPECT_LT(kept.maxCoeff(), 1.0 + 1e-6) << toString(truth.model());
  }
}

TEST(InverseDepthNoiseTest, LessButNeverMoreWhereTheyAreNoise) {
  for (const Camera& truth : ordinaryCameras()) {
    for (const auto origin : {LandmarkOrigin::kAnchored, LandmarkOrigin::kInherited}) {
      Solved solved(truth, 3.0, origin);
      const Marginal plain = solved.marginal(InverseDepthNoise::kCounts);
      const Marginal honest = solved.marginal(InverseDepthNoise::kDiscounted);
      const Eigen::VectorXd kept = sharesKept(honest, plain);
      EXPECT_GT(kept.minCoeff(), 0.01) << toString(truth.model());
      EXPECT_LT(kept.minCoeff(), 0.95) << toString(truth.model());
      EXPECT_LT(kept.maxCoeff(), 1.0 + 1e-6) << toString(truth.model());
      EXPECT_NEAR(honest.designEffect(), plain.designEffect(), 1e-6);
    }
  }
}

TEST(InverseDepthNoiseTest, KeepsTheGaussNewtonStep) {
  Solved solved(ordinaryCameras()[1], 1.0);
  Intrinsics parameters = solved.camera.parameters();
  parameters(2) += 2.0;
  solved.camera.setParameters(parameters);
  const Marginal plain = solved.marginal(InverseDepthNoise::kCounts);
  const Marginal honest = solved.marginal(InverseDepthNoise::kDiscounted);
  const Intrinsics step = *covarianceFromInformation(plain.information) * plain.gradient;
  const Intrinsics same = *covarianceFromInformation(honest.information) * honest.gradient;
  EXPECT_LT((step - same).norm(), 1e-6 * step.norm());
}

TEST(InverseDepthNoiseTest, DoesNotDependOnTheGauge) {
  for (const Camera& truth : ordinaryCameras()) {
    Solved solved(truth, 0.5);
    SegmentBlock block = freeBlock(&solved.segment, solved.camera);
    const auto information = [&] {
      return marginalize({&solved.camera, true, {block}}, kHuber, 1, InverseDepthNoise::kDiscounted)
          .information;
    };
    const IntrinsicsMatrix expected = information();
    for (int l = 0; l < static_cast<int>(solved.segment.landmarks.size()); l += 7) {
      block.fixed_landmark = l;
      EXPECT_LT((information() - expected).norm(), 1e-4 * expected.norm())
          << toString(truth.model()) << ", landmark " << l;
    }
  }
}

}  // namespace
}  // namespace camera_self_calibration
