// A real stereo pair of known calibration: what is said of the rig is true, and the trajectory is
// metric; a camera that is turned half way is found. The bag is sought in videoFolder(); without it
// there is no test.

#include <cv_bridge/cv_bridge.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>

#include <opencv2/imgproc.hpp>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/tools/calibrate_rig.h"
#include "camera_self_calibration/tools/trajectory_results.h"
#include "real/video_folder.h"
#include "tools/temporary_folder.h"

namespace camera_self_calibration {
namespace {

// EuRoC MH_01, recalibrated from 52 pairs of images of a board: cam1_from_cam0.
const Rigid3 kTruth(expSo3({-0.01433245, -0.00058306, -0.00213526}),
                    {-0.10986007, 0.00042856, -0.00108892});
// Of the truth, 1 sigma: its halves agree to 0.008 degrees, the data set's own lies 0.057 away.
constexpr double kTruthRotation = 0.03 * kDegree;
constexpr double kTruthDirection = 0.1 * kDegree;

TEST(RealRig, WhatIsSaidOfAStereoPairIsTrue) {
  const std::filesystem::path bag = videoFolder() / "mh01_stereo.bag";
  if (!std::filesystem::exists(bag)) {
    GTEST_SKIP() << "there is no " << bag << "; SELFCAL_VIDEOS may name another folder";
  }
  SourceOptions source;
  source.path = bag.string();
  RigExtras extras;
  extras.baseline_m = kTruth.translation.norm();
  const RigRecording recording =
      calibrateRig(source, {"/cam0/image_raw", "/cam1/image_raw"}, {}, extras);
  ASSERT_TRUE(recording.converged()) << recording.estimate.sentence;
  EXPECT_TRUE(recording.mount_changes.empty()) << recording.mount_changes.front().sentence;
  const Rigid3& found = recording.estimate.rig.rig_from_camera[1];
  const PlaceInRig& place = recording.estimate.places[1];
  const double turn = logSo3(kTruth.rotation * found.rotation).norm();
  EXPECT_LT(turn, 0.1 * kDegree);
  EXPECT_LT(turn, 3.0 * std::hypot(place.rotationSigma(), kTruthRotation));
  const Eigen::Vector3d position = kTruth.inverse().translation;
  const double angle = std::acos(position.normalized().dot(found.translation.normalized()));
  EXPECT_LT(angle, 1.0 * kDegree);
  EXPECT_LT(angle, 3.0 * std::hypot(place.directionSigma(found.translation), kTruthDirection));

  const std::vector<StampedCameraPose> poses(recording.poses.begin(), recording.poses.end());
  const auto difference = compareTrajectories(poses, readGroundTruth(bag.string() + ".gt.tum"));
  ASSERT_TRUE(difference);
  EXPECT_NEAR(difference->scale, 1.0, 0.01);
  EXPECT_LT(difference->rms, 0.01);
}

// The second camera's images are turned about its principal point from half time on: its lens is
// the same, and it is rolled by as much.
constexpr double kRoll = 0.5 * kDegree;
const cv::Point2f kCentre(379.4F, 255.6F);

double writeTurned(const std::string& path, const std::string& out) {
  rosbag::Bag source(path, rosbag::bagmode::Read);
  rosbag::Bag target(out, rosbag::bagmode::Write);
  rosbag::View view(source);
  const ros::Time half =
      view.getBeginTime() + ros::Duration(0.5 * (view.getEndTime() - view.getBeginTime()).toSec());
  const cv::Mat roll = cv::getRotationMatrix2D(kCentre, kRoll / kDegree, 1.0);
  for (const rosbag::MessageInstance& message : view) {
    const auto image = message.instantiate<sensor_msgs::CompressedImage>();
    if (!image) continue;
    if (message.getTopic() != "/cam1/image_raw/compressed" || message.getTime() < half) {
      target.write(message.getTopic(), message.getTime(), *image);
      continue;
    }
    const auto before = cv_bridge::toCvCopy(*image, "mono8");
    cv_bridge::CvImage after(image->header, "mono8");
    cv::warpAffine(before->image, after.image, roll, before->image.size(), cv::INTER_CUBIC,
                   cv::BORDER_REPLICATE);
    target.write(message.getTopic(), message.getTime(),
                 *after.toCompressedImageMsg(cv_bridge::PNG));
  }
  return half.toSec();
}

TEST(RealRig, ACameraThatIsTurnedIsFound) {
  const std::filesystem::path bag = videoFolder() / "mh01_stereo.bag";
  if (!std::filesystem::exists(bag)) GTEST_SKIP() << "there is no " << bag;
  const TemporaryFolder folder;
  SourceOptions source;
  source.path = folder / "turned.bag";
  const double half_s = writeTurned(bag.string(), source.path);
  RigExtras extras;
  extras.baseline_m = kTruth.translation.norm();
  const RigRecording recording =
      calibrateRig(source, {"/cam0/image_raw", "/cam1/image_raw"}, {}, extras);
  ASSERT_EQ(recording.mount_changes.size(), 1u) << recording.estimate.sentence;
  const MountChange& change = recording.mount_changes.front();
  SCOPED_TRACE(change.sentence);
  EXPECT_EQ(change.camera, 1);
  EXPECT_NEAR(toSeconds(change.onset_ns), half_s, 2.0);
  const Eigen::Vector3d roll = kTruth.inverse().rotation * Eigen::Vector3d(0.0, 0.0, kRoll);
  const Eigen::Vector3d error = change.rotation - roll;
  EXPECT_LT(error.norm(), 0.1 * kDegree);
  // Afterwards the rig is the one since.
  ASSERT_TRUE(recording.estimate.usable) << recording.estimate.sentence;
  const Eigen::Quaterniond turned = kTruth.inverse().rotation * expSo3({0.0, 0.0, kRoll});
  const double off =
      logSo3(turned.conjugate() * recording.estimate.rig.rig_from_camera[1].rotation).norm();
  EXPECT_LT(off, 0.2 * kDegree) << recording.estimate.sentence;
}

}  // namespace
}  // namespace camera_self_calibration
