#include "camera_self_calibration/ros/camera_info_policy.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

CalibrationReport report(CalibrationState state, double focal_length) {
  CalibrationReport result;
  result.state = state;
  Intrinsics values(4);
  values << focal_length, focal_length, 319.5, 239.5;
  result.camera = Camera(CameraModel::kPinhole, 640, 480, values);
  return result;
}

double publishedFocalLength(const CameraInfoPolicy& policy) {
  return policy.infoFor(std_msgs::Header(), 640, 480).K[0];
}

TEST(CameraInfoPolicy, ZerosUntilConverged) {
  CameraInfoPolicy policy(0.1);
  EXPECT_EQ(publishedFocalLength(policy), 0.0);
  for (const CalibrationState state :
       {CalibrationState::kWaitingForMotion, CalibrationState::kInitializing,
        CalibrationState::kConverging, CalibrationState::kDegenerate}) {
    policy.update(report(state, 500.0));
    EXPECT_EQ(publishedFocalLength(policy), 0.0);
    EXPECT_FALSE(policy.conversionError());
  }
  policy.update(report(CalibrationState::kConverged, 500.0));
  EXPECT_EQ(publishedFocalLength(policy), 500.0);
  EXPECT_TRUE(policy.conversionError());
}

TEST(CameraInfoPolicy, SmallChangesDoNotGoOutUntilTheyAddUp) {
  CameraInfoPolicy policy(0.5);
  policy.update(report(CalibrationState::kConverged, 500.0));
  policy.update(report(CalibrationState::kConverged, 500.5));
  EXPECT_EQ(publishedFocalLength(policy), 500.0);
  for (double f = 500.5; f < 510.0; f += 0.5) {
    policy.update(report(CalibrationState::kConverged, f));
  }
  EXPECT_GT(publishedFocalLength(policy), 505.0);
}

TEST(CameraInfoPolicy, AChangeOfTheCameraWithdrawsIt) {
  CameraInfoPolicy policy(100.0);
  policy.update(report(CalibrationState::kConverged, 500.0));
  policy.update(report(CalibrationState::kInitializing, 500.0));
  EXPECT_EQ(publishedFocalLength(policy), 0.0);
  policy.update(report(CalibrationState::kConverged, 501.0));
  EXPECT_EQ(publishedFocalLength(policy), 501.0) << "the deadband ends with the old calibration";
}

TEST(CameraInfoPolicy, CarriesTheHeaderAndOnlyItsOwnSize) {
  CameraInfoPolicy policy(0.1);
  policy.update(report(CalibrationState::kConverged, 500.0));
  std_msgs::Header header;
  header.stamp = ros::Time(12, 34);
  header.frame_id = "camera_optical";
  const sensor_msgs::CameraInfo info = policy.infoFor(header, 640, 480);
  EXPECT_EQ(info.header.stamp, header.stamp);
  EXPECT_EQ(info.header.frame_id, header.frame_id);
  const sensor_msgs::CameraInfo other = policy.infoFor(header, 320, 240);
  EXPECT_EQ(other.K[0], 0.0);
  EXPECT_EQ(other.width, 320u);
}

}  // namespace
}  // namespace camera_self_calibration
