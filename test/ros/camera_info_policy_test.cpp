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

CameraInfoOptions deadband(double px) {
  CameraInfoOptions options;
  options.min_change_px = px;
  return options;
}

double publishedFocalLength(const CameraInfoPolicy& policy) {
  return policy.infoFor(std_msgs::Header(), 640, 480).K[0];
}

TEST(CameraInfoPolicy, ZerosUntilConverged) {
  CameraInfoPolicy policy{CameraInfoOptions()};
  EXPECT_EQ(publishedFocalLength(policy), 0.0);
  for (const CalibrationState state :
       {CalibrationState::kWaitingForMotion, CalibrationState::kInitializing,
        CalibrationState::kConverging, CalibrationState::kDegenerate}) {
    policy.update(report(state, 500.0));
    EXPECT_EQ(publishedFocalLength(policy), 0.0);
    EXPECT_EQ(policy.state().distortion_model, "");
  }
  policy.update(report(CalibrationState::kConverged, 500.0));
  EXPECT_EQ(publishedFocalLength(policy), 500.0);
  EXPECT_EQ(policy.state().distortion_model, "plumb_bob");
}

TEST(CameraInfoPolicy, SmallChangesDoNotGoOutUntilTheyAddUp) {
  CameraInfoPolicy policy(deadband(0.5));
  policy.update(report(CalibrationState::kConverged, 500.0));
  policy.update(report(CalibrationState::kConverged, 500.5));
  EXPECT_EQ(publishedFocalLength(policy), 500.0);
  for (double f = 500.5; f < 510.0; f += 0.5) {
    policy.update(report(CalibrationState::kConverged, f));
  }
  EXPECT_GT(publishedFocalLength(policy), 505.0);
}

TEST(CameraInfoPolicy, AChangeOfTheCameraWithdrawsIt) {
  CameraInfoPolicy policy(deadband(100.0));
  policy.update(report(CalibrationState::kConverged, 500.0));
  policy.update(report(CalibrationState::kInitializing, 500.0));
  EXPECT_EQ(publishedFocalLength(policy), 0.0);
  policy.update(report(CalibrationState::kConverged, 501.0));
  EXPECT_EQ(publishedFocalLength(policy), 501.0) << "the deadband ends with the old calibration";
}

TEST(CameraInfoPolicy, TheLastGoodOneStaysUntilTheLensChanges) {
  CameraInfoPolicy policy{CameraInfoOptions()};
  CalibrationReport now = report(CalibrationState::kConverged, 500.0);
  now.handed_over = true;
  now.epoch = 3;
  policy.update(now);
  EXPECT_FALSE(policy.state().last_good);
  CalibrationReport worse = report(CalibrationState::kConverging, 505.0);
  worse.handed_over = true;
  worse.epoch = 3;
  policy.update(worse);
  EXPECT_EQ(publishedFocalLength(policy), 500.0);
  EXPECT_TRUE(policy.state().last_good);
  now.camera = worse.camera;
  policy.update(now);
  EXPECT_EQ(publishedFocalLength(policy), 505.0);
  EXPECT_FALSE(policy.state().last_good);
  worse.epoch = 4;
  policy.update(worse);
  EXPECT_EQ(publishedFocalLength(policy), 0.0);
  EXPECT_FALSE(policy.state().last_good);
}

TEST(CameraInfoPolicy, CarriesTheHeaderAndOnlyItsOwnSize) {
  CameraInfoPolicy policy{CameraInfoOptions()};
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

TEST(CameraInfoPolicy, EstimatesBeforeConvergedGoOutOnlyWhereAskedFor) {
  CameraInfoOptions options;
  options.publish_uncalibrated = true;
  CameraInfoPolicy policy(options);
  CalibrationReport estimate = report(CalibrationState::kConverging, 500.0);
  policy.update(estimate);
  EXPECT_EQ(publishedFocalLength(policy), 0.0) << "there is no estimate yet";
  estimate.covariance = IntrinsicsMatrix::Identity(4, 4);
  estimate.uncertainty = {3.0, 5.0};
  policy.update(estimate);
  EXPECT_EQ(publishedFocalLength(policy), 500.0);
  estimate.state = CalibrationState::kDegenerate;
  policy.update(estimate);
  EXPECT_EQ(publishedFocalLength(policy), 0.0);
}

TEST(CameraInfoPolicy, AFixedProjectionKeepsThatOfTheFirstConvergedCalibration) {
  CameraInfoOptions options;
  options.fixed_projection = true;
  options.publish_uncalibrated = true;
  CameraInfoPolicy policy(options);
  CalibrationReport provisional = report(CalibrationState::kConverging, 300.0);
  provisional.covariance = IntrinsicsMatrix::Identity(4, 4);
  provisional.uncertainty = {3.0, 5.0};
  policy.update(provisional);
  EXPECT_EQ(policy.infoFor(std_msgs::Header(), 640, 480).P[0], 300.0);
  policy.update(report(CalibrationState::kConverged, 500.0));
  policy.update(report(CalibrationState::kConverged, 510.0));
  const sensor_msgs::CameraInfo info = policy.infoFor(std_msgs::Header(), 640, 480);
  EXPECT_EQ(info.K[0], 510.0);
  EXPECT_EQ(info.P[0], 500.0);
  EXPECT_EQ(info.P[5], 500.0);
}

TEST(CameraInfoPolicy, WarnsOfAConversionThatErrs) {
  Intrinsics values(5);
  values << 400.0, 400.0, 319.5, 239.5, 0.9;
  CalibrationReport wide = report(CalibrationState::kConverged, 500.0);
  wide.camera = Camera(CameraModel::kFov, 640, 480, values);
  CameraInfoOptions options;
  EXPECT_EQ(CameraInfoPolicy(options).update(wide), "") << "equidistant is close enough";
  options.model = OutputModel::kPlumbBob;
  CameraInfoPolicy policy(options);
  EXPECT_NE(policy.update(wide).find("px"), std::string::npos);
  EXPECT_EQ(policy.state().distortion_model, "plumb_bob");
  EXPECT_GT(policy.state().error.max, CameraInfoPolicy::kConversionWarning);
  EXPECT_NE(policy.state().deviation.find("set the parameter output_distortion_model to auto."),
            std::string::npos)
      << policy.state().deviation;
}

// The node for rigs has no output_distortion_model, which is auto there.
TEST(CameraInfoPolicy, WithAutoTheWarningNamesWhatEveryNodeHas) {
  Intrinsics values(5);
  values << 420.0, 420.0, 319.5, 239.5, 1.5;
  CalibrationReport wide = report(CalibrationState::kConverged, 500.0);
  wide.camera = Camera(CameraModel::kFov, 640, 480, values);
  CameraInfoPolicy policy{CameraInfoOptions()};
  const std::string warning = policy.update(wide);
  EXPECT_NE(warning.find("set the parameter model to equidistant."), std::string::npos) << warning;
  EXPECT_EQ(warning.find("output_distortion_model"), std::string::npos) << warning;
  EXPECT_EQ(policy.state().deviation, warning);
  policy.update(report(CalibrationState::kConverged, 500.0));
  EXPECT_EQ(policy.state().deviation, "") << "a pinhole is exact";
}

TEST(CameraInfoPolicy, ZerosWhereTheDistortionModelCannotHoldTheLens) {
  Intrinsics values(8);
  values << 190.0, 190.0, 319.5, 239.5, 0.0, 0.0, 0.0, 0.0;
  CalibrationReport fisheye = report(CalibrationState::kConverged, 500.0);
  fisheye.camera = Camera(CameraModel::kEquidistant, 640, 480, values);
  CameraInfoOptions options;
  options.model = OutputModel::kRationalPolynomial;
  CameraInfoPolicy policy(options);
  EXPECT_NE(policy.update(fisheye).find("output_distortion_model"), std::string::npos);
  EXPECT_EQ(publishedFocalLength(policy), 0.0);
  EXPECT_FALSE(policy.state().obstacle.empty());
}

TEST(CameraInfoPolicy, AnInheritedCalibrationHoldsUntilThereIsAnEstimateOrAChange) {
  CameraInfoPolicy policy{CameraInfoOptions()};
  const Camera known = report(CalibrationState::kConverged, 500.0).camera;
  policy.inherit(known);
  EXPECT_TRUE(policy.state().inherited);
  policy.update(report(CalibrationState::kInitializing, 400.0));
  EXPECT_EQ(publishedFocalLength(policy), 500.0);
  policy.update(report(CalibrationState::kConverged, 502.0));
  EXPECT_EQ(publishedFocalLength(policy), 502.0);
  EXPECT_FALSE(policy.state().inherited);

  policy.inherit(known);
  policy.update(report(CalibrationState::kInitializing, 400.0));
  CalibrationReport changed = report(CalibrationState::kInitializing, 400.0);
  changed.epoch = 1;
  policy.update(changed);
  EXPECT_EQ(publishedFocalLength(policy), 0.0) << "another lens";
}

TEST(CameraInfoPolicy, WhatIsGivenIsValidAtOnceAndJudgedByTheImages) {
  CameraInfoPolicy policy{CameraInfoOptions()};
  policy.update(report(CalibrationState::kConverged, 400.0));
  const Camera given = report(CalibrationState::kConverged, 500.0).camera;
  sensor_msgs::CameraInfo message = toCameraInfo(given)->info;
  message.P[3] = -50.0;  // of a stereo pair
  policy.accept(given, message);
  EXPECT_EQ(publishedFocalLength(policy), 500.0);
  EXPECT_EQ(policy.infoFor(std_msgs::Header(), 640, 480).P[3], -50.0) << "as it is";
  EXPECT_TRUE(policy.state().given);
  // The last report from before the reset, and the first ones after it.
  policy.update(report(CalibrationState::kConverged, 400.0));
  EXPECT_EQ(publishedFocalLength(policy), 500.0);
  policy.update(report(CalibrationState::kInitializing, 500.0));
  EXPECT_EQ(publishedFocalLength(policy), 500.0);
  CalibrationReport estimate = report(CalibrationState::kConverged, 505.0);
  estimate.uncertainty = {0.1, 0.2};
  EXPECT_NE(policy.update(estimate).find("off by"), std::string::npos);
  EXPECT_EQ(publishedFocalLength(policy), 505.0);
  EXPECT_FALSE(policy.state().given);

  policy.accept(given, message);
  policy.forget();
  policy.update(report(CalibrationState::kInitializing, 500.0));
  EXPECT_EQ(publishedFocalLength(policy), 0.0) << "a reset ends it";
}

/// Of a calibrator that began again from a guess, since maps were lost with `start`.
CalibrationReport givenUp(const Camera& start, std::uint64_t count) {
  CalibrationReport result = report(CalibrationState::kInitializing, 400.0);
  result.starts_given_up = count;
  result.start_given_up = start;
  return result;
}

TEST(CameraInfoPolicy, AGivenCalibrationThatTheCalibratorGaveUpGoesOutNoMore) {
  CameraInfoPolicy policy{CameraInfoOptions()};
  const Camera given = report(CalibrationState::kConverged, 500.0).camera;
  policy.accept(given, toCameraInfo(given)->info);
  policy.update(report(CalibrationState::kInitializing, 500.0));
  ASSERT_EQ(publishedFocalLength(policy), 500.0);
  const std::string warning = policy.update(givenUp(given, 1));
  EXPECT_EQ(publishedFocalLength(policy), 0.0);
  EXPECT_FALSE(policy.state().given);
  EXPECT_NE(warning.find("set_camera_info"), std::string::npos) << warning;
  EXPECT_NE(warning.find("no longer published"), std::string::npos) << warning;
  EXPECT_EQ(policy.update(givenUp(given, 1)), "") << "said once";

  policy.accept(given, toCameraInfo(given)->info);
  EXPECT_EQ(policy.update(givenUp(given, 1)), "") << "given again, it is tried again";
  EXPECT_EQ(publishedFocalLength(policy), 500.0);
  EXPECT_NE(policy.update(givenUp(given, 2)), "");
  EXPECT_EQ(publishedFocalLength(policy), 0.0);
}

TEST(CameraInfoPolicy, ACalibrationOfEarlierImagesThatWasGivenUpGoesOutNoMore) {
  CameraInfoPolicy policy{CameraInfoOptions()};
  const Camera known = report(CalibrationState::kConverged, 500.0).camera;
  policy.inherit(known);
  ASSERT_EQ(publishedFocalLength(policy), 500.0);
  const std::string warning = policy.update(givenUp(known, 1));
  EXPECT_NE(warning.find("earlier images"), std::string::npos) << warning;
  EXPECT_EQ(publishedFocalLength(policy), 0.0);
  EXPECT_FALSE(policy.state().inherited);
}

// It may come while the calibrator still is at the start before.
TEST(CameraInfoPolicy, AnotherStartThatWasGivenUpSaysNothingOfTheGivenOne) {
  CameraInfoPolicy policy{CameraInfoOptions()};
  const Camera given = report(CalibrationState::kConverged, 500.0).camera;
  policy.accept(given, toCameraInfo(given)->info);
  EXPECT_EQ(policy.update(givenUp(report(CalibrationState::kConverged, 90.0).camera, 1)), "");
  EXPECT_EQ(publishedFocalLength(policy), 500.0);
  EXPECT_TRUE(policy.state().given);
}

TEST(CameraInfoPolicy, AFixedProjectionIsNotThatOfARefutedCalibration) {
  CameraInfoOptions options;
  options.fixed_projection = true;
  CameraInfoPolicy policy(options);
  const Camera given = report(CalibrationState::kConverged, 500.0).camera;
  policy.accept(given, toCameraInfo(given)->info);
  policy.update(givenUp(given, 1));
  CalibrationReport own = report(CalibrationState::kConverged, 300.0);
  own.starts_given_up = 1;
  own.start_given_up = given;
  policy.update(own);
  EXPECT_EQ(policy.infoFor(std_msgs::Header(), 640, 480).P[0], 300.0);
}

TEST(CameraInfoPolicy, AnEventThatConvergedIsLeftSaysWhatGoesOut) {
  CameraInfoPolicy policy{CameraInfoOptions()};
  CalibrationReport now = report(CalibrationState::kConverged, 500.0);
  now.handed_over = true;
  policy.update(now);
  Event left{EventType::kNoLongerConverged, 1, 1, "it is good to 1.6 px"};
  EXPECT_EQ(withCameraInfo(left, policy.state()).sentence, left.sentence) << "nothing was kept";
  now.state = CalibrationState::kConverging;
  policy.update(now);
  EXPECT_EQ(withCameraInfo(left, policy.state()).sentence,
            "it is good to 1.6 px; camera_info goes on with the last good calibration");
  const Event other{EventType::kLost, 1, 1, "lost"};
  EXPECT_EQ(withCameraInfo(other, policy.state()).sentence, "lost");
}

}  // namespace
}  // namespace camera_self_calibration
