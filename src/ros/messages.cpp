#include "camera_self_calibration/ros/messages.h"

#include <cmath>
#include <limits>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/ros/stamps.h"

namespace camera_self_calibration {
namespace {

using RowMajor6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

Matrix6d blockDiagonal(const Eigen::Matrix3d& upper, const Eigen::Matrix3d& lower) {
  Matrix6d matrix = Matrix6d::Zero();
  matrix.topLeftCorner<3, 3>() = upper;
  matrix.bottomRightCorner<3, 3>() = lower;
  return matrix;
}

/// World axes for the rotation too, which the pipeline gives in those of the camera.
Matrix6d worldCovariance(const FrameResult& result) {
  const Matrix6d to_world = blockDiagonal(Eigen::Matrix3d::Identity(),
                                          result.world_from_camera.rotation.toRotationMatrix());
  return to_world * result.pose_covariance * to_world.transpose();
}

void setCovariance(const Matrix6d& covariance, boost::array<double, 36>* values) {
  Eigen::Map<RowMajor6d>(values->data()) = covariance;
}

SegmentStatus toSegmentStatus(const SegmentReport& segment) {
  SegmentStatus message;
  message.sequence = segment.sequence;
  message.begin = toRosTime(segment.begin_ns);
  message.end = toRosTime(segment.end_ns);
  message.entropy = segment.entropy;
  message.keyframes = static_cast<std::uint32_t>(segment.keyframes);
  message.landmarks = static_cast<std::uint32_t>(segment.landmarks);
  message.observations = static_cast<std::uint32_t>(segment.observations);
  return message;
}

}  // namespace

std::vector<double> parameterSigmas(const CalibrationReport& report) {
  const Eigen::Index estimated = report.covariance.rows();
  std::vector<double> values(static_cast<std::size_t>(report.camera.parameterCount()),
                             estimated == 0 ? std::numeric_limits<double>::quiet_NaN() : 0.0);
  for (Eigen::Index i = 0; i < estimated; ++i) {
    values[static_cast<std::size_t>(i)] = std::sqrt(report.covariance(i, i));
  }
  return values;
}

geometry_msgs::Pose toPose(const Rigid3& pose) {
  geometry_msgs::Pose message;
  message.position.x = pose.translation.x();
  message.position.y = pose.translation.y();
  message.position.z = pose.translation.z();
  message.orientation.x = pose.rotation.x();
  message.orientation.y = pose.rotation.y();
  message.orientation.z = pose.rotation.z();
  message.orientation.w = pose.rotation.w();
  return message;
}

geometry_msgs::Transform toTransform(const Rigid3& pose) {
  const geometry_msgs::Pose message = toPose(pose);
  geometry_msgs::Transform transform;
  transform.translation.x = message.position.x;
  transform.translation.y = message.position.y;
  transform.translation.z = message.position.z;
  transform.rotation = message.orientation;
  return transform;
}

geometry_msgs::PoseWithCovariance toPoseWithCovariance(const Rigid3& pose,
                                                       const Eigen::Matrix3d& position,
                                                       const Eigen::Matrix3d& rotation) {
  geometry_msgs::PoseWithCovariance message;
  message.pose = toPose(pose);
  setCovariance(blockDiagonal(position, rotation), &message.covariance);
  return message;
}

geometry_msgs::PoseWithCovariance toPoseWithCovariance(const FrameResult& result) {
  geometry_msgs::PoseWithCovariance message;
  message.pose = toPose(result.world_from_camera);
  setCovariance(worldCovariance(result), &message.covariance);
  return message;
}

geometry_msgs::TwistWithCovariance toTwist(const FrameResult& before, const FrameResult& now) {
  const double seconds = toSeconds(now.stamp_ns - before.stamp_ns);
  const Rigid3 now_from_before = now.world_from_camera.inverse() * before.world_from_camera;
  const Vector6d velocity = -logSe3(now_from_before) / seconds;
  const Eigen::Matrix3d camera_from_world =
      now.world_from_camera.rotation.conjugate().toRotationMatrix();
  const Matrix6d to_camera = blockDiagonal(camera_from_world, camera_from_world);
  const Matrix6d difference = worldCovariance(before) + worldCovariance(now);
  geometry_msgs::TwistWithCovariance message;
  message.twist.linear.x = velocity[0];
  message.twist.linear.y = velocity[1];
  message.twist.linear.z = velocity[2];
  message.twist.angular.x = velocity[3];
  message.twist.angular.y = velocity[4];
  message.twist.angular.z = velocity[5];
  setCovariance(to_camera * difference * to_camera.transpose() / (seconds * seconds),
                &message.covariance);
  return message;
}

TrackingStatus toTrackingStatus(const FrameResult& result, std::int64_t dropped_images) {
  TrackingStatus message;
  message.state = toString(result.state);
  message.sentence = result.sentence;
  message.map_id = result.map_id;
  message.is_keyframe = result.is_keyframe;
  message.tracks = static_cast<std::uint32_t>(result.tracks.tracks.size());
  message.calibration_revision = result.calibration_revision;
  message.processing_seconds = result.processing_seconds;
  message.dropped_images = static_cast<std::uint64_t>(dropped_images);
  return message;
}

Calibration toCalibration(const CalibrationReport& report, TrackingState tracking_state,
                          const std::string& tracking_sentence) {
  Calibration message;
  message.calibration_state = toString(report.state);
  message.calibration_sentence = report.sentence;
  message.hint = report.hint;
  message.tracking_state = toString(tracking_state);
  message.tracking_sentence = tracking_sentence;
  const Camera& camera = report.camera;
  message.model = toString(camera.model());
  message.width = static_cast<std::uint32_t>(camera.width());
  message.height = static_cast<std::uint32_t>(camera.height());
  message.parameter_names = camera.parameterNames();
  const Intrinsics& values = camera.parameters();
  message.values.assign(values.data(), values.data() + values.size());
  message.sigma = parameterSigmas(report);
  // Symmetric, so that the order of rows and columns does not matter.
  const double* covariance = report.covariance.data();
  message.covariance.assign(covariance, covariance + report.covariance.size());
  message.pixel_uncertainty_rms = report.uncertainty.rms;
  message.pixel_uncertainty_max = report.uncertainty.max;
  message.pixel_uncertainty_observed = report.observed.uncertainty.rms;
  message.observed_share = report.observed.share;
  message.unseen_corners = report.observed.unseen_corners;
  const CrossValidation& halves = report.cross_validation;
  message.cross_difference = halves.compared ? halves.difference_px : std::nan("");
  message.cross_expected = halves.compared ? halves.expected_px : std::nan("");
  message.cross_p_value = halves.p_value;
  message.lens_fit = report.lens_fit.sentence();
  message.better_model = report.lens_fit.better;
  message.misfit_rms = report.lens_fit.misfit.rms;
  message.misfit_max = report.lens_fit.misfit.max;
  message.entropy = report.entropy;
  message.rolling_shutter = report.shutter.rolls;
  message.readout_time = report.shutter.readout_s;
  message.readout_time_sigma = report.shutter.sigma_s;
  message.revision = report.revision;
  message.epoch = report.epoch;
  message.handed_over = report.handed_over;
  message.frozen = report.frozen;
  message.keyframes = report.keyframes;
  return message;
}

Queue toQueue(const QueueReport& report) {
  Queue message;
  message.segments.reserve(report.segments.size());
  for (const SegmentReport& segment : report.segments) {
    message.segments.push_back(toSegmentStatus(segment));
  }
  message.swaps = static_cast<std::uint32_t>(report.swaps);
  message.last_accepted = report.last_accepted;
  message.last_decision = report.last_decision;
  return message;
}

CalibrationEvent toCalibrationEvent(const Event& event, std::uint64_t epoch) {
  CalibrationEvent message;
  message.type = toString(event.type);
  message.stamp = toRosTime(event.stamp_ns);
  message.onset_stamp = toRosTime(event.onset_stamp_ns);
  message.epoch = epoch;
  message.magnitude_px = event.magnitude_px;
  message.rotation_deg = event.rotation / kDegree;
  message.rotation_sigma_deg = event.rotation_sigma / kDegree;
  message.p_value = event.p_value;
  message.sentence = event.sentence;
  return message;
}

}  // namespace camera_self_calibration
