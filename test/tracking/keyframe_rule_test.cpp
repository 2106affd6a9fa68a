#include "camera_self_calibration/tracking/keyframe_rule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

// A cloud of points in front of a camera, seen from a pose.
class Scene {
 public:
  explicit Scene(int width = 640, double scale = 1.0) : scale_(scale) {
    Intrinsics parameters(4);
    parameters << 0.45 * width, 0.45 * width, 0.5 * width, 0.375 * width;
    camera_ = Camera(CameraModel::kPinhole, width, width * 3 / 4, parameters);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int i = 0; i < 150; ++i) {
      const double depth = 3.0 + unit(random_);
      points_.push_back(scale_ * depth *
                        Eigen::Vector3d(0.9 * unit(random_), 0.7 * unit(random_), 1.0));
    }
  }

  // The tracks of the points with index of at least `first`; translation in units of the scene.
  TrackedFrame see(const Eigen::Vector3d& rotation, const Eigen::Vector3d& translation,
                   double noise = 0.1, std::size_t first = 0) {
    const Rigid3 world_from_camera(expSo3(rotation), scale_ * translation);
    std::normal_distribution<double> normal(0.0, noise);
    TrackedFrame frame;
    frame.width = camera_.width();
    frame.height = camera_.height();
    for (std::size_t i = first; i < points_.size(); ++i) {
      Track track;
      track.id = static_cast<std::int64_t>(i);
      if (!camera_.project(world_from_camera.inverse() * points_[i], &track.pixel)) continue;
      track.pixel += Eigen::Vector2d(normal(random_), normal(random_));
      if (camera_.inImage(track.pixel)) frame.tracks.push_back(track);
    }
    return frame;
  }

  const Camera& camera() const { return camera_; }
  Camera guess() const {
    return Camera::defaultGuess(CameraModel::kFov, camera_.width(), camera_.height());
  }

 private:
  double scale_;
  Camera camera_;
  std::mt19937_64 random_{5};
  std::vector<Eigen::Vector3d> points_;
};

const Eigen::Vector3d kZero = Eigen::Vector3d::Zero();

TEST(KeyframeRule, FirstFrameNeedsTracks) {
  Scene scene;
  KeyframeRule rule{KeyframeOptions()};
  EXPECT_FALSE(rule.isKeyframe(TrackedFrame(), scene.guess()));
  EXPECT_TRUE(rule.isKeyframe(scene.see(kZero, kZero), scene.guess()));
}

TEST(KeyframeRule, StillCameraMakesNone) {
  Scene scene;
  KeyframeRule rule{KeyframeOptions()};
  rule.setKeyframe(scene.see(kZero, kZero, 0.3));
  for (int i = 0; i < 200; ++i) {
    EXPECT_FALSE(rule.isKeyframe(scene.see(kZero, kZero, 0.3), scene.guess()));
  }
}

TEST(KeyframeRule, StillCameraMakesNoneUntilNearlyAllTracksAreLost) {
  Scene scene;
  KeyframeRule rule{KeyframeOptions()};
  const TrackedFrame all = scene.see(kZero, kZero, 0.3);
  rule.setKeyframe(all);
  int kept = 0;
  for (std::size_t first = 0; first <= 150; ++first) {
    const TrackedFrame frame = scene.see(kZero, kZero, 0.3, first);
    if (frame.tracks.empty()) break;
    const bool few = frame.tracks.size() < 0.3 * all.tracks.size();
    EXPECT_EQ(rule.isKeyframe(frame, scene.guess()), few) << first;
    kept += few ? 0 : 1;
  }
  EXPECT_GT(kept, 50);
}

TEST(KeyframeRule, LostTracksCountOnceTheCameraMoves) {
  Scene scene;
  const Eigen::Vector3d little(0.02, 0.0, 0.0);
  KeyframeRule rule{KeyframeOptions()};
  rule.setKeyframe(scene.see(kZero, kZero));
  EXPECT_FALSE(rule.isKeyframe(scene.see(little, kZero), scene.guess()));
  EXPECT_TRUE(rule.isKeyframe(scene.see(little, kZero, 0.1, 90), scene.guess()));
}

TEST(KeyframeRule, RotationAlone) {
  Scene scene;
  for (int axis = 0; axis < 3; ++axis) {
    KeyframeRule rule{KeyframeOptions()};
    rule.setKeyframe(scene.see(kZero, kZero));
    const Eigen::Vector3d degree = Eigen::Vector3d::Unit(axis) * kDegree;
    EXPECT_FALSE(rule.isKeyframe(scene.see(4.0 * degree, kZero), scene.camera())) << axis;
    EXPECT_TRUE(rule.isKeyframe(scene.see(10.0 * degree, kZero), scene.camera())) << axis;
  }
}

TEST(KeyframeRule, SpacingMultipliesRotationAndParallax) {
  Scene scene;
  KeyframeRule rule{KeyframeOptions()};
  rule.setKeyframe(scene.see(kZero, kZero));
  const Eigen::Vector3d turn(0.0, 7.0 * kDegree, 0.0);
  EXPECT_TRUE(rule.isKeyframe(scene.see(turn, kZero), scene.camera()));
  EXPECT_FALSE(rule.isKeyframe(scene.see(turn, kZero), scene.camera(), 2.0));
  EXPECT_TRUE(rule.isKeyframe(scene.see(2.0 * turn, kZero), scene.camera(), 2.0));
  // The distance at which the rule just fires is half as long at half the spacing.
  const auto reach = [&](double spacing) {
    double x = 0.0;
    while (!rule.isKeyframe(scene.see(kZero, {x, 0.0, 0.0}), scene.camera(), spacing)) x += 1e-3;
    return x;
  };
  EXPECT_NEAR(reach(0.5) / reach(1.0), 0.5, 0.1);
  EXPECT_NEAR(reach(2.0) / reach(1.0), 2.0, 0.2);
}

TEST(KeyframeRule, RotationIsNoParallax) {
  Scene scene;
  KeyframeOptions options;
  options.min_rotation_deg = 90.0;
  options.min_tracked_share = 0.0;
  KeyframeRule rule(options);
  rule.setKeyframe(scene.see(kZero, kZero));
  const Eigen::Vector3d turn(0.1, 0.2, 0.1);
  EXPECT_FALSE(rule.isKeyframe(scene.see(turn, kZero), scene.camera()));
  EXPECT_TRUE(rule.isKeyframe(scene.see(turn, {0.5, 0.0, 0.3}), scene.camera()));
}

// Steps along a trajectory until the rule fires.
int stepsToKeyframe(int width, double scale) {
  Scene scene(width, scale);
  KeyframeRule rule{KeyframeOptions()};
  rule.setKeyframe(scene.see(kZero, kZero, 0.0));
  for (int i = 1; i < 200; ++i) {
    const Eigen::Vector3d translation(0.004 * i, 0.002 * i, 0.008 * i);
    if (rule.isKeyframe(scene.see(kZero, translation, 0.0), scene.guess())) return i;
  }
  return 200;
}

TEST(KeyframeRule, ParallaxCountsWhateverTheScale) {
  const int steps = stepsToKeyframe(640, 1.0);
  EXPECT_GT(steps, 3);
  EXPECT_LT(steps, 150);
  EXPECT_EQ(stepsToKeyframe(640, 0.01), steps);
  EXPECT_EQ(stepsToKeyframe(640, 100.0), steps);
  EXPECT_EQ(stepsToKeyframe(1280, 1.0), steps);
}

TEST(KeyframeRule, IgnoresOutliersAndMovingObjects) {
  Scene scene;
  KeyframeRule rule{KeyframeOptions()};
  rule.setKeyframe(scene.see(kZero, kZero));
  TrackedFrame frame = scene.see(kZero, kZero);
  for (std::size_t i = 0; i < frame.tracks.size() / 3; ++i) frame.tracks[i].pixel.x() += 60.0;
  EXPECT_FALSE(rule.isKeyframe(frame, scene.guess()));
}

TEST(KeyframeRule, FewTracksAreJudgedByTheirFlow) {
  Scene scene;
  KeyframeRule rule{KeyframeOptions()};
  rule.setKeyframe(scene.see(kZero, kZero, 0.1, 146));
  EXPECT_FALSE(rule.isKeyframe(scene.see(kZero, kZero, 0.1, 146), scene.guess()));
  EXPECT_TRUE(rule.isKeyframe(scene.see({0.0, 0.1, 0.0}, kZero, 0.1, 146), scene.guess()));
  // A camera that nothing is known of has no rays.
  EXPECT_TRUE(rule.isKeyframe(scene.see({0.0, 0.1, 0.0}, kZero, 0.1, 146), Camera()));
}

TEST(KeyframeRule, OptionsNameEveryProblem) {
  EXPECT_TRUE(KeyframeOptions().problems().empty());
  KeyframeOptions options;
  options.min_parallax = 0.0;
  options.min_rotation_deg = std::nan("");
  options.min_tracked_share = 1.5;
  EXPECT_EQ(options.problems().size(), 3u);
}

}  // namespace
}  // namespace camera_self_calibration
