#include "camera_self_calibration/camera/estimate_distance.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "audit/audit_samples.h"

namespace camera_self_calibration {
namespace {

const Camera kTruth = camera640(CameraModel::kRadtan, {400, 402, 325, 236, -0.28, 0.07, 2e-4, 0});

TEST(ImageWeights, HoldsWhatWasCounted) {
  ImageWeights weights(640, 480);
  for (int i = 0; i < 19; ++i) weights.count({320, 240});
  weights.count({2, 3});
  EXPECT_EQ(weights.sum(), 20.0);
  EXPECT_EQ(weights.of(0, 0), 1.0);
  const Eigen::Vector2d centre(320, 240);
  const double radius = weights.radiusHolding(0.95, centre);
  EXPECT_LT(radius, 20.0);
  EXPECT_EQ(weights.within(radius, centre).sum(), 19.0);
  EXPECT_EQ(weights.beyond(radius, centre).sum(), 1.0);
  weights.count({-1e9, std::nan("")});
  EXPECT_EQ(weights.sum(), 20.0);
}

TEST(EstimateDistance, IsPixelDistanceWhereAllCounts) {
  const Camera other = changed(kTruth, 1.01, {3, -2});
  const CalibrationReport live = knownLens(kTruth, 0.1);
  ImageWeights all(640, 480);
  for (int row = 0; row < ImageField::kRows; ++row) {
    for (int column = 0; column < ImageField::kColumns; ++column) {
      all.count(ImageField::pixel(column, row, 640, 480));
    }
  }
  const EstimateDistance distance = distanceFromEstimate(kTruth, live.covariance, other, all);
  EXPECT_NEAR(distance.offset.found, pixelDistance(kTruth, other).rms, 1e-6);
  EXPECT_NEAR(distance.offset.noise, pixelUncertainty(kTruth, live.covariance).rms, 1e-9);
  EXPECT_EQ(distance.refused, 0.0);
}

TEST(EstimateDistance, IsInfiniteWhereNothingIsKnown) {
  EXPECT_FALSE(
      std::isfinite(distanceFromEstimate(kTruth, IntrinsicsMatrix(), kTruth, evenFeatures(kTruth))
                        .offset.length()));
}

struct Spread {
  double mean = 0.0;
  double deviation = 0.0;
  double stated = 0.0;
};

// Over estimates that scatter as their covariance says.
Spread spreadOf(const Camera& calibration, double uncertainty_px, bool axis) {
  const CalibrationReport live = knownLens(kTruth, uncertainty_px);
  const Eigen::MatrixXd root = Eigen::LLT<Eigen::MatrixXd>(live.covariance).matrixL();
  std::mt19937 generator(7);
  std::normal_distribution<double> normal;
  const ImageWeights weights = evenFeatures(kTruth);
  constexpr int kDraws = 200;
  Spread spread;
  double squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    Camera estimate = kTruth;
    const Eigen::VectorXd noise =
        Eigen::VectorXd::NullaryExpr(root.rows(), [&] { return normal(generator); });
    estimate.setParameters(kTruth.parameters() + root * noise);
    const EstimateDistance distance =
        distanceFromEstimate(estimate, live.covariance, calibration, weights);
    const double value = axis ? distance.axis_deg : distance.offset.length();
    spread.mean += value / kDraws;
    squares += value * value / kDraws;
    spread.stated += (axis ? distance.axis_sigma_deg : distance.offset.sigma()) / kDraws;
  }
  spread.deviation = std::sqrt(squares - spread.mean * spread.mean);
  return spread;
}

TEST(EstimateDistance, ScattersAsItSays) {
  const Camera far = changed(kTruth, 1.01, {15, 0});
  const double true_px =
      distanceFromEstimate(kTruth, knownLens(kTruth, 1e-6).covariance, far, evenFeatures(kTruth))
          .offset.length();
  const Spread spread = spreadOf(far, 0.4, false);
  EXPECT_NEAR(spread.mean, true_px, 0.1 * true_px);
  EXPECT_NEAR(spread.stated, spread.deviation, 0.2 * spread.deviation);
  const Spread axis = spreadOf(far, 0.4, true);
  EXPECT_NEAR(axis.stated, axis.deviation, 0.2 * axis.deviation);
  // Of the true calibration nothing is left but noise.
  const Spread none = spreadOf(kTruth, 0.4, false);
  EXPECT_LT(none.mean, 0.3);
  EXPECT_GT(2.0 * none.stated, none.deviation);
}

}  // namespace
}  // namespace camera_self_calibration
