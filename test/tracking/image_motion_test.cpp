#include "camera_self_calibration/tracking/image_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

constexpr double kLineDelay = 30e-6;
constexpr double kMiddle = 239.5;
constexpr double kPeriod = 1.0 / 30.0;

// A feature that is being accelerated.
Eigen::Vector2d path(double t) {
  return Eigen::Vector2d(200.0, 430.0) + t * Eigen::Vector2d(300.0, -250.0) +
         0.5 * t * t * Eigen::Vector2d(-2000.0, 3000.0);
}

// As rows that are read one after the other see it; the middle one at `t`.
Eigen::Vector2d seen(double t) {
  Eigen::Vector2d pixel = path(t);
  for (int i = 0; i < 20; ++i) pixel = path(t + (pixel.y() - kMiddle) * kLineDelay);
  return pixel;
}

TrackedFrame frame(int index) {
  TrackedFrame result;
  result.stamp_ns = static_cast<std::int64_t>(1e9 * kPeriod * index);
  Track track;
  track.id = 7;
  track.pixel = track.reference_pixel = seen(kPeriod * index);
  result.tracks = {track};
  return result;
}

double errorAt(const MotionHistory& history, int index, int images_ago) {
  const ImageMotion motion = history.motions(images_ago).at(7);
  const double t = kPeriod * index;
  return (asSeenAtOnce(seen(t), motion, kMiddle, kLineDelay) - path(t)).norm();
}

TEST(ImageMotion, FreesAPixelOfTheRollingShutter) {
  ASSERT_GT((seen(0.0) - path(0.0)).norm(), 2.0) << "there is something to be freed of";
  MotionHistory history;
  for (int i = 0; i < 3; ++i) history.add(frame(i));
  EXPECT_LT(errorAt(history, 1, 1), 0.005) << "between two other images";
  EXPECT_LT(errorAt(history, 2, 0), 0.02) << "in the newest image";
  EXPECT_LT(errorAt(history, 0, 2), 0.02) << "in the image of its detection";
}

TEST(ImageMotion, TwoImagesGiveItsVelocity) {
  MotionHistory history;
  history.add(frame(0));
  EXPECT_TRUE(history.motions(0).at(7).velocity.isZero()) << "seen once";
  history.add(frame(1));
  const ImageMotion motion = history.motions(0).at(7);
  EXPECT_LT((motion.velocity - (seen(kPeriod) - seen(0.0)) / kPeriod).norm(), 1e-5);
  EXPECT_TRUE(motion.acceleration.isZero());
}

// The largest error of the velocity of a hand that shakes at 3 Hz [share], over the images.
double worstOfAShakingHand(int images_ago) {
  const double omega = 2.0 * M_PI * 3.0;
  MotionHistory history;
  double worst = 0.0;
  for (int i = 0; i < 60; ++i) {
    TrackedFrame shaken;
    shaken.stamp_ns = std::llround(1e9 * kPeriod * i);
    Track track;
    track.id = 7;
    track.pixel = {300.0 + 30.0 * std::sin(omega * kPeriod * i), 200.0};
    shaken.tracks = {track};
    history.add(shaken);
    if (history.size() < MotionHistory::kImages) continue;
    const ImageMotion motion = history.motions(images_ago).at(7);
    const double truth = 30.0 * omega * std::cos(omega * kPeriod * (i - images_ago));
    worst = std::max(worst, std::abs(motion.velocity.x() - truth) / (30.0 * omega));
  }
  return worst;
}

TEST(ImageMotion, FollowsAShakingHandBetweenTwoImagesOnEitherSide) {
  EXPECT_LT(worstOfAShakingHand(2), 0.006);
  EXPECT_GT(worstOfAShakingHand(0), 0.1) << "the newest image has none after it";
}

TEST(ImageMotion, TwoImagesOfOneStampAreOne) {
  MotionHistory history;
  for (const int i : {0, 1, 1, 2, 3}) history.add(frame(i));
  for (int ago = 0; ago <= MotionHistory::kReach; ++ago) {
    EXPECT_TRUE(history.motions(ago).at(7).velocity.allFinite()) << ago << " images ago";
  }
}

TEST(ImageMotion, TellsInHowManyImagesItWasMeasured) {
  MotionHistory history;
  for (int i = 0; i < 7; ++i) history.add(frame(i));
  EXPECT_EQ(history.motions(0).at(7).images, 3);
  EXPECT_EQ(history.motions(1).at(7).images, 4);
  EXPECT_EQ(history.motions(2).at(7).images, 5);
}

TEST(ImageMotion, InTimeItIsThatOfTheFeature) {
  MotionHistory history;
  for (int i = 0; i < 3; ++i) history.add(frame(i));
  const ImageMotion stamped = history.motions(1).at(7);
  const ImageMotion in_time = motionInTime(seen(kPeriod), stamped, kMiddle, kLineDelay);
  const Eigen::Vector2d acceleration(-2000.0, 3000.0);
  const Eigen::Vector2d velocity = Eigen::Vector2d(300.0, -250.0) + kPeriod * acceleration;
  EXPECT_LT((in_time.velocity - velocity).norm(), 1.5) << "the parabola is not exact";
  EXPECT_LT((in_time.acceleration - acceleration).norm(), 80.0);
  EXPECT_GT((stamped.velocity - velocity).norm(), 10.0) << "rows make it look different";
  const ImageMotion exact{velocity, acceleration};
  EXPECT_LT((asSeenAtOnceInTime(seen(kPeriod), exact, kMiddle, kLineDelay) - path(kPeriod)).norm(),
            1e-9);
}

TEST(ImageMotion, AGlobalShutterChangesNothing) {
  const ImageMotion motion{{100.0, 200.0}, {3000.0, -1000.0}};
  EXPECT_EQ(asSeenAtOnce({10.0, 20.0}, motion, kMiddle, 0.0), Eigen::Vector2d(10.0, 20.0));
}

// Images that are taken at `taken_s`, and stamped at `stamped_s`.
TrackedFrame frameAt(double taken_s, double stamped_s) {
  TrackedFrame result;
  result.stamp_ns = std::llround(1e9 * stamped_s);
  for (int id = 0; id < 5; ++id) {
    Track track;
    track.id = id;
    track.pixel = {300.0 + 40.0 * id + 90.0 * std::sin(4.0 * taken_s), 200.0 + 60.0 * taken_s};
    result.tracks.push_back(track);
  }
  return result;
}

// The largest error of a velocity [share], after the first images.
double worstVelocity(bool taken_unevenly) {
  Random random(4);
  MotionHistory history;
  double worst = 0.0, before = 0.0;
  for (int i = 0; i < 90; ++i) {
    const double even = kPeriod * i;
    const double uneven = even + random.uniform(-0.12, 0.12) * kPeriod;
    const double taken = taken_unevenly ? uneven : even;
    history.add(frameAt(taken, uneven));
    if (i > 20) {
      const Eigen::Vector2d truth(360.0 * std::cos(4.0 * before), 60.0);
      const Eigen::Vector2d error = history.motions(1).at(3).velocity - truth;
      worst = std::max(worst, error.norm() / 360.0);
    }
    before = taken;
  }
  return worst;
}

TEST(ImageMotion, ASteadyCameraIsNotThoughtUnsteadyForItsStamps) {
  EXPECT_LT(worstVelocity(false), 0.02) << "stamped up to 12 % of a period early or late";
}

TEST(ImageMotion, ImagesTakenUnevenlyKeepTheTimesOfTheirStamps) {
  EXPECT_LT(worstVelocity(true), 0.02);
}

TEST(ImageMotion, AnotherRateIsTakenAfterAFewImages) {
  Random random(5);
  MotionHistory history;
  double worst = 0.0, before = 0.0, taken = 0.0;
  for (int i = 0; i < 120; ++i) {
    taken += i < 60 ? 2.0 * kPeriod : kPeriod;  // as exposure times allow again
    history.add(frameAt(taken, taken + random.uniform(-0.1, 0.1) * kPeriod));
    if (i > 80) {
      const Eigen::Vector2d truth(360.0 * std::cos(4.0 * before), 60.0);
      worst = std::max(worst, (history.motions(1).at(3).velocity - truth).norm() / 360.0);
    }
    before = taken;
  }
  EXPECT_LT(worst, 0.05) << "half the old rate would be wrong by half";
}

}  // namespace
}  // namespace camera_self_calibration
