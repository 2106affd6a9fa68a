#include "camera_self_calibration/estimation/depth_noise.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
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

  Marginal marginal(DepthNoise noise) {
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

TEST(DepthNoiseTest, NothingChangesWhereDepthsAreKnown) {
  for (const Camera& truth : ordinaryCameras()) {
    Solved solved(truth, 0.003);
    const Eigen::VectorXd kept =
        sharesKept(solved.marginal(DepthNoise::kDiscounted), solved.marginal(DepthNoise::kCounts));
    EXPECT_GT(kept.minCoeff(), 0.995) << toString(truth.model());
    EXPECT_LT(kept.maxCoeff(), 1.0 + 1e-6) << toString(truth.model());
  }
}

TEST(DepthNoiseTest, LessButNeverMoreWhereTheyAreNoise) {
  for (const Camera& truth : ordinaryCameras()) {
    for (const auto origin : {LandmarkOrigin::kAnchored, LandmarkOrigin::kInherited}) {
      Solved solved(truth, 3.0, origin);
      const Marginal plain = solved.marginal(DepthNoise::kCounts);
      const Marginal honest = solved.marginal(DepthNoise::kDiscounted);
      const Eigen::VectorXd kept = sharesKept(honest, plain);
      EXPECT_GT(kept.minCoeff(), 0.01) << toString(truth.model());
      EXPECT_LT(kept.minCoeff(), 0.95) << toString(truth.model());
      EXPECT_LT(kept.maxCoeff(), 1.0 + 1e-6) << toString(truth.model());
      EXPECT_NEAR(honest.designEffect(), plain.designEffect(), 1e-6);
    }
  }
}

TEST(DepthNoiseTest, KeepsTheGaussNewtonStep) {
  Solved solved(ordinaryCameras()[1], 1.0);
  Intrinsics parameters = solved.camera.parameters();
  parameters(2) += 2.0;
  solved.camera.setParameters(parameters);
  const Marginal plain = solved.marginal(DepthNoise::kCounts);
  const Marginal honest = solved.marginal(DepthNoise::kDiscounted);
  const Intrinsics step = *covarianceFromInformation(plain.information) * plain.gradient;
  const Intrinsics same = *covarianceFromInformation(honest.information) * honest.gradient;
  EXPECT_LT((step - same).norm(), 1e-6 * step.norm());
}

TEST(DepthNoiseTest, DoesNotDependOnTheGauge) {
  for (const Camera& truth : ordinaryCameras()) {
    Solved solved(truth, 0.5);
    SegmentBlock block = freeBlock(&solved.segment, solved.camera);
    const auto information = [&] {
      return marginalize({&solved.camera, true, {block}}, kHuber, 1, DepthNoise::kDiscounted)
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
