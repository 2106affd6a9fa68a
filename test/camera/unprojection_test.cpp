#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "camera/sample_cameras.h"

namespace camera_self_calibration {
namespace {

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Fourth-order central difference of the ray in one parameter.
Eigen::Vector3d numericRaySlope(const Camera& camera, const Eigen::Vector2d& pixel, int index,
                                double step) {
  const auto rayAt = [&](double change) {
    Intrinsics parameters = camera.parameters();
    parameters[index] += change;
    Camera moved = camera;
    moved.setParameters(parameters);
    return moved.unproject(pixel).value_or(Eigen::Vector3d::Constant(std::nan("")));
  };
  return (rayAt(-2 * step) - 8 * rayAt(-step) + 8 * rayAt(step) - rayAt(2 * step)) / (12 * step);
}

TEST(Unprojection, PixelsComeBackOverTheImage) {
  for (const Camera& camera : sampleCameras()) {
    int found = 0;
    for (double y = 0.0; y < camera.height(); y += 13.0) {
      for (double x = 0.0; x < camera.width(); x += 17.0) {
        const Eigen::Vector2d pixel(x, y);
        const auto ray = camera.unproject(pixel);
        if (!ray) continue;
        ++found;
        Eigen::Vector2d back;
        EXPECT_NEAR(ray->norm(), 1.0, 1e-15);
        ASSERT_TRUE(camera.project(*ray, &back)) << describe(camera) << " " << pixel.transpose();
        EXPECT_LT((back - pixel).norm(), 1e-9) << describe(camera) << " " << pixel.transpose();
      }
    }
    EXPECT_GT(found, 500) << describe(camera);
  }
}

// Every ray of the domain is found again, to 1e-12 rad, but for the last degrees before a fold,
// where the pixel hardly depends on the ray.
TEST(Unprojection, RaysComeBack) {
  for (const Camera& camera : sampleCameras()) {
    int projected = 0;
    for (double theta = 0.0; theta < 2.5; theta += 0.0237) {
      for (double phi = 0.05; phi < 6.3; phi += 0.41) {
        const Eigen::Vector3d ray(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                                  std::cos(theta));
        Eigen::Vector2d pixel;
        Matrix23d j;
        if (!camera.project(ray, &pixel, &j)) continue;
        const auto back = camera.unproject(pixel);
        ASSERT_TRUE(back) << describe(camera) << " at " << theta << " " << phi;
        // Rounding of the pixel, divided by how much the pixel changes with the ray.
        const Eigen::Matrix2d jjt = j * j.transpose();
        const double gain = std::sqrt(jjt.determinant() / jjt.trace());
        const double rounding = 4e-16 * (pixel.norm() + camera.parameters().head<4>().norm());
        EXPECT_LT(angleBetween(*back, ray), 1e-12 + 8.0 * rounding / gain)
            << describe(camera) << " at " << theta << " " << phi;
        ++projected;
      }
    }
    EXPECT_GT(projected, 300) << describe(camera);
  }
}

TEST(Unprojection, ThePrincipalPointIsTheAxis) {
  for (const Camera& camera : sampleCameras()) {
    const auto ray = camera.unproject(camera.parameters().segment<2>(2));
    ASSERT_TRUE(ray);
    EXPECT_LT((*ray - Eigen::Vector3d::UnitZ()).norm(), 1e-15) << describe(camera);
  }
}

TEST(Unprojection, RayDerivativesAreNumericOnes) {
  for (const Camera& camera : sampleCameras()) {
    const bool tiny_w = camera.model() == CameraModel::kFov && camera.parameters()[4] < 1e-3;
    if (tiny_w) continue;  // No room for a difference; see the derivatives of project.
    for (double y = 20.0; y < camera.height(); y += 73.0) {
      for (double x = 20.0; x < camera.width(); x += 71.0) {
        const Eigen::Vector2d pixel(x, y);
        const Eigen::Vector2d centre = camera.parameters().segment<2>(2);
        // Next to a fold the ray is hardly smooth enough for differences.
        if (!camera.unproject(centre + 1.02 * (pixel - centre))) continue;
        Eigen::Vector3d ray;
        RayIntrinsicsJacobian analytic;
        ASSERT_TRUE(camera.unproject(pixel, &ray, &analytic));
        ASSERT_EQ(analytic.cols(), camera.parameterCount());
        for (int i = 0; i < analytic.cols(); ++i) {
          EXPECT_LT(std::abs(ray.dot(analytic.col(i))), 1e-10 * (1.0 + analytic.col(i).norm()));
        }
        for (int i = 0; i < camera.parameterCount(); ++i) {
          // A step that moves the ray by at most 2e-4.
          const double step = 2e-4 / (analytic.col(i).norm() + (i < 4 ? 1e-3 : 0.1));
          const Eigen::Vector3d numeric = numericRaySlope(camera, pixel, i, step);
          EXPECT_LT((analytic.col(i) - numeric).norm(), 1e-7 * (1.0 + numeric.norm()))
              << describe(camera) << " parameter " << i << " at " << pixel.transpose();
        }
      }
    }
  }
}

TEST(Unprojection, RefusesPixelsThatNoRayReaches) {
  const Camera fov = camera640(CameraModel::kFov, {200, 200, 320, 240, 1.2});
  const double edge = 200.0 * 0.5 * M_PI / 1.2;
  EXPECT_TRUE(fov.unproject({320 + edge - 1e-6, 240}));
  EXPECT_FALSE(fov.unproject({320 + edge + 1e-6, 240}));

  const Camera radtan = camera640(CameraModel::kRadtan, {300, 300, 320, 240, -0.3, 0, 0, 0});
  const double fold = 300.0 * std::sqrt(1.0 / 0.9) * (1.0 - 1.0 / 3.0);
  EXPECT_TRUE(radtan.unproject({320 - fold + 1e-6, 240}));
  EXPECT_FALSE(radtan.unproject({320 - fold - 1e-6, 240}));

  const Camera equidistant =
      camera640(CameraModel::kEquidistant, {300, 300, 320, 240, -0.1, 0, 0, 0});
  const double end = 300.0 * std::sqrt(1.0 / 0.3) * (1.0 - 1.0 / 3.0);
  EXPECT_TRUE(equidistant.unproject({320, 240 + end - 1e-6}));
  EXPECT_FALSE(equidistant.unproject({320, 240 + end + 1e-6}));

  for (const Camera& camera : sampleCameras()) {
    EXPECT_FALSE(camera.unproject({std::nan(""), 1.0}));
    EXPECT_FALSE(camera.unproject({1.0, INFINITY}));
    Eigen::Vector3d ray;
    RayIntrinsicsJacobian d;
    EXPECT_FALSE(camera.unproject({1.0, INFINITY}, &ray, &d));
  }
}

TEST(Unprojection, EquidistantSeesBehindTheImagePlane) {
  const Camera camera = camera640(CameraModel::kEquidistant, {180, 180, 320, 240, 0, 0, 0, 0});
  const auto ray = camera.unproject({0, 240});
  ASSERT_TRUE(ray);
  EXPECT_NEAR(std::atan2(-ray->x(), ray->z()), 320.0 / 180.0, 1e-14);
  EXPECT_LT(ray->z(), 0.0);
}

}  // namespace
}  // namespace camera_self_calibration
