#include "camera_self_calibration/lens_change/setting_archive.h"

#include <gtest/gtest.h>

#include "lens_change/change_samples.h"

namespace camera_self_calibration {
namespace {

IntrinsicsMatrix informationOf(const Camera& lens) {
  IntrinsicsMatrix information =
      IntrinsicsMatrix::Identity(lens.estimatedCount(), lens.estimatedCount());
  information.topLeftCorner(4, 4) *= 1.0 / (0.1 * 0.1);
  for (int i = 4; i < information.rows(); ++i) information(i, i) = 1e8;
  return information;
}

Setting settingOf(const Camera& lens, std::uint64_t epoch) {
  Setting setting{epoch, SegmentQueue(10, 0.95), QueueEstimate(1), QueueSolution()};
  setting.solution.usable = true;
  setting.solution.camera = lens;
  setting.solution.information = informationOf(lens);
  return setting;
}

TEST(SettingArchive, RecallsTheSettingThatReturned) {
  const Camera lens = ordinaryCameras()[1];
  SettingArchive archive;
  archive.store(settingOf(lens, 3));
  archive.store(settingOf(zoomed(lens, 1.1), 4));
  Camera near = lens;
  Intrinsics parameters = lens.parameters();
  parameters(0) += 0.15;  // a sigma of the difference
  near.setParameters(parameters);
  const auto found = archive.recall(near, informationOf(lens), 1.0);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->epoch, 3u);
  EXPECT_FALSE(archive.recall(near, informationOf(lens), 1.0)) << "taken out";
}

TEST(SettingArchive, NeverTakesAnotherSettingForIt) {
  const Camera lens = ordinaryCameras()[1];
  SettingArchive archive;
  archive.store(settingOf(lens, 3));
  // Near over the image, but many sigmas away; and far, but not known to be.
  EXPECT_FALSE(archive.recall(zoomed(lens, 1.004), informationOf(lens), 1.0));
  EXPECT_FALSE(archive.recall(zoomed(lens, 1.05), 1e-6 * informationOf(lens), 1.0));
}

TEST(SettingArchive, StaysBounded) {
  const Camera lens = ordinaryCameras()[1];
  SettingArchive archive;
  for (std::uint64_t epoch = 0; epoch < 1000; ++epoch) {
    archive.store(settingOf(zoomed(lens, 1.0 + 0.01 * static_cast<double>(epoch % 20)), epoch));
  }
  int kept = 0;
  for (int i = 0; i < 20; ++i) {
    kept += archive.recall(zoomed(lens, 1.0 + 0.01 * i), informationOf(lens), 0.5).has_value();
  }
  EXPECT_EQ(kept, 4);
  Setting unusable = settingOf(lens, 1);
  unusable.solution.usable = false;
  archive.store(unusable);
  EXPECT_FALSE(archive.recall(lens, informationOf(lens), 0.5));
}

}  // namespace
}  // namespace camera_self_calibration
