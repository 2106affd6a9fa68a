#include "camera_self_calibration/camera/pixel_distance.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <random>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/camera/pixel_difference.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

IntrinsicsMatrix exampleCovariance(const Camera& camera) {
  const int n = camera.estimatedCount();
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  IntrinsicsMatrix root(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) root(i, j) = (i < 4 ? 0.2 : 1e-4) * normal(random);
  }
  return root * root.transpose();
}

TEST(PixelUncertainty, AgreesWithDisturbedCameras) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const Camera& camera :
       {sampleCameras()[3], sampleCameras()[10], sampleCameras()[15], sampleCameras()[0]}) {
    const IntrinsicsMatrix covariance = exampleCovariance(camera);
    const IntrinsicsMatrix root = covariance.llt().matrixL();
    const int n = camera.estimatedCount();
    double sum = 0.0;
    constexpr int kSamples = 150;
    for (int i = 0; i < kSamples; ++i) {
      Intrinsics noise(n);
      for (int j = 0; j < n; ++j) noise[j] = normal(random);
      Camera disturbed = camera;
      disturbed.setParameters(camera.parameters() + root * noise);
      sum += std::pow(pixelDistance(camera, disturbed).rms, 2);
    }
    const double sampled = std::sqrt(sum / kSamples);
    const PixelError predicted = pixelUncertainty(camera, covariance);
    EXPECT_NEAR(predicted.rms / sampled, 1.0, 0.1) << describe(camera);
    EXPECT_GT(predicted.max, predicted.rms);
  }
}

TEST(PixelUncertainty, ScalesWithSigmaAndVanishesWithIt) {
  const Camera camera = sampleCameras()[3];
  const IntrinsicsMatrix covariance = exampleCovariance(camera);
  const PixelError once = pixelUncertainty(camera, covariance);
  const PixelError twice = pixelUncertainty(camera, 4.0 * covariance);
  EXPECT_NEAR(twice.rms, 2.0 * once.rms, 1e-12 * once.rms);
  EXPECT_NEAR(twice.max, 2.0 * once.max, 1e-12 * once.max);
  EXPECT_EQ(pixelUncertainty(camera, IntrinsicsMatrix::Zero(5, 5)).max, 0.0);
}

// A narrow pinhole camera's principal point is nearly a rotation of the camera.
TEST(PixelUncertainty, DoesNotCountWhatARotationAbsorbs) {
  const Camera narrow = camera640(CameraModel::kPinhole, {6000, 6000, 319.5, 239.5});
  IntrinsicsMatrix covariance = IntrinsicsMatrix::Zero(4, 4);
  covariance(2, 2) = 1.0;
  EXPECT_LT(pixelUncertainty(narrow, covariance).rms, 0.01);
  covariance.setZero();
  covariance(0, 0) = 1.0;  // fx is no rotation: x / f for 1 px of focal length
  EXPECT_NEAR(pixelUncertainty(narrow, covariance).rms, 640.0 / std::sqrt(12.0) / 6000.0, 0.003);
}

TEST(PixelUncertainty, IsThePixelMetricsTrace) {
  for (const Camera& camera : {sampleCameras()[3], sampleCameras()[10], sampleCameras()[15]}) {
    const IntrinsicsMatrix covariance = exampleCovariance(camera);
    const double rms = pixelUncertainty(camera, covariance).rms;
    EXPECT_NEAR(std::sqrt((pixelMetric(camera) * covariance).trace()), rms, 1e-9 * rms);
  }
}

TEST(PixelUncertainty, LeavesOutWhatIsDark) {
  // The corners are where a distortion that is not known does most harm.
  const Camera camera = sampleCameras()[15];
  const IntrinsicsMatrix covariance = exampleCovariance(camera);
  const double radius = 0.5 * camera.height();
  ImageField field;
  for (int row = 0; row < ImageField::kRows; ++row) {
    for (int column = 0; column < ImageField::kColumns; ++column) {
      const Eigen::Vector2d pixel = ImageField::pixel(column, row, camera.width(), camera.height());
      const Eigen::Vector2d centre(0.5 * camera.width(), 0.5 * camera.height());
      if ((pixel - centre).norm() > radius) field.setDark(column, row);
    }
  }
  const PixelError whole = pixelUncertainty(camera, covariance);
  const PixelError seen = pixelUncertainty(camera, covariance, field);
  EXPECT_LT(seen.max, whole.max);
  EXPECT_LT(seen.rms, whole.rms);
  EXPECT_GT(seen.rms, 0.0);
  Camera other = camera;
  other.setParameters(camera.parameters() * 1.01);
  EXPECT_LT(pixelDistance(camera, other, field).rms, pixelDistance(camera, other).rms);
}

TEST(PixelUncertainty, InfiniteWithoutAFiniteCovariance) {
  const Camera camera = sampleCameras()[3];
  IntrinsicsMatrix covariance = exampleCovariance(camera);
  covariance(1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isinf(pixelUncertainty(camera, covariance).rms));
  covariance(1, 1) = std::nan("");
  EXPECT_TRUE(std::isinf(pixelUncertainty(camera, covariance).max));
  EXPECT_TRUE(std::isinf(pixelUncertainty(camera, IntrinsicsMatrix::Identity(4, 4)).rms));
  EXPECT_TRUE(std::isinf(pixelUncertainty(Camera(), IntrinsicsMatrix::Identity(4, 4)).rms));
  const PixelError none = pixelUncertainty(camera, IntrinsicsMatrix());
  EXPECT_EQ(none.rms, PixelError::unknown().rms);
  EXPECT_EQ(none.max, PixelError::unknown().max);
}

TEST(PixelUncertainty, HeldK3IsNoPartOfIt) {
  Camera camera = sampleCameras()[11];
  ASSERT_EQ(camera.parameterCount(), 9);
  EXPECT_TRUE(std::isfinite(pixelUncertainty(camera, exampleCovariance(camera)).rms));
  camera.setEstimateK3(true);
  EXPECT_TRUE(std::isinf(pixelUncertainty(camera, IntrinsicsMatrix::Identity(8, 8)).rms));
  EXPECT_TRUE(std::isfinite(pixelUncertainty(camera, exampleCovariance(camera)).rms));
}

TEST(PixelDistance, ZeroToItself) {
  for (const Camera& camera : sampleCameras()) {
    EXPECT_LT(pixelDistance(camera, camera).max, 1e-9) << describe(camera);
  }
}

// A shift of the principal point by 11 px is nearly a rotation of a narrow camera.
TEST(PixelDistance, RemovesTheRotation) {
  const Camera a = camera640(CameraModel::kPinhole, {2000, 2000, 319.5, 239.5});
  const Camera b = camera640(CameraModel::kPinhole, {2000, 2000, 329.5, 234.5});
  const PixelError error = pixelDistance(a, b);
  EXPECT_LT(error.max, 0.5);
  EXPECT_GT(error.max, 0.01);
}

// The minimum over rotations found by hand: no small rotation about it does better.
TEST(PixelDistance, IsTheMinimumOverRotations) {
  const Camera a = sampleCameras()[3];
  const Camera b = camera640(CameraModel::kFov, {286, 273, 306, 247, 0.95});
  const auto rmsAt = [&](const Eigen::Vector3d& omega) {
    double sum = 0.0;
    int count = 0;
    for (int row = 0; row < 30; ++row) {
      for (int column = 0; column < 40; ++column) {
        const Eigen::Vector2d pixel(column * 639.0 / 39.0, row * 479.0 / 29.0);
        const auto ray = a.unproject(pixel);
        Eigen::Vector2d other;
        if (!ray || !b.project(expSo3(omega) * *ray, &other)) continue;
        sum += (other - pixel).squaredNorm();
        ++count;
      }
    }
    return std::sqrt(sum / count);
  };
  // Coordinate descent with shrinking steps.
  Eigen::Vector3d omega = Eigen::Vector3d::Zero();
  for (double step = 0.02; step > 1e-7; step *= 0.5) {
    for (bool moved = true; moved;) {
      moved = false;
      for (int i = 0; i < 6; ++i) {
        const Eigen::Vector3d next = omega + (i < 3 ? step : -step) * Eigen::Vector3d::Unit(i % 3);
        if (rmsAt(next) < rmsAt(omega)) {
          omega = next;
          moved = true;
        }
      }
    }
  }
  EXPECT_NEAR(pixelDistance(a, b).rms, rmsAt(omega), 1e-4);
  EXPECT_LT(pixelDistance(a, b).rms, 0.9 * rmsAt(Eigen::Vector3d::Zero()));
}

TEST(PixelDistance, ComparesModels) {
  const Camera pinhole = camera640(CameraModel::kPinhole, {320, 330, 300, 250});
  EXPECT_LT(
      pixelDistance(pinhole, camera640(CameraModel::kRadtan, {320, 330, 300, 250, 0, 0, 0, 0})).max,
      1e-9);
  EXPECT_LT(pixelDistance(pinhole, camera640(CameraModel::kFov, {320, 330, 300, 250, 1e-6})).max,
            1e-6);
  EXPECT_GT(pixelDistance(pinhole, camera640(CameraModel::kFov, {320, 330, 300, 250, 1.0})).rms,
            5.0);
}

TEST(PixelDifference, AddsUpToTheDistance) {
  const Camera a = camera640(CameraModel::kRadtan, {420, 420, 320, 240, -0.2, 0.05, 0, 0});
  const Camera b = camera640(CameraModel::kRadtan, {421, 420, 325, 240, -0.21, 0.05, 0, 0});
  const PixelDifference difference = pixelDifference(a, b);
  double sum = 0.0;
  double largest = 0.0;
  for (const auto& sample : difference.samples) sum += sample.offset.squaredNorm();
  for (const auto& point : difference.points) largest = std::max(largest, point.offset.norm());
  EXPECT_EQ(difference.points.size(), 1200u);
  EXPECT_EQ(difference.refused, 0);
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(difference.samples.size())), difference.error.rms,
              1e-9);
  EXPECT_NEAR(largest, difference.error.max, 1e-9) << "in a corner";
  // Five pixels of the principal point are mostly a rotation by 5 / 420.
  EXPECT_NEAR(difference.rotation_deg, 5.0 / 420.0 / kDegree, 0.1);
}

TEST(PixelDifference, CountsWhatTheOtherCannotSee) {
  const Camera wide = camera640(CameraModel::kFov, {300, 300, 320, 240, 1.0});
  const Camera folded = camera640(CameraModel::kRadtan, {300, 300, 320, 240, -0.5, 0, 0, 0});
  const PixelDifference difference = pixelDifference(wide, folded);
  EXPECT_GT(difference.refused, 100);
  EXPECT_EQ(difference.refused + difference.points.size(), 1200u);
}

TEST(PixelDistance, RadiusLimitsTheGrid) {
  const Camera a = sampleCameras()[10];
  Camera b = a;
  Intrinsics parameters = a.parameters();
  parameters[5] += 0.05;  // k2 tells at the edge only
  b.setParameters(parameters);
  EXPECT_LT(pixelDistance(a, b, 150.0).max, 0.1 * pixelDistance(a, b).max);
  EXPECT_TRUE(std::isinf(pixelDistance(a, b, -1.0).rms));
  EXPECT_TRUE(std::isinf(pixelDistance(Camera(), b).rms));
}

TEST(PixelDifference, IsTheMeanOverAllPixels) {
  const Camera a = camera640(CameraModel::kPinhole, {300, 300, 319.5, 239.5});
  const Camera b = camera640(CameraModel::kPinhole, {303, 303, 319.5, 239.5});
  // The offset is 1 % of the distance from the centre, which no rotation changes by much.
  double sum = 0.0;
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x)
      sum += 1e-4 * (Eigen::Vector2d(x, y) - Eigen::Vector2d(319.5, 239.5)).squaredNorm();
  }
  const double over_all_pixels = std::sqrt(sum / (640 * 480));
  const PixelDifference difference = pixelDifference(a, b);
  EXPECT_NEAR(difference.error.rms, over_all_pixels, 1e-3 * over_all_pixels);
  EXPECT_NEAR(difference.error.max, 0.01 * std::hypot(319.5, 239.5), 1e-6) << "in the corner";
  EXPECT_GT(pixelDistance(a, b).rms, 1.02 * over_all_pixels) << "else this tests nothing";
}

}  // namespace
}  // namespace camera_self_calibration
