#include "camera_self_calibration/tracking/local_motion.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

namespace camera_self_calibration {
namespace {

constexpr double kReach = 60.0;  // [px]

struct Flow {
  std::vector<cv::Point2f> from, to;

  void add(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    from.emplace_back(static_cast<float>(a.x()), static_cast<float>(a.y()));
    to.emplace_back(static_cast<float>(b.x()), static_cast<float>(b.y()));
  }

  LocalMotion fitted() const {
    LocalMotion motion;
    motion.fit(
        from, to, [](std::size_t) { return true; }, kReach);
    return motion;
  }
};

// Turn about, and scaling from, the origin, then a shift.
struct Turn {
  double angle = 0.05;
  double scale = 1.02;
  Eigen::Vector2d shift{12.0, -7.0};

  Eigen::Matrix2d linear() const { return scale * Eigen::Rotation2Dd(angle).toRotationMatrix(); }
  Eigen::Vector2d operator()(const Eigen::Vector2d& pixel) const {
    return linear() * pixel + shift;
  }
};

Flow flowOf(const Turn& turn, int count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> across(0.0, 640.0), down(0.0, 480.0);
  Flow flow;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d pixel(across(random), down(random));
    flow.add(pixel, turn(pixel));
  }
  return flow;
}

TEST(LocalMotion, FindsShiftTurnAndScale) {
  const Turn turn;
  const LocalMotion motion = flowOf(turn, 40).fitted();
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(100, 80), Eigen::Vector2d(600, 420)}) {
    const LocalMotion::Motion found = motion.at(pixel);
    EXPECT_LT((found.pixel - turn(pixel)).norm(), 0.01);
    EXPECT_LT((found.linear - turn.linear()).norm(), 1e-4);
  }
}

TEST(LocalMotion, FewerThanSixPairsSayNothing) {
  const Eigen::Vector2d pixel(320, 240);
  const LocalMotion motion = flowOf(Turn(), 5).fitted();
  EXPECT_EQ(motion.at(pixel).pixel, pixel);
  EXPECT_EQ(motion.at(pixel).linear, Eigen::Matrix2d::Identity());
  EXPECT_EQ(motion.scatter(), 0.0);
  EXPECT_FALSE(motion.expectsMoreThan(0));
}

TEST(LocalMotion, TellsHowManyMoveAsTheirNeighboursDo) {
  Flow flow = flowOf(Turn(), 40);
  for (std::size_t i = 0; i < 4; ++i) flow.to[10 * i] += cv::Point2f(0.0f, 30.0f);
  const LocalMotion motion = flow.fitted();
  EXPECT_TRUE(motion.expectsMoreThan(35));
  EXPECT_FALSE(motion.expectsMoreThan(36));
}

TEST(LocalMotion, WhatWasNotFoundDoesNotCount) {
  const Turn turn;
  Flow flow = flowOf(turn, 20);
  for (std::size_t i = 0; i < 20; i += 2) flow.to[i] = {-1e6f, 1e6f};
  LocalMotion motion;
  motion.fit(
      flow.from, flow.to, [](std::size_t i) { return i % 2 == 1; }, kReach);
  EXPECT_LT((motion.at({320, 240}).pixel - turn({320, 240})).norm(), 0.01);
}

// A fifth of the pairs has jumped to another corner; the least squares of all would be pixels off.
TEST(LocalMotion, OutliersCountLess) {
  const Turn turn;
  Flow flow = flowOf(turn, 60);
  for (std::size_t i = 0; i < flow.to.size(); i += 5) flow.to[i] += cv::Point2f(40.0f, 25.0f);
  const LocalMotion motion = flow.fitted();
  EXPECT_LT((motion.at({320, 240}).pixel - turn({320, 240})).norm(), 1.5);
  EXPECT_LT(motion.scatter(), 25.0);
}

// Near and far things move differently: what is expected is the motion of the neighbourhood.
TEST(LocalMotion, NeighboursCountMost) {
  std::mt19937 random(5);
  std::normal_distribution<double> spread(0.0, 30.0);
  const Eigen::Vector2d left(120, 240), right(520, 240), shift(6, 0);
  Flow flow;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector2d offset(spread(random), spread(random));
    flow.add(left + offset, left + offset + shift);
    flow.add(right + offset, right + offset - shift);
  }
  const LocalMotion motion = flow.fitted();
  EXPECT_LT((motion.at(left).pixel - left - shift).norm(), 1.0);
  EXPECT_LT((motion.at(right).pixel - right + shift).norm(), 1.0);
}

// An object serves for many images: nothing of the last one is left.
TEST(LocalMotion, StartsAnewWithEachImage) {
  LocalMotion reused = flowOf(Turn(), 60).fitted();
  const Turn other{-0.02, 1.0, {3.0, 4.0}};
  const Flow flow = flowOf(other, 11);
  reused.fit(
      flow.from, flow.to, [](std::size_t) { return true; }, kReach);
  const LocalMotion fresh = flow.fitted();
  EXPECT_EQ(reused.at({320, 240}).pixel, fresh.at({320, 240}).pixel);
  EXPECT_EQ(reused.scatter(), fresh.scatter());
}

}  // namespace
}  // namespace camera_self_calibration
