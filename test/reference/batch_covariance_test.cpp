#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <iostream>
#include <optional>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/reference/batch.h"
#include "camera_self_calibration/reference/shared_marginal.h"
#include "reference/batch_scene.h"

namespace camera_self_calibration {
namespace {

const Camera kFov = camera640(CameraModel::kFov, {320, 322, 316, 243, 0.95});

// Largest difference of the matrices, both scaled to unit diagonal of `b`.
double scaledDifference(const IntrinsicsMatrix& a, const IntrinsicsMatrix& b) {
  const Eigen::VectorXd scale = b.diagonal().cwiseSqrt().cwiseInverse();
  return (scale.asDiagonal() * (a - b) * scale.asDiagonal()).cwiseAbs().maxCoeff();
}

BatchSegment gaugeFixed(const BatchScene& scene, Segment* segment) {
  return {segment, 1, scene.scaleLandmark(), 1.0};
}

// d^T C^-1 d is chi-square with five degrees of freedom if the covariance is right.
TEST(BatchCovariance, IsThatOfTheEstimates) {
  const BatchScene scene(kFov, 7, 50, 5);
  constexpr int kTrials = 60;
  constexpr double kSigma = 0.2;
  Segment truth = scene.noisy(kSigma, 0);
  for (std::size_t i = 0; i < truth.observations.size(); ++i) {
    truth.observations[i].pixel = scene.truth().observations[i].pixel;
  }
  const auto covariance = batchCovariance({gaugeFixed(scene, &truth)}, kFov, {});
  ASSERT_TRUE(covariance);
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Segment segment = scene.noisy(kSigma, 100 + trial);
    Camera estimate = kFov;
    ASSERT_TRUE(solveBatch({gaugeFixed(scene, &segment)}, &estimate, {}).converged);
    const Eigen::VectorXd d = estimate.parameters() - kFov.parameters();
    sum += d.dot(covariance->llt().solve(d));
  }
  std::cout << "mean squared Mahalanobis distance " << sum / kTrials << " for 5\n";
  EXPECT_NEAR(sum / kTrials, 5.0, 3.0 * std::sqrt(10.0 / kTrials));
}

TEST(BatchCovariance, DoesNotDependOnTheGauge) {
  const BatchScene scene(kFov, 8, 50, 5);
  Segment segment = scene.truth();
  const auto reference = batchCovariance({{&segment, 1, 0, 1.0}}, kFov, {});
  ASSERT_TRUE(reference);
  for (const int landmark : {1, 5, 17, 32}) {
    const auto other = batchCovariance({{&segment, 1, landmark, 1.0}}, kFov, {});
    ASSERT_TRUE(other);
    EXPECT_LT(scaledDifference(*other, *reference), 1e-7) << landmark;
  }
}

TEST(BatchCovariance, InformationOfSegmentsAdds) {
  const BatchScene first(kFov, 6, 40, 1), second(kFov, 8, 50, 2);
  Segment a = first.truth(), b = second.truth();
  const auto c_a = batchCovariance({gaugeFixed(first, &a)}, kFov, {});
  const auto c_b = batchCovariance({gaugeFixed(second, &b)}, kFov, {});
  const auto joint = batchCovariance({gaugeFixed(first, &a), gaugeFixed(second, &b)}, kFov, {});
  ASSERT_TRUE(c_a && c_b && joint);
  const Eigen::MatrixXd sum = Eigen::MatrixXd(*c_a).inverse() + Eigen::MatrixXd(*c_b).inverse();
  EXPECT_LT(scaledDifference(IntrinsicsMatrix(sum.inverse()), *joint), 1e-7);
}

TEST(BatchCovariance, ScalesWithSigma) {
  const BatchScene scene(kFov, 8, 50, 5);
  Segment segment = scene.truth();
  BatchSegment scaled = gaugeFixed(scene, &segment);
  scaled.sigma_scale = 3.0;
  const auto once = batchCovariance({gaugeFixed(scene, &segment)}, kFov, {});
  const auto thrice = batchCovariance({scaled}, kFov, {});
  ASSERT_TRUE(once && thrice);
  EXPECT_LT(scaledDifference(*thrice, IntrinsicsMatrix(9.0 * *once)), 1e-8);
}

TEST(BatchCovariance, IsOfTheEstimatedParameters) {
  Camera camera(CameraModel::kRadtan, 640, 480,
                intrinsics({400, 405, 322, 238, -0.2, 0.05, 1e-3, -1e-3, -0.01}));
  const BatchScene scene(camera, 8, 60, 5);
  Segment segment = scene.truth();
  const auto without = batchCovariance({gaugeFixed(scene, &segment)}, camera, {});
  camera.setEstimateK3(true);
  const auto with = batchCovariance({gaugeFixed(scene, &segment)}, camera, {});
  ASSERT_TRUE(without && with);
  ASSERT_EQ(without->rows(), 8);
  ASSERT_EQ(with->rows(), 9);
  for (int i = 0; i < 8; ++i) EXPECT_GE((*with)(i, i), (1.0 - 1e-9) * (*without)(i, i));
  // Conditioning on k3 takes its information out again.
  const Eigen::MatrixXd information = Eigen::MatrixXd(*with).inverse();
  const Eigen::MatrixXd conditioned = information.topLeftCorner(8, 8).inverse();
  EXPECT_LT(scaledDifference(IntrinsicsMatrix(conditioned), *without), 1e-6);
}

TEST(BatchCovariance, WeightsOfTheHuberLoss) {
  const BatchScene scene(kFov, 8, 50, 5);
  Segment segment = scene.truth();
  for (Observation& seen : segment.observations) seen.sigma = 0.5;
  Segment weighted = segment;
  BatchOptions options;
  options.huber = 1.5;
  for (std::size_t i = 0; i < segment.observations.size(); i += 5) {
    const Eigen::Vector2d shift(3.0, -4.0);  // whitened norm 10
    segment.observations[i].pixel += shift;
    // The same weight, 1.5 / 10, by a larger sigma.
    weighted.observations[i].sigma = 0.5 / std::sqrt(1.5 / 10.0);
  }
  const auto expected = batchCovariance({gaugeFixed(scene, &weighted)}, kFov, {});
  const auto plain = batchCovariance({gaugeFixed(scene, &segment)}, kFov, {});
  const auto robust = batchCovariance({gaugeFixed(scene, &segment)}, kFov, options);
  ASSERT_TRUE(expected && plain && robust);
  EXPECT_LT(scaledDifference(*robust, *expected), 1e-6);
  EXPECT_GT((*robust)(0, 0), 1.05 * (*plain)(0, 0));
}

TEST(BatchCovariance, NothingWithoutAGauge) {
  const BatchScene scene(kFov, 8, 50, 5);
  Segment segment = scene.truth();
  EXPECT_FALSE(batchCovariance({{&segment, 0, -1, 1.0}}, kFov, {}));
  EXPECT_FALSE(batchCovariance({{&segment, 1, -1, 1.0}}, kFov, {}));
  EXPECT_TRUE(batchCovariance({{&segment, 1, 0, 1.0}}, kFov, {}));
}

// Residuals `x` and `slope * y`.
struct TwoLines : ceres::SizedCostFunction<2, 1, 1> {
  explicit TwoLines(double slope_of_y) : slope(slope_of_y) {}

  bool Evaluate(const double* const* variables, double* residuals,
                double** jacobians) const override {
    residuals[0] = variables[0][0];
    residuals[1] = slope * variables[1][0];
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) Eigen::Map<Eigen::Vector2d>(jacobians[0]) << 1.0, 0.0;
    if (jacobians[1] != nullptr) Eigen::Map<Eigen::Vector2d>(jacobians[1]) << 0.0, slope;
    return true;
  }

  double slope;
};

std::optional<SharedMarginal> marginalOfLine(double slope) {
  double x = 0.0, y = 0.0;
  ceres::Problem problem;
  problem.AddResidualBlock(new TwoLines(slope), nullptr, &x, &y);
  return sharedMarginal(&problem, {&x, &y}, 1, {0});
}

TEST(SharedMarginal, NothingOfWhatNoResidualDependsOn) {
  const auto marginal = marginalOfLine(0.5);
  ASSERT_TRUE(marginal);
  EXPECT_NEAR(marginal->covariance(0, 0), 4.0, 1e-9);
  EXPECT_FALSE(marginalOfLine(0.0));
}

}  // namespace
}  // namespace camera_self_calibration
