#include "camera_self_calibration/camera/camera.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "camera/sample_cameras.h"

namespace camera_self_calibration {
namespace {

using Names = std::vector<std::string>;

constexpr CameraModel kModels[] = {CameraModel::kPinhole, CameraModel::kFov, CameraModel::kRadtan,
                                   CameraModel::kEquidistant};

TEST(Camera, ModelNamesComeBack) {
  for (const CameraModel model : kModels) EXPECT_EQ(cameraModelFromString(toString(model)), model);
  EXPECT_EQ(cameraModelFromString("plumb_bob"), CameraModel::kRadtan);
  EXPECT_EQ(toString(CameraModel::kRadtan), "radtan");
  EXPECT_FALSE(cameraModelFromString("Fov"));
  EXPECT_FALSE(cameraModelFromString(""));
}

TEST(Camera, DefaultGuessIsNinetyDegreesWide) {
  for (const CameraModel model : kModels) {
    const Camera camera = Camera::defaultGuess(model, 640, 480);
    EXPECT_TRUE(camera.valid());
    EXPECT_EQ(camera.width(), 640);
    EXPECT_EQ(camera.height(), 480);
    ASSERT_EQ(camera.parameterCount(), Camera::parameterCount(model));
    EXPECT_EQ(camera.estimatedCount(), camera.parameterCount());
    EXPECT_EQ(camera.parameters().head<4>(), Eigen::Vector4d(320, 320, 319.5, 239.5));
    for (int i = 4; i < camera.parameterCount(); ++i) {
      EXPECT_EQ(camera.parameters()[i], model == CameraModel::kFov ? 1.0 : 0.0);
    }
  }
}

// Whichever side is the longer: cameras are mounted upright, too.
TEST(Camera, DefaultGuessOfACameraHeldUprightHasTheSameFocalLength) {
  const Camera camera = Camera::defaultGuess(CameraModel::kPinhole, 480, 640);
  EXPECT_EQ(camera.parameters(), Eigen::Vector4d(320, 320, 239.5, 319.5));
}

TEST(Camera, ParameterNames) {
  const auto names = [](CameraModel model) {
    return Camera::defaultGuess(model, 64, 48).parameterNames();
  };
  EXPECT_EQ(names(CameraModel::kPinhole), (Names{"fx", "fy", "cx", "cy"}));
  EXPECT_EQ(names(CameraModel::kFov), (Names{"fx", "fy", "cx", "cy", "w"}));
  EXPECT_EQ(names(CameraModel::kRadtan), (Names{"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"}));
  EXPECT_EQ(names(CameraModel::kEquidistant),
            (Names{"fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"}));
}

TEST(Camera, K3IsKeptAndEstimatedOnDemand) {
  Camera camera = Camera::defaultGuess(CameraModel::kRadtan, 640, 480);
  EXPECT_EQ(camera.estimatedCount(), 8);
  camera.setEstimateK3(true);
  EXPECT_EQ(camera.estimatedCount(), 9);
  EXPECT_EQ(camera.parameterCount(), 9);
  EXPECT_EQ(camera.parameters()[8], 0.0);
  EXPECT_EQ(camera.parameterNames().back(), "k3");
  camera.setEstimateK3(false);
  EXPECT_EQ(camera.estimatedCount(), 8);
  EXPECT_EQ(camera.parameterCount(), 9);

  const Camera given(CameraModel::kRadtan, 640, 480,
                     intrinsics({320, 320, 320, 240, -0.3, 0.1, 0, 0, -0.05}));
  EXPECT_EQ(given.estimatedCount(), 8);
  EXPECT_EQ(given.parameters()[8], -0.05);

  Camera fov = Camera::defaultGuess(CameraModel::kFov, 640, 480);
  fov.setEstimateK3(true);
  EXPECT_EQ(fov.parameterCount(), 5);
  EXPECT_EQ(fov.estimatedCount(), 5);
}

TEST(Camera, WrongLengthsThrow) {
  EXPECT_THROW(camera640(CameraModel::kPinhole, {1, 2, 3}), std::invalid_argument);
  EXPECT_THROW(camera640(CameraModel::kFov, {1, 2, 3, 4}), std::invalid_argument);
  EXPECT_THROW(camera640(CameraModel::kEquidistant, {1, 2, 3, 4, 5, 6, 7, 8, 9}),
               std::invalid_argument);
  EXPECT_NO_THROW(camera640(CameraModel::kRadtan, {1, 2, 3, 4, 0, 0, 0, 0, 0}));
  Camera camera = Camera::defaultGuess(CameraModel::kFov, 640, 480);
  EXPECT_THROW(camera.setParameters(intrinsics({1, 2, 3, 4})), std::invalid_argument);
}

TEST(Camera, SetParametersLeavesNothingStale) {
  for (const Camera& a : sampleCameras()) {
    for (const Camera& b : sampleCameras()) {
      if (a.model() != b.model() || a.parameterCount() != b.parameterCount()) continue;
      Camera changed = a;
      changed.setParameters(b.parameters());
      const Eigen::Vector3d point(0.4, -0.3, 1.0);
      Eigen::Vector2d expected, actual;
      PixelIntrinsicsJacobian expected_d, actual_d;
      ASSERT_EQ(b.project(point, &expected, nullptr, &expected_d),
                changed.project(point, &actual, nullptr, &actual_d));
      EXPECT_EQ(expected, actual);
      EXPECT_EQ(expected_d, actual_d);
    }
  }
}

TEST(Camera, InImage) {
  const Camera camera = Camera::defaultGuess(CameraModel::kPinhole, 640, 480);
  EXPECT_TRUE(camera.inImage({0, 0}));
  EXPECT_TRUE(camera.inImage({639, 479}));
  EXPECT_FALSE(camera.inImage({639.01, 100}));
  EXPECT_FALSE(camera.inImage({100, -0.01}));
  EXPECT_TRUE(camera.inImage({5, 474}, 5));
  EXPECT_FALSE(camera.inImage({4.9, 400}, 5));
  EXPECT_FALSE(camera.inImage({400, 474.1}, 5));
  EXPECT_FALSE(camera.inImage({std::nan(""), 1}));
  EXPECT_FALSE(Camera().inImage({0, 0}));
}

}  // namespace
}  // namespace camera_self_calibration
