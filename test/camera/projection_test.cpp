#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "camera/reference_projection.h"
#include "camera/sample_cameras.h"

namespace camera_self_calibration {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Compares value and derivatives with the oracle; `tolerance` is relative to the focal length.
void expectDerivatives(const Camera& camera, const Eigen::Vector3d& point,
                       double tolerance = 1e-9) {
  SCOPED_TRACE(describe(camera));
  SCOPED_TRACE(testing::Message() << "point " << point.transpose());
  Eigen::Vector2d pixel, pixel_only;
  Matrix23d d_point;
  PixelIntrinsicsJacobian d_parameters;
  ASSERT_TRUE(camera.project(point, &pixel, &d_point, &d_parameters));
  ASSERT_TRUE(camera.project(point, &pixel_only));
  ASSERT_EQ(d_parameters.cols(), camera.parameterCount());
  const ReferenceCamera reference(camera);
  const double f = camera.parameters()[0];
  EXPECT_EQ(pixel, pixel_only);
  EXPECT_LT((pixel - reference.project(point)).norm(), 1e-12 * f * (1.0 + pixel.norm() / f));
  // Differences need a step that is small against the distance to the axis and to the plane z = 0.
  const double smallest = std::max(point.head<2>().norm(), 1e-4 * point.norm());
  const double step = 1e-3 * std::min(smallest, std::abs(point.z()));
  const double scale = f * tolerance * (1.0 + d_point.cwiseAbs().maxCoeff() / f);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT((d_point.col(axis) - reference.slopeInPoint(point, axis, step)).norm(), scale)
        << "axis " << axis << ": " << d_point.col(axis).transpose() << " numeric "
        << reference.slopeInPoint(point, axis, step).transpose();
  }
  for (int i = 0; i < camera.parameterCount(); ++i) {
    const double value = camera.parameters()[i];
    // Polynomial in every parameter but w, in which the model is even and smooth through 0.
    const bool is_w = camera.model() == CameraModel::kFov && i == 4;
    const double w_step =
        3.1e-4 * std::min({1.0, M_PI - value, point.z() / (1e-9 + point.head<2>().norm())});
    const double change = is_w ? w_step : 1e-3 * (1.0 + value);
    const Eigen::Vector2d numeric = reference.slopeInParameter(point, i, change);
    EXPECT_LT((d_parameters.col(i) - numeric).norm(), tolerance * (f + numeric.norm()))
        << "parameter " << i << ": " << d_parameters.col(i).transpose() << " numeric "
        << numeric.transpose();
  }
}

TEST(Projection, DerivativesOverTheImage) {
  for (const Camera& camera : sampleCameras()) {
    int checked = 0;
    for (double y = 0.0; y < camera.height(); y += 31.0) {
      for (double x = 0.0; x < camera.width(); x += 29.0) {
        const auto ray = camera.unproject({x, y});
        if (!ray) continue;
        // Next to a fold the pixel is hardly smooth enough for differences.
        const auto outer =
            camera.unproject(camera.parameters().segment<2>(2) +
                             1.005 * (Eigen::Vector2d(x, y) - camera.parameters().segment<2>(2)));
        if (!outer) continue;
        expectDerivatives(camera, 2.7 * *ray, 1e-8);
        ++checked;
      }
    }
    EXPECT_GT(checked, 120) << describe(camera);
  }
}

TEST(Projection, DerivativesAtTheAxis) {
  for (const Camera& camera : sampleCameras()) {
    for (const double r : {0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-2}) {
      expectDerivatives(camera, {0.6 * r, -0.8 * r, 1.0});
      expectDerivatives(camera, {0.6 * r * 1e4, -0.8 * r * 1e4, 1e4});
    }
  }
}

// The series take over at (k r / z)^2 = 2.5e-3.
TEST(Projection, DerivativesAtBothSidesOfTheSeriesBranch) {
  for (const Camera& camera : sampleCameras()) {
    double k = 1.0;
    if (camera.model() == CameraModel::kFov) k = 2.0 * std::tan(0.5 * camera.parameters()[4]);
    for (const double side : {1.0 - 1e-9, 1.0, 1.0 + 1e-9, 0.98, 1.02}) {
      const double r = 0.05 / k * side;
      expectDerivatives(camera, {-0.8 * r, 0.6 * r, 1.0});
    }
  }
}

TEST(Projection, FovDerivativesForEveryW) {
  for (const double w :
       {1e-12, 1e-8, 1e-4, 1e-2, 0.1, 0.2999999, 0.3, 0.3000001, 0.5, 1.0, 2.0, 3.0, 3.14}) {
    const Camera camera = camera640(CameraModel::kFov, {300, 300, 319.5, 239.5, w});
    for (const double r : {0.0, 1e-8, 0.02, 0.3, 1.0, 5.0}) {
      expectDerivatives(camera, {0.6 * r, 0.8 * r, 1.0}, w > 3.0 ? 1e-7 : 1e-9);
    }
  }
}

TEST(Projection, FovIsPinholeAsWVanishes) {
  const Camera fov = camera640(CameraModel::kFov, {300, 310, 319.5, 239.5, 1e-9});
  const Camera pinhole = camera640(CameraModel::kPinhole, {300, 310, 319.5, 239.5});
  Eigen::Vector2d a, b;
  ASSERT_TRUE(fov.project({0.7, -0.4, 1.0}, &a));
  ASSERT_TRUE(pinhole.project({0.7, -0.4, 1.0}, &b));
  EXPECT_LT((a - b).norm(), 1e-10);
}

TEST(Projection, FovIsStableUpToTheImagePlane) {
  const double w = 1.1;
  const Camera camera = camera640(CameraModel::kFov, {300, 300, 319.5, 239.5, w});
  for (const double z : {1e-2, 1e-6, 1e-12, 1e-100, 1e-300}) {
    Eigen::Vector2d pixel;
    Matrix23d d_point;
    PixelIntrinsicsJacobian d_parameters;
    ASSERT_TRUE(camera.project({1.0, 0.0, z}, &pixel, &d_point, &d_parameters));
    const double k = 2.0 * std::tan(0.5 * w);
    EXPECT_NEAR(pixel.x(), 319.5 + 300.0 * std::atan2(k, z) / w, 1e-9);
    EXPECT_TRUE(d_point.allFinite());
    EXPECT_TRUE(d_parameters.allFinite());
    EXPECT_NEAR(d_point(0, 2), -300.0 * k / (w * (z * z + k * k)), 1e-9);
  }
  Eigen::Vector2d pixel;
  EXPECT_FALSE(camera.project({1.0, 0.0, 0.0}, &pixel));
}

TEST(Projection, EquidistantDerivativesBehindTheImagePlane) {
  const Camera camera =
      camera640(CameraModel::kEquidistant,
                {190.98, 190.97, 254.93, 256.9, 0.00348, 0.000715, -0.00205, 0.000202});
  for (const double degrees : {60.0, 80.0, 89.99, 90.01, 95.0, 110.0}) {
    const double t = degrees / 180.0 * M_PI;
    expectDerivatives(camera, {0.6 * std::sin(t), 0.8 * std::sin(t), std::cos(t)});
  }
}

TEST(Projection, DoesNotDependOnTheScaleOfThePoint) {
  const Eigen::Vector3d point(0.31, -0.22, 0.9);
  for (const Camera& camera : sampleCameras()) {
    Eigen::Vector2d near, far, pixel;
    ASSERT_TRUE(camera.project(point, &pixel));
    ASSERT_TRUE(camera.project(1e-9 * point, &near));
    ASSERT_TRUE(camera.project(1e9 * point, &far));
    EXPECT_LT((near - pixel).norm() + (far - pixel).norm(), 1e-10) << describe(camera);
  }
}

TEST(Projection, RefusesWhatIsNotInFront) {
  Eigen::Vector2d pixel;
  for (const Camera& camera : sampleCameras()) {
    for (const Eigen::Vector3d& point :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(kNan, 0, 1),
          Eigen::Vector3d(0, 0, kNan), Eigen::Vector3d(kInfinity, 0, 1),
          Eigen::Vector3d(kInfinity, 0, kInfinity)}) {
      EXPECT_FALSE(camera.project(point, &pixel)) << describe(camera) << point.transpose();
    }
    if (camera.model() == CameraModel::kEquidistant) continue;
    EXPECT_FALSE(camera.project({0.1, 0.2, -1.0}, &pixel)) << describe(camera);
    EXPECT_FALSE(camera.project({0.1, 0.2, 0.0}, &pixel)) << describe(camera);
  }
}

TEST(Projection, RefusesWithInvalidParameters) {
  Eigen::Vector2d pixel;
  EXPECT_FALSE(Camera().project({0, 0, 1}, &pixel));
  for (const auto& [model, values] : std::vector<std::pair<CameraModel, std::vector<double>>>{
           {CameraModel::kPinhole, {-1, 300, 320, 240}},
           {CameraModel::kPinhole, {300, 0, 320, 240}},
           {CameraModel::kPinhole, {300, 300, kNan, 240}},
           {CameraModel::kFov, {300, 300, 320, 240, 0}},
           {CameraModel::kFov, {300, 300, 320, 240, 3.15}},
           {CameraModel::kRadtan, {300, 300, 320, 240, kInfinity, 0, 0, 0}}}) {
    const Camera camera = camera640(model, values);
    EXPECT_FALSE(camera.valid());
    EXPECT_FALSE(camera.project({0, 0, 1}, &pixel));
    EXPECT_FALSE(camera.unproject({320, 240}));
  }
}

// r (1 + k1 r^2) grows up to r = sqrt(-1 / (3 k1)).
TEST(Projection, RadtanIsRefusedBeyondItsMonotonicRadius) {
  const Camera camera = camera640(CameraModel::kRadtan, {300, 300, 320, 240, -0.3, 0, 0, 0});
  const double limit = std::sqrt(1.0 / 0.9);
  Eigen::Vector2d pixel;
  for (const double angle : {0.0, 0.7, 2.0, 4.0}) {
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d inside = (limit - 1e-9) * direction;
    const Eigen::Vector2d outside = (limit + 1e-9) * direction;
    EXPECT_TRUE(camera.project({inside.x(), inside.y(), 1.0}, &pixel));
    EXPECT_FALSE(camera.project({outside.x(), outside.y(), 1.0}, &pixel));
    EXPECT_FALSE(camera.project({5 * outside.x(), 5 * outside.y(), 1.0}, &pixel));
    const Eigen::Vector2d near = (limit - 2e-3) * direction;
    expectDerivatives(camera, {near.x(), near.y(), 1.0}, 1e-8);
  }
}

TEST(Projection, RadtanWithTangentialTermsGrowsInEveryDirection) {
  const Camera camera = camera640(CameraModel::kRadtan, {300, 300, 320, 240, -0.3, 0, 0.05, -0.04});
  const double limit = std::sqrt(1.0 / 0.9);
  int refused = 0;
  for (double angle = 0.0; angle < 6.3; angle += 0.1) {
    for (double r = 0.0; r < limit; r += 0.002) {
      Eigen::Vector2d pixel;
      Matrix23d j;
      const Eigen::Vector3d point(r * std::cos(angle), r * std::sin(angle), 1.0);
      if (camera.project(point, &pixel, &j)) {
        EXPECT_GT((j.leftCols<2>().determinant()), 0.0);
      } else {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 0);
}

TEST(Projection, EquidistantIsRefusedBeyondItsMonotonicAngle) {
  const Camera camera = camera640(CameraModel::kEquidistant, {300, 300, 320, 240, -0.1, 0, 0, 0});
  const double limit = std::sqrt(1.0 / 0.3);  // 1.83 rad, behind the image plane
  Eigen::Vector2d pixel;
  EXPECT_TRUE(camera.project({std::sin(limit - 1e-9), 0, std::cos(limit - 1e-9)}, &pixel));
  EXPECT_FALSE(camera.project({std::sin(limit + 1e-9), 0, std::cos(limit + 1e-9)}, &pixel));
  expectDerivatives(camera, {0, std::sin(limit - 5e-3), std::cos(limit - 5e-3)}, 1e-8);
}

// The slope of r + k1 r^3 + k2 r^5 + k3 r^7 may fall below zero and rise again: the first zero
// counts.
TEST(Projection, TheFirstFoldEndsTheDomain) {
  // slope = (1 - t)(1 - t/2)(1 - t/3), t = r^2, in the coefficients 1, 3 k1, 5 k2, 7 k3
  const double k1 = -(11.0 / 6.0) / 3.0, k2 = 1.0 / 5.0, k3 = -(1.0 / 6.0) / 7.0;
  Intrinsics parameters(9);
  parameters << 300, 300, 320, 240, k1, k2, 0, 0, k3;
  const Camera camera(CameraModel::kRadtan, 640, 480, parameters);
  Eigen::Vector2d pixel;
  EXPECT_TRUE(camera.project({1.0 - 1e-7, 0, 1}, &pixel));
  EXPECT_FALSE(camera.project({1.0 + 1e-7, 0, 1}, &pixel));
  EXPECT_FALSE(camera.project({std::sqrt(2.5), 0, 1}, &pixel));  // grows again here
}

}  // namespace
}  // namespace camera_self_calibration
