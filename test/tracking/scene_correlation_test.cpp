#include "camera_self_calibration/tracking/scene_correlation.h"

#include <gtest/gtest.h>

#include <random>

#include "camera_self_calibration/geometry/so3.h"
#include "tracking/textured_box.h"

namespace camera_self_calibration {
namespace {

class SceneCorrelationTest : public testing::Test {
 protected:
  SceneCorrelationTest() : renderer_(TexturedBox(3), camera(), 3) {}

  static Camera camera() {
    Intrinsics parameters(4);
    parameters << 200.0, 200.0, 159.5, 119.5;
    return Camera(CameraModel::kPinhole, 320, 240, parameters);
  }

  ImagePyramid seen(double yaw, const BoxRenderer::Photometry& photometry = {}) {
    ImagePyramid pyramid;
    const Rigid3 pose(expSo3({0.0, yaw, 0.0}), Eigen::Vector3d::Zero());
    pyramid.build(renderer_.render(pose, photometry, &random_).view());
    return pyramid;
  }

  // As the camera turns.
  static LocalMotion turnedBy(double yaw) {
    const Eigen::Matrix3d turn = expSo3({0.0, -yaw, 0.0}).toRotationMatrix();
    std::vector<cv::Point2f> from, to;
    for (int x = 20; x < 320; x += 40) {
      for (int y = 20; y < 240; y += 40) {
        Eigen::Vector2d pixel;
        const Eigen::Vector3d ray = *camera().unproject(Eigen::Vector2d(x, y));
        if (!camera().project(turn * ray, &pixel)) continue;
        from.emplace_back(static_cast<float>(x), static_cast<float>(y));
        to.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
      }
    }
    LocalMotion motion;
    motion.fit(
        from, to, [](std::size_t) { return true; }, 48.0);
    return motion;
  }

  double correlation(const ImagePyramid& before, const ImagePyramid& now, double yaw) {
    return sceneCorrelation(before, now, turnedBy(yaw));
  }

  std::mt19937_64 random_{1};
  BoxRenderer renderer_;
};

TEST_F(SceneCorrelationTest, FollowsTheMotionOfTheFeatures) {
  for (const double yaw : {0.0, 0.05, 0.2}) {
    EXPECT_GT(correlation(seen(0.0), seen(yaw), yaw), 0.8) << yaw;
  }
  EXPECT_LT(correlation(seen(0.0), seen(0.2), 0.0), 0.6);
}

TEST_F(SceneCorrelationTest, IsSmallBetweenDifferentScenes) {
  for (const double yaw : {1.5, 2.5, 3.5, 4.5}) {
    EXPECT_LT(correlation(seen(0.0), seen(yaw), 0.0), 0.4) << yaw;
  }
}

TEST_F(SceneCorrelationTest, KnowsNoBrightness) {
  BoxRenderer::Photometry darker;
  darker.gain = 0.5;
  darker.offset = 20.0;
  EXPECT_GT(correlation(seen(0.0), seen(0.0, darker), 0.0), 0.9);
}

TEST_F(SceneCorrelationTest, SaysNothingWhereNothingIsSeen) {
  BoxRenderer::Photometry dark;
  dark.gain = 0.0;
  EXPECT_EQ(correlation(seen(0.0, dark), seen(0.0), 0.0), 1.0);
  EXPECT_LT(correlation(seen(0.0), seen(0.0, dark), 0.0), 0.4);
  EXPECT_EQ(correlation(ImagePyramid(), seen(0.0), 0.0), 1.0);
}

}  // namespace
}  // namespace camera_self_calibration
