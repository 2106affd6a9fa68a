#include "camera_self_calibration/ros/size_memory.h"

#include <gtest/gtest.h>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/ros/camera_info.h"

namespace camera_self_calibration {
namespace {

const Camera kLens = camera640(CameraModel::kFov, {311, 310, 327, 233, 0.93});

CalibrationReport converged(const Camera& camera, std::uint64_t epoch = 0) {
  CalibrationReport report;
  report.camera = camera;
  report.state = CalibrationState::kConverged;
  report.epoch = epoch;
  return report;
}

sensor_msgs::CameraInfo infoWith(std::uint32_t binning, std::uint32_t x_offset = 0) {
  sensor_msgs::CameraInfo info = toCameraInfo(kLens)->info;
  info.binning_x = info.binning_y = binning;
  info.roi.x_offset = x_offset;
  info.roi.width = 600;
  info.roi.height = 480;
  return info;
}

// What is learnt in whole images, before the driver bins them.
class BinnedSizes : public testing::Test {
 protected:
  BinnedSizes() {
    factory.take(toCameraInfo(kLens)->info);
    EXPECT_FALSE(memory.windowMoved(640, 480));
    memory.update(converged(kLens));
  }
  void bin() {
    sensor_msgs::CameraInfo binned = toCameraInfo(kLens)->info;
    binned.binning_x = binned.binning_y = 2;
    factory.take(binned);
  }

  FactoryCalibration factory{"info", 1.0};
  SizeMemory memory{&factory};
};

TEST_F(BinnedSizes, AreRescaledByTheDriversBinning) {
  bin();
  const auto known = memory.begin(320, 240);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->camera.width(), 320);
  EXPECT_NEAR(known->camera.parameters()[0], 155.5, 1e-9);
  EXPECT_NEAR(known->camera.parameters()[2], (327.0 + 0.5) / 2.0 - 0.5, 1e-9);
  EXPECT_EQ(known->camera.parameters()[4], 0.93);
}

TEST(SizeMemory, WithoutTheDriverOnlyASizeSeenBeforeIsKnown) {
  SizeMemory memory(nullptr);
  EXPECT_FALSE(memory.windowMoved(640, 480));
  memory.update(converged(kLens));
  EXPECT_FALSE(memory.begin(320, 240)) << "a crop or binning: nobody knows";
  memory.update(converged(Camera::defaultGuess(CameraModel::kFov, 320, 240), 1));
  const auto known = memory.begin(640, 480);
  ASSERT_TRUE(known);
  EXPECT_EQ(known->camera.parameters(), kLens.parameters());
}

TEST(SizeMemory, AChangeOfTheLensForgetsTheOtherSizes) {
  SizeMemory memory(nullptr);
  memory.update(converged(kLens));
  memory.begin(320, 240);
  const Camera small = Camera::defaultGuess(CameraModel::kFov, 320, 240);
  memory.update(converged(small, 1));
  memory.update(converged(small, 2));
  EXPECT_FALSE(memory.begin(640, 480));
}

// A lens that was exchanged before a reset is not that of the other sizes either.
TEST_F(BinnedSizes, WhatIsForgottenDoesNotComeBackWithALateReport) {
  memory.forget();
  memory.update(converged(kLens));  // from before the reset
  bin();
  EXPECT_FALSE(memory.begin(320, 240)) << "rescaled";
  EXPECT_FALSE(memory.begin(640, 480)) << "seen before";
}

TEST(SizeMemory, LearnsAgainWhatBeginsAfterItForgot) {
  SizeMemory memory(nullptr);
  memory.forget();
  CalibrationReport begun = converged(kLens);
  begun.state = CalibrationState::kInitializing;
  memory.update(begun);
  memory.update(converged(kLens));
  EXPECT_TRUE(memory.begin(640, 480));
}

TEST(SizeMemory, ARegionThatMovesIsNoticed) {
  FactoryCalibration factory("info", 1.0);
  SizeMemory memory(&factory);
  factory.take(infoWith(1));
  EXPECT_FALSE(memory.windowMoved(600, 480));
  const Camera lens(CameraModel::kFov, 600, 480, kLens.parameters());
  memory.update(converged(lens));
  factory.take(infoWith(1, 40));
  int images = 1;
  while (!memory.windowMoved(600, 480) && images < 100) ++images;
  EXPECT_GT(images, 1) << "messages of two topics may overtake each other";
  EXPECT_LT(images, 20);
  const auto known = memory.begin(600, 480);
  ASSERT_TRUE(known);
  EXPECT_NEAR(known->camera.parameters()[2], 327.0 - 40.0, 1e-9);
  EXPECT_FALSE(memory.windowMoved(600, 480));
}

}  // namespace
}  // namespace camera_self_calibration
