#include "camera_self_calibration/localization/moving_tracks.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

constexpr double kSigma = 0.1;
constexpr double kMinPx = 1.5;
constexpr int kStatic = 60;
constexpr int kMoving = 25;

const Camera kCamera = camera640(CameraModel::kFov, {320, 322, 316, 243, 0.95});
const Rigid3 kPose(expSo3({0.02, -0.05, 0.03}), Eigen::Vector3d(0.3, 0.02, 0.05));

// Points seen from the origin and again from kPose; the later ones have moved sideways to the
// camera's own way meanwhile.
std::vector<TrackedPoint> scene(bool depths_known) {
  Random random(5);
  std::vector<TrackedPoint> points;
  for (int i = 0; i < kStatic + kMoving; ++i) {
    Eigen::Vector3d point(random.uniform(-1.5, 1.5), random.uniform(-1.0, 1.0),
                          random.uniform(2.0, 5.0));
    TrackedPoint tracked;
    tracked.track_id = i;
    tracked.depth_known = depths_known || i < kStatic / 2;
    tracked.view.direction = point.normalized();
    tracked.view.origin = Eigen::Vector3d::Zero();
    tracked.view.inverse_depth = tracked.depth_known ? 1.0 / point.norm() : 0.3;
    if (i >= kStatic) point.y() += 0.2;
    EXPECT_TRUE(kCamera.project(kPose.inverse() * point, &tracked.view.pixel));
    tracked.view.pixel += kSigma * random.normal2();
    tracked.view.sigma = kSigma;
    points.push_back(tracked);
  }
  return points;
}

TEST(MovingTracks, AreThoseThatNoDepthExplains) {
  for (const bool depths_known : {true, false}) {
    const auto moving = movingTracks(kCamera, kPose, scene(depths_known), kMinPx);
    EXPECT_EQ(static_cast<int>(moving.size()), kMoving) << depths_known;
    for (const std::int64_t id : moving) EXPECT_GE(id, kStatic) << depths_known;
  }
}

TEST(MovingTracks, AreTheSameInAnyUnitOfTheMap) {
  const auto moving = movingTracks(kCamera, kPose, scene(false), kMinPx);
  for (const double unit : {1e-12, 1e12}) {
    std::vector<TrackedPoint> points = scene(false);
    for (TrackedPoint& point : points) point.view.inverse_depth *= unit;
    const Rigid3 pose(kPose.rotation, kPose.translation / unit);
    EXPECT_EQ(movingTracks(kCamera, pose, points, kMinPx), moving) << unit;
  }
}

// A lens that changed moves all points: none stands out.
TEST(MovingTracks, AreNotAllOfThem) {
  Intrinsics parameters = kCamera.parameters();
  parameters.head<2>() *= 1.1;
  const Camera other(CameraModel::kFov, 640, 480, parameters);
  std::vector<TrackedPoint> points = scene(true);
  points.resize(kStatic);
  EXPECT_LE(movingTracks(other, kPose, points, kMinPx).size(), 3u);
}

TEST(MovingTracks, AreNotNamedWhereLittleIsKnown) {
  std::vector<TrackedPoint> points = scene(true);
  for (std::size_t i = 10; i < points.size(); ++i) points[i].depth_known = false;
  EXPECT_TRUE(movingTracks(kCamera, kPose, points, kMinPx).empty());
  EXPECT_TRUE(movingTracks(kCamera, kPose, {}, kMinPx).empty());
}

}  // namespace
}  // namespace camera_self_calibration
