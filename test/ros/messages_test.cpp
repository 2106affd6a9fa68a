#include "camera_self_calibration/ros/messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/ros/stamps.h"

namespace camera_self_calibration {
namespace {

TEST(Stamps, RoundTripIsExact) {
  const std::int64_t stamp_ns = 1700000000123456789;
  EXPECT_EQ(toNanoseconds(toRosTime(stamp_ns)), stamp_ns);
  EXPECT_TRUE(toRosTime(-5).isZero());
}

TEST(Messages, RotationCovarianceIsAboutWorldAxes) {
  FrameResult result;
  // The camera's x axis points along the world's y axis.
  result.world_from_camera.rotation = expSo3(Eigen::Vector3d(0.0, 0.0, M_PI / 2.0));
  result.pose_covariance.diagonal() << 1.0, 2.0, 3.0, 0.1, 0.2, 0.3;
  const geometry_msgs::PoseWithCovariance message = toPoseWithCovariance(result);
  const auto at = [&](int row, int column) {
    return message.covariance[static_cast<std::size_t>(6 * row + column)];
  };
  EXPECT_NEAR(at(0, 0), 1.0, 1e-12);
  EXPECT_NEAR(at(1, 1), 2.0, 1e-12);
  EXPECT_NEAR(at(3, 3), 0.2, 1e-12);
  EXPECT_NEAR(at(4, 4), 0.1, 1e-12);
  EXPECT_NEAR(at(5, 5), 0.3, 1e-12);
  EXPECT_NEAR(at(3, 4), 0.0, 1e-12);
}

TEST(Messages, TwistReproducesTheMotion) {
  FrameResult before;
  before.stamp_ns = 1000000000;
  before.world_from_camera = {expSo3(Eigen::Vector3d(0.3, -0.2, 0.9)), {1.0, 2.0, 3.0}};
  Vector6d velocity;
  velocity << 0.5, -0.1, 0.2, 0.04, 0.3, -0.2;
  FrameResult now = before;
  now.stamp_ns += 50000000;
  now.world_from_camera = before.world_from_camera * expSe3(0.05 * velocity);
  const geometry_msgs::Twist twist = toTwist(before, now).twist;
  EXPECT_NEAR(twist.linear.x, velocity[0], 1e-9);
  EXPECT_NEAR(twist.linear.y, velocity[1], 1e-9);
  EXPECT_NEAR(twist.linear.z, velocity[2], 1e-9);
  EXPECT_NEAR(twist.angular.x, velocity[3], 1e-9);
  EXPECT_NEAR(twist.angular.y, velocity[4], 1e-9);
  EXPECT_NEAR(twist.angular.z, velocity[5], 1e-9);
}

TEST(Messages, TwistCovarianceGrowsWithTheFrameRate) {
  FrameResult before;
  before.pose_covariance = 0.01 * Matrix6d::Identity();
  FrameResult now = before;
  now.stamp_ns = 100000000;
  const auto twist = toTwist(before, now);
  EXPECT_NEAR(twist.covariance[0], 0.02 / 0.01, 1e-9);
  EXPECT_NEAR(twist.covariance[35], 0.02 / 0.01, 1e-9);
}

TEST(Messages, CalibrationHasASigmaForEachValue) {
  CalibrationReport report;
  Intrinsics values(9);
  values << 421, 422, 354, 252, -0.33, 0.16, 0.001, -0.002, -0.05;
  report.camera = Camera(CameraModel::kRadtan, 752, 480, values);
  report.lens_fit = {true, "pinhole", true, "radtan", {5.0, 12.0}, {4.0, 9.0}, 0.0};
  report.cross_validation = {true, 0.4, 0.5, 0.3};
  report.observed = {0.8, {0.2, 0.3}, "no feature reached the upper left corner", nullptr};
  Calibration message = toCalibration(report, TrackingState::kTracking, "Follows.");
  EXPECT_EQ(message.lens_fit,
            "pinhole misses the lens by 5.0 px rms, 12.0 px at worst (which the uncertainty "
            "includes), but radtan fits it");
  EXPECT_EQ(message.better_model, "radtan");
  EXPECT_EQ(message.misfit_rms, 5.0);
  EXPECT_EQ(message.misfit_max, 12.0);
  EXPECT_EQ(message.cross_difference, 0.4);
  EXPECT_EQ(message.cross_expected, 0.5);
  EXPECT_EQ(message.cross_p_value, 0.3);
  EXPECT_EQ(message.observed_share, 0.8);
  EXPECT_EQ(message.pixel_uncertainty_observed, 0.2);
  EXPECT_EQ(message.unseen_corners, "no feature reached the upper left corner");
  EXPECT_EQ(message.tracking_state, "TRACKING");
  EXPECT_EQ(message.calibration_state, Calibration::WAITING_FOR_MOTION);
  ASSERT_EQ(message.sigma.size(), 9u);
  EXPECT_TRUE(std::isnan(message.sigma[0]));
  EXPECT_TRUE(message.covariance.empty());

  report.covariance = 0.25 * IntrinsicsMatrix::Identity(8, 8);
  message = toCalibration(report, TrackingState::kLost, "Lost.");
  EXPECT_EQ(message.parameter_names.size(), message.values.size());
  EXPECT_EQ(message.sigma[7], 0.5);
  EXPECT_EQ(message.sigma[8], 0.0) << "k3 is held";
  EXPECT_EQ(message.covariance.size(), 64u);
}

TEST(Messages, QueueAndEvent) {
  QueueReport report;
  report.segments = {{7, 1000000000, 2500000000, -12.5, 10, 90, 700}};
  report.swaps = 3;
  report.last_accepted = true;
  report.last_decision = "taken";
  const Queue queue = toQueue(report);
  ASSERT_EQ(queue.segments.size(), 1u);
  EXPECT_EQ(queue.segments[0].sequence, 7);
  EXPECT_EQ(queue.segments[0].end, ros::Time(2, 500000000));
  EXPECT_EQ(queue.segments[0].observations, 700u);
  EXPECT_EQ(queue.swaps, 3u);
  EXPECT_TRUE(queue.last_accepted);

  const Event event{EventType::kHandover, 5000000000, 4000000000, "Over.", 2, 7.5, 1e-9};
  const CalibrationEvent message = toCalibrationEvent(event, 2);
  EXPECT_EQ(message.type, CalibrationEvent::HANDOVER);
  EXPECT_EQ(message.stamp, ros::Time(5, 0));
  EXPECT_EQ(message.onset_stamp, ros::Time(4, 0));
  EXPECT_EQ(message.epoch, 2u);
  EXPECT_EQ(message.magnitude_px, 7.5);
  EXPECT_EQ(message.p_value, 1e-9);
}

TEST(Messages, ACalibrationThatIsNoLongerGood) {
  const Event event{EventType::kNoLongerConverged, 6000000000, 6000000000, "Only to 1.6 px.", 3};
  const CalibrationEvent message = toCalibrationEvent(event, 3);
  EXPECT_EQ(message.type, CalibrationEvent::NO_LONGER_CONVERGED);
  EXPECT_EQ(message.sentence, "Only to 1.6 px.");
  EXPECT_EQ(message.epoch, 3u);
}

TEST(Messages, AMountThatChanged) {
  Event event;
  event.type = EventType::kMountChanged;
  event.stamp_ns = 14'000'000'000;
  event.onset_stamp_ns = 12'300'000'000;
  event.epoch = 1;
  event.p_value = 1e-12;
  event.rotation = 0.52 * kDegree;
  event.rotation_sigma = 0.04 * kDegree;
  const CalibrationEvent message = toCalibrationEvent(event, event.epoch);
  EXPECT_EQ(message.type, CalibrationEvent::MOUNT_CHANGED);
  EXPECT_EQ(message.onset_stamp, ros::Time(12, 300000000));
  EXPECT_NEAR(message.rotation_deg, 0.52, 1e-12);
  EXPECT_NEAR(message.rotation_sigma_deg, 0.04, 1e-12);
  EXPECT_EQ(message.p_value, 1e-12);
  EXPECT_EQ(message.magnitude_px, 0.0);
}

}  // namespace
}  // namespace camera_self_calibration
