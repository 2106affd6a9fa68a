#include "camera_self_calibration/estimation/entropy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

IntrinsicsMatrix someCovariance(const Camera& camera, std::uint64_t seed) {
  Random random(seed);
  const int n = camera.estimatedCount();
  const Intrinsics sigmas = normalizationSigmas(camera);
  Eigen::MatrixXd root(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) root(i, j) = random.normal() + (i == j ? 3.0 : 0.0);
  }
  return sigmas.asDiagonal() * (root * root.transpose()) * sigmas.asDiagonal();
}

constexpr double kHalfLog2PiE = 1.4189385332046727;

TEST(Entropy, OfTheNormalizationItselfIsThatOfUnitGaussians) {
  for (const Camera& camera : ordinaryCameras()) {
    const Intrinsics sigmas = normalizationSigmas(camera);
    ASSERT_EQ(sigmas.size(), camera.estimatedCount());
    EXPECT_GT(sigmas.minCoeff(), 0.0);
    const IntrinsicsMatrix covariance = sigmas.cwiseAbs2().asDiagonal();
    EXPECT_NEAR(entropy(camera, covariance), kHalfLog2PiE * sigmas.size(), 1e-12);
  }
}

TEST(Entropy, GrowsByTheLogOfTheSigmas) {
  for (const Camera& camera : ordinaryCameras()) {
    const IntrinsicsMatrix covariance = someCovariance(camera, 3);
    const int n = camera.estimatedCount();
    EXPECT_NEAR(entropy(camera, 4.0 * covariance), entropy(camera, covariance) + n * std::log(2.0),
                1e-9);
    IntrinsicsMatrix one = covariance;
    one.row(1) *= 3.0;
    one.col(1) *= 3.0;
    EXPECT_NEAR(entropy(camera, one), entropy(camera, covariance) + std::log(3.0), 1e-9);
  }
}

// A lens read out at twice the size has pixels half as large: the same knowledge.
TEST(Entropy, DoesNotDependOnTheImageSize) {
  const Camera small(CameraModel::kFov, 320, 240, intrinsics({160, 160, 160, 120, 0.9}));
  const Camera large(CameraModel::kFov, 640, 480, intrinsics({320, 320, 320, 240, 0.9}));
  const IntrinsicsMatrix covariance = someCovariance(small, 4);
  IntrinsicsMatrix scaled = covariance;
  scaled.topRows(4) *= 2.0;
  scaled.leftCols(4) *= 2.0;
  EXPECT_NEAR(entropy(small, covariance), entropy(large, scaled), 1e-9);
}

TEST(Entropy, IsInfiniteWhereSingularOrNotFinite) {
  const Camera camera = ordinaryCameras()[1];
  IntrinsicsMatrix singular = someCovariance(camera, 5);
  singular.row(2).setZero();
  singular.col(2).setZero();
  EXPECT_EQ(entropy(camera, singular), INFINITY);
  EXPECT_EQ(entropy(camera, -someCovariance(camera, 5)), INFINITY);
  IntrinsicsMatrix bad = someCovariance(camera, 5);
  bad(0, 0) = NAN;
  EXPECT_EQ(entropy(camera, bad), INFINITY);
  EXPECT_EQ(entropy(camera, IntrinsicsMatrix()), INFINITY);  // nothing is known
}

TEST(Entropy, CountsAnEstimatedK3) {
  Camera camera = ordinaryCameras()[2];
  EXPECT_EQ(normalizationSigmas(camera).size(), 8);
  camera.setEstimateK3(true);
  ASSERT_EQ(normalizationSigmas(camera).size(), 9);
  EXPECT_TRUE(std::isfinite(entropy(camera, someCovariance(camera, 6))));
}

}  // namespace
}  // namespace camera_self_calibration
