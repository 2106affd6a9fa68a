#include "camera_self_calibration/map/rigid_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/map/rolling_shutter.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

constexpr double kLineDelay = 30e-6;
constexpr double kMiddle = 239.5;
constexpr double kFrame = 1.0 / 30.0;
constexpr int kPoints = 100;

const Camera kCamera = camera640(CameraModel::kFov, {320, 322, 316, 243, 0.95});

// A camera that is thrown about in a cloud of points.
Rigid3 poseAt(double t) {
  Vector6d twist, bend;
  twist << 0.4, -0.2, 0.3, 0.5, -0.7, 0.4;
  bend << -2.0, 1.0, 1.0, 3.0, 4.0, -2.0;
  return expSe3(t * twist + 0.5 * t * t * bend);
}

Eigen::Vector3d pointAt(int i) {
  Random random(static_cast<std::uint64_t>(i) + 1);
  return {random.uniform(-1.5, 1.5), random.uniform(-1.0, 1.0), random.uniform(1.5, 6.0)};
}

Eigen::Vector2d pixelAt(int i, double t) {
  Eigen::Vector2d pixel(NAN, NAN);
  EXPECT_TRUE(kCamera.project(poseAt(t).inverse() * pointAt(i), &pixel));
  return pixel;
}

// As rows that are read one after the other see it; the middle one at `t`.
Eigen::Vector2d seenAt(int i, double t) {
  Eigen::Vector2d pixel = pixelAt(i, t);
  for (int k = 0; k < 20; ++k) pixel = pixelAt(i, t + (pixel.y() - kMiddle) * kLineDelay);
  return pixel;
}

// Through the pixels of three moments.
ImageMotion motionOf(const Eigen::Vector2d& before, const Eigen::Vector2d& now,
                     const Eigen::Vector2d& after, double step) {
  return {(after - before) / (2.0 * step), (after - 2.0 * now + before) / (step * step)};
}

MovingPoint movingPoint(int i) {
  const Eigen::Vector3d point = pointAt(i);  // the pose at time 0 is the identity
  constexpr double kStep = 1e-3;
  return {point.normalized(), 1.0 / point.norm(),
          motionOf(pixelAt(i, -kStep), pixelAt(i, 0.0), pixelAt(i, kStep), kStep)};
}

std::vector<MovingPoint> movingPoints(int count, double noise, Random* random) {
  std::vector<MovingPoint> points;
  for (int i = 0; i < count; ++i) {
    points.push_back(movingPoint(i));
    points.back().measured.velocity += noise * random->normal2();
  }
  return points;
}

double rmsVelocityError(const CameraMotion& motion) {
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const auto found = imageMotion(movingPoint(i), motion, kCamera);
    EXPECT_TRUE(found);
    sum += (found->velocity - movingPoint(i).measured.velocity).squaredNorm();
  }
  return std::sqrt(sum / (2 * kPoints));
}

TEST(RigidMotion, ExplainsVelocityAndAccelerationOfAllPoints) {
  Random random(1);
  const auto motion = fitCameraMotion(movingPoints(40, 0.0, &random), kCamera);
  ASSERT_TRUE(motion);
  for (int i = 40; i < kPoints; ++i) {
    const MovingPoint other = movingPoint(i);
    const auto found = imageMotion(other, *motion, kCamera);
    ASSERT_TRUE(found);
    EXPECT_LT((found->velocity - other.measured.velocity).norm(), 0.01) << "of about 300 px/s";
    EXPECT_LT((found->acceleration - other.measured.acceleration).norm(), 2.0)
        << "of about " << other.measured.acceleration.norm() << " px/s^2";
  }
}

TEST(RigidMotion, AveragesOverNoise) {
  Random random(2);
  const auto motion = fitCameraMotion(movingPoints(kPoints, 10.0, &random), kCamera);
  ASSERT_TRUE(motion);
  // Six numbers from two hundred: 10 px/s x sqrt(6 / 200) = 1.7 px/s is expected.
  EXPECT_LT(rmsVelocityError(*motion), 3.0);
}

TEST(RigidMotion, PassesOverWhatMovesByItself) {
  Random random(3);
  std::vector<MovingPoint> points = movingPoints(kPoints, 2.0, &random);
  for (int i = 0; i < kPoints; i += 7) points[i].measured.velocity += Eigen::Vector2d(400.0, 100.0);
  const auto motion = fitCameraMotion(points, kCamera);
  ASSERT_TRUE(motion);
  EXPECT_LT(rmsVelocityError(*motion), 2.0);
}

TEST(RigidMotion, GoesByTheFeaturesThatWereMeasuredInMostImages) {
  Random random(6);
  std::vector<MovingPoint> points = movingPoints(kPoints, 0.0, &random);
  // As of tracks that begin or end here: alike for all of them, so that no robust loss helps.
  for (int i = 0; i < kPoints; ++i) {
    points[i].measured.images = i < 30 ? 5 : 3;
    if (i >= 30) points[i].measured.velocity *= 0.9;
  }
  const auto motion = fitCameraMotion(points, kCamera);
  ASSERT_TRUE(motion);
  EXPECT_LT(rmsVelocityError(*motion), 0.01);
  points.erase(points.begin() + 8, points.begin() + 30);
  const auto most = fitCameraMotion(points, kCamera);
  ASSERT_TRUE(most);
  EXPECT_GT(rmsVelocityError(*most), 5.0) << "eight are too few to do without the others";
}

bool seenToMoveWith(const CameraMotion& motion, const MovingPoint& point) {
  const auto scene = imageMotion(point, motion, kCamera);
  return scene && movesWithScene(point, *scene, motion.typical_residual);
}

TEST(RigidMotion, TellsWhatIsSeenToMoveOtherwise) {
  Random random(7);
  const auto motion = fitCameraMotion(movingPoints(kPoints, 2.0, &random), kCamera);
  ASSERT_TRUE(motion);
  MovingPoint at_camera = movingPoint(0);
  at_camera.inverse_depth *= 1e6;
  EXPECT_FALSE(seenToMoveWith(*motion, at_camera));
  MovingPoint by_itself = movingPoint(1);
  by_itself.measured.velocity *= -0.3;
  EXPECT_FALSE(seenToMoveWith(*motion, by_itself));
  MovingPoint slow = movingPoint(2);
  slow.measured.velocity *= 0.8;  // by a polynomial that is too stiff
  EXPECT_TRUE(seenToMoveWith(*motion, slow));
  MovingPoint seen_once = movingPoint(3);
  seen_once.measured = ImageMotion();
  EXPECT_TRUE(seenToMoveWith(*motion, seen_once));
}

TEST(RigidMotion, NeedsPointsWhoseMotionIsKnown) {
  Random random(4);
  EXPECT_FALSE(fitCameraMotion(movingPoints(8, 0.0, &random), kCamera));
  std::vector<MovingPoint> unknown = movingPoints(kPoints, 0.0, &random);
  for (MovingPoint& point : unknown) point.measured = ImageMotion();
  EXPECT_FALSE(fitCameraMotion(unknown, kCamera));
}

// Two keyframes; the pixels and motions of the second are those of a rolling shutter, with noise in
// the images before and after it.
Segment rollingSegment(double noise_px) {
  Random random(5);
  Segment segment;
  segment.keyframes.resize(2);
  segment.keyframes[0].world_from_camera = poseAt(-0.5);
  segment.keyframes[1].world_from_camera = poseAt(0.0);
  for (int i = 0; i < kPoints; ++i) {
    const Eigen::Vector3d point = poseAt(-0.5).inverse() * pointAt(i);
    Landmark landmark;
    landmark.track_id = i;
    landmark.anchored = false;
    landmark.bearing = point.normalized();
    landmark.inverse_depth = 1.0 / point.norm();
    Observation observation;
    observation.landmark = i;
    observation.keyframe = 1;
    observation.pixel = seenAt(i, 0.0);
    observation.shift.motion =
        motionOf(seenAt(i, -kFrame) + noise_px * random.normal2(), seenAt(i, 0.0),
                 seenAt(i, kFrame) + noise_px * random.normal2(), kFrame);
    segment.landmarks.push_back(landmark);
    segment.observations.push_back(observation);
  }
  return segment;
}

double rmsFreedError(const Segment& segment) {
  double sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    sum += (segment.observations[i].pixel - pixelAt(i, 0.0)).squaredNorm();
  }
  return std::sqrt(sum / (2 * kPoints));
}

TEST(RigidMotion, FreesPixelsOfTheRollingShutterWithoutTheNoiseOfTheirMotion) {
  const Segment seen = rollingSegment(0.5);
  ASSERT_GT(rmsFreedError(seen), 0.3) << "there is something to be freed of";
  Segment each = seen;
  setLineDelay(kLineDelay, kCamera.height(), &each);
  Segment together = seen;
  setLineDelayOfScene(kLineDelay, kCamera, &together);
  EXPECT_LT(rmsFreedError(together), 0.4 * rmsFreedError(each));
  EXPECT_LT(rmsFreedError(together), 0.015);
  EXPECT_EQ(together.keyframes.front().line_delay_s, kLineDelay);
  setLineDelayOfScene(0.0, kCamera, &together);
  for (int i = 0; i < kPoints; ++i) {
    EXPECT_LT((together.observations[i].pixel - seen.observations[i].pixel).norm(), 1e-9);
  }
}

TEST(RigidMotion, WhichFeaturesMoveWithTheSceneCanBeHeld) {
  const Segment seen = rollingSegment(0.0);
  Segment other = seen;
  other.observations[3].shift.motion.velocity *= -0.3;
  Segment decided = other;
  SceneMembers members = setLineDelayOfScene(kLineDelay, kCamera, &decided);
  ASSERT_EQ(members.size(), 2u);
  ASSERT_EQ(members[1].size(), static_cast<std::size_t>(kPoints));
  for (int i = 0; i < kPoints; ++i) EXPECT_EQ(members[1][i], i != 3) << i;
  Segment alone = other;
  setLineDelay(kLineDelay, kCamera.height(), &alone);
  EXPECT_EQ(decided.observations[3].pixel, alone.observations[3].pixel) << "as it was seen to move";
  Segment again = other;
  setLineDelayOfScene(kLineDelay, kCamera, members, &again);
  EXPECT_EQ(again.observations[3].pixel, decided.observations[3].pixel);
  members[1][3] = true;
  setLineDelayOfScene(kLineDelay, kCamera, members, &again);
  EXPECT_LT((again.observations[3].pixel - pixelAt(3, 0.0)).norm(), 0.1) << "as the scene does";
  EXPECT_GT((decided.observations[3].pixel - pixelAt(3, 0.0)).norm(), 0.1);
}

}  // namespace
}  // namespace camera_self_calibration
