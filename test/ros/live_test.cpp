// A simulated camera through the nodelet: everything it promises to publish, and the truth.

#include <camera_self_calibration/Calibration.h>
#include <camera_self_calibration/CalibrationEvent.h>
#include <camera_self_calibration/Queue.h>
#include <camera_self_calibration/TrackingStatus.h>
#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <nodelet/NodeletList.h>
#include <nodelet/NodeletLoad.h>
#include <nodelet/NodeletUnload.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/Header.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>

#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "camera_self_calibration/simulation/room.h"
#include "camera_self_calibration/tools/truth_table.h"
#include "ros/recorder.h"
#include "ros/straight_edges.h"

namespace camera_self_calibration {
namespace {

constexpr const char* kWorld = "selfcal_map";
constexpr const char* kCamera = "simulated_camera";

/// Listens to one run of the simulated camera, which all tests share.
struct Run {
  Recorder<sensor_msgs::Image> image{"/selfcal/image_raw"};
  Recorder<sensor_msgs::CameraInfo> camera_info{"/selfcal/camera_info"};
  Recorder<sensor_msgs::Image> rectified{"/selfcal/image_rect"};
  Recorder<geometry_msgs::PoseStamped> true_pose{"/simulated_camera/truth/pose"};
  Recorder<sensor_msgs::CameraInfo> true_info{"/simulated_camera/truth/camera_info"};
  Recorder<geometry_msgs::PoseWithCovarianceStamped> pose{"/selfcal/pose"};
  Recorder<nav_msgs::Odometry> odometry{"/selfcal/odometry"};
  Recorder<nav_msgs::Path> path{"/selfcal/path"};
  Recorder<tf2_msgs::TFMessage> tf{"/tf"};
  Recorder<TrackingStatus> status{"/selfcal/tracking_status"};
  Recorder<Calibration> calibration{"/selfcal/calibration"};
  Recorder<Calibration> truth{"/simulated_camera/truth/calibration"};
  Recorder<Queue> queue{"/selfcal/queue"};
  Recorder<CalibrationEvent> event{"/selfcal/event"};
  Recorder<diagnostic_msgs::DiagnosticArray> diagnostics{"/diagnostics"};
  Recorder<std_msgs::Header> finished{"/simulated_camera/truth/finished"};
  std::unique_ptr<Recorder<sensor_msgs::Image>> source;

  bool connected() const {
    return image.connected() && rectified.connected() && true_pose.connected() &&
           camera_info.connected() && true_info.connected() && pose.connected() &&
           odometry.connected() && path.connected() && tf.connected() && status.connected() &&
           calibration.connected() && truth.connected() && queue.connected() && event.connected() &&
           diagnostics.connected() && finished.connected();
  }

  /// The camera begins when its images have two subscribers; this is the second one.
  bool listenToTheEnd() {
    if (!spinUntil([this] { return connected(); }, 30.0)) return false;
    source = std::make_unique<Recorder<sensor_msgs::Image>>("/simulated_camera/image_raw");
    if (!spinUntil([this] { return !finished.messages.empty(); }, 60.0)) return false;
    // The last keyframes are still being worked in.
    spinUntil([] { return false; }, 2.5);
    return true;
  }
};

const Run& run() {
  static Run recorded;
  static const bool done = recorded.listenToTheEnd();
  if (!done) ADD_FAILURE() << "not all topics were there, or the camera did not finish in time";
  if (!recorded.source) recorded.source = std::make_unique<Recorder<sensor_msgs::Image>>("none");
  return recorded;
}

template <typename Message>
std::set<ros::Time> stampsOf(const Recorder<Message>& recorder) {
  std::set<ros::Time> stamps;
  for (const auto& message : recorder.messages) stamps.insert(message->header.stamp);
  return stamps;
}

bool contains(const std::set<ros::Time>& all, const std::set<ros::Time>& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

TEST(Live, EveryImageIsProcessedAndRepublishedWithItsHeader) {
  const auto source = stampsOf(*run().source);
  ASSERT_GT(source.size(), 200u);
  EXPECT_EQ(stampsOf(run().image), source);
  EXPECT_EQ(stampsOf(run().status), source);
  for (const auto& status : run().status.messages) EXPECT_EQ(status->dropped_images, 0u);
  EXPECT_EQ(run().image.messages.front()->header.frame_id, kCamera);
}

TEST(Live, OneCameraInfoPerImageZerosUntilConverged) {
  EXPECT_EQ(stampsOf(run().camera_info), stampsOf(*run().source));
  EXPECT_EQ(run().camera_info.messages.size(), run().source->messages.size());
  ASSERT_FALSE(run().camera_info.messages.empty());
  EXPECT_EQ(run().camera_info.messages.front()->K[0], 0.0);
  const auto converged = std::find_if(
      run().calibration.messages.begin(), run().calibration.messages.end(),
      [](const auto& message) { return message->calibration_state == Calibration::CONVERGED; });
  ASSERT_NE(converged, run().calibration.messages.end());
  for (const auto& info : run().camera_info.messages) {
    EXPECT_EQ(info->width, 640u);
    EXPECT_EQ(info->header.frame_id, kCamera);
    if (info->header.stamp < (*converged)->header.stamp) {
      EXPECT_EQ(info->K[0], 0.0);
    }
  }
}

TEST(Live, TheLastCameraInfoIsTrueToAPixel) {
  ASSERT_FALSE(run().camera_info.messages.empty());
  ASSERT_FALSE(run().true_info.messages.empty());
  const std::optional<Camera> published = toCamera(*run().camera_info.messages.back());
  const std::optional<Camera> truth = toCamera(*run().true_info.messages.back());
  ASSERT_TRUE(published && truth);
  EXPECT_LT(pixelDistance(*truth, *published).rms, 1.0);
}

TEST(Live, TheCalibrationIsWithinThreeSigmaOfTheTruth) {
  ASSERT_FALSE(run().calibration.messages.empty());
  ASSERT_FALSE(run().truth.messages.empty());
  const Calibration& last = *run().calibration.messages.back();
  const TruthComparison comparison = compareWithTruth(*run().truth.messages.back(), last);
  std::cout << comparison.table;
  EXPECT_TRUE(comparison.converged) << last.calibration_sentence;
  EXPECT_LE(comparison.largest_z, 3.0) << comparison.table;
  EXPECT_LE(last.pixel_uncertainty_rms, 1.0);
  EXPECT_GE(last.pixel_uncertainty_max, last.pixel_uncertainty_rms);
  ASSERT_EQ(last.covariance.size(), 25u);
  EXPECT_NEAR(last.sigma[0] * last.sigma[0], last.covariance[0], 1e-9);
  EXPECT_TRUE(last.handed_over);
  EXPECT_TRUE(last.hint.empty()) << last.hint;
  EXPECT_EQ(last.tracking_state, TrackingStatus::TRACKING);
}

template <typename Message>
typename Message::ConstPtr messageAt(const Recorder<Message>& recorder, const ros::Time& stamp) {
  for (const auto& message : recorder.messages) {
    if (message->header.stamp == stamp) return message;
  }
  return nullptr;
}

// image_proc with our CameraInfo: what is straight in the room is straight in the image.
TEST(Live, TheRoomsEdgesComeOutStraight) {
  ASSERT_GT(run().rectified.messages.size(), 20u) << "rectified from CONVERGED on";
  EXPECT_LT(run().rectified.messages.size(), run().source->messages.size());
  RoomOptions room;
  room.seed = 2;  // As in live.test.
  const World world = makeRoom(room);
  std::vector<double> raw;
  std::vector<double> rectified;
  for (std::size_t i = 0; i < run().rectified.messages.size(); i += 5) {
    const sensor_msgs::Image& image = *run().rectified.messages[i];
    const auto info = messageAt(run().camera_info, image.header.stamp);
    const auto truth = messageAt(run().true_info, image.header.stamp);
    const auto pose = messageAt(run().true_pose, image.header.stamp);
    ASSERT_TRUE(info && truth && pose);
    image_geometry::PinholeCameraModel model;
    model.fromCameraInfo(info);
    const auto& q = pose->pose.orientation;
    const auto& p = pose->pose.position;
    const Rigid3 world_from_camera{Eigen::Quaterniond(q.w, q.x, q.y, q.z), {p.x, p.y, p.z}};
    const cv::Mat pixels(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC1,
                         const_cast<std::uint8_t*>(image.data.data()), image.step);
    for (const EdgeBow& bow :
         StraightEdges(world, *toCamera(*truth), model).measure(pixels, world_from_camera)) {
      if (bow.raw < 1.5) continue;  // Through the centre: straight in the raw image too.
      raw.push_back(bow.raw);
      rectified.push_back(bow.rectified);
    }
  }
  ASSERT_GT(raw.size(), 30u);
  std::cout << raw.size() << " edges bend by " << median(raw, 0.0)
            << " px (median) in the raw image, by " << median(rectified, 1e9) << " px rectified\n";
  EXPECT_GT(median(raw, 0.0), 2.0);
  EXPECT_LT(median(rectified, 1e9), 0.25);
}

TEST(Live, TheQueueSaysWhatItRestsOn) {
  ASSERT_FALSE(run().queue.messages.empty());
  const Queue& last = *run().queue.messages.back();
  EXPECT_GE(last.segments.size(), 2u);
  EXPECT_GE(last.swaps, last.segments.size());
  EXPECT_FALSE(last.last_decision.empty());
  for (const SegmentStatus& segment : last.segments) {
    EXPECT_LT(segment.begin, segment.end);
    EXPECT_GE(segment.keyframes, 5u);
    EXPECT_GT(segment.observations, segment.landmarks);
    EXPECT_TRUE(std::isfinite(segment.entropy));
  }
}

TEST(Live, PosesCarryTheStampsOfImagesAndAreContinuous) {
  const auto stamps = stampsOf(run().pose);
  EXPECT_TRUE(contains(stampsOf(*run().source), stamps));
  EXPECT_GT(stamps.size(), run().source->messages.size() * 8 / 10);
  for (const auto& message : run().pose.messages) {
    EXPECT_EQ(message->header.frame_id, kWorld);
    const auto& q = message->pose.pose.orientation;
    EXPECT_NEAR(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1.0, 1e-6);
    for (std::size_t i = 0; i < 36; i += 7) EXPECT_GE(message->pose.covariance[i], 0.0);
  }
  // From the second of a map on there is a velocity.
  EXPECT_GE(run().odometry.messages.size() + 5, run().pose.messages.size());
  EXPECT_EQ(run().odometry.messages.back()->child_frame_id, kCamera);
}

TEST(Live, TransformsEqualPoses) {
  std::map<ros::Time, geometry_msgs::TransformStamped> transforms;
  for (const auto& message : run().tf.messages) {
    for (const auto& transform : message->transforms)
      transforms[transform.header.stamp] = transform;
  }
  ASSERT_FALSE(run().pose.messages.empty());
  for (const auto& pose : run().pose.messages) {
    const auto found = transforms.find(pose->header.stamp);
    ASSERT_NE(found, transforms.end());
    EXPECT_EQ(found->second.header.frame_id, kWorld);
    EXPECT_EQ(found->second.child_frame_id, kCamera);
    EXPECT_EQ(found->second.transform.translation.x, pose->pose.pose.position.x);
  }
}

TEST(Live, ThePathIsBounded) {
  ASSERT_FALSE(run().path.messages.empty());
  const nav_msgs::Path& last = *run().path.messages.back();
  EXPECT_EQ(last.header.frame_id, kWorld);
  EXPECT_GE(last.poses.size(), 5u);
  EXPECT_LE(last.poses.size(), 20u) << "path_poses is 20 in live.test";
}

TEST(Live, EventsComeOnce) {
  std::map<std::string, int> counts;
  for (const auto& event : run().event.messages) ++counts[event->type];
  EXPECT_EQ(counts[CalibrationEvent::CONVERGED], 1);
  EXPECT_EQ(counts[CalibrationEvent::HANDOVER], 1);
  for (const auto& event : run().event.messages) EXPECT_FALSE(event->sentence.empty());
}

TEST(Live, DiagnosticsTellTheOutcome) {
  std::map<std::string, diagnostic_msgs::DiagnosticStatus> last;
  for (const auto& array : run().diagnostics.messages) {
    for (const auto& status : array->status) {
      // After the end of the sequence the camera is silent, and that is said.
      if (status.message.find("No image") == std::string::npos) last[status.name] = status;
    }
  }
  for (const char* task : {"tracking", "calibration", "queue"}) {
    const std::string name = std::string("selfcal: ") + task;
    ASSERT_EQ(last.count(name), 1u) << name;
    EXPECT_EQ(last[name].level, diagnostic_msgs::DiagnosticStatus::OK) << last[name].message;
    EXPECT_FALSE(last[name].message.empty());
  }
  EXPECT_EQ(last.count("selfcal: timing"), 1u);
}

bool managerHolds(const std::string& nodelet_name) {
  nodelet::NodeletList list;
  if (!ros::service::call("/manager/list", list)) return false;
  const auto& names = list.response.nodelets;
  return std::find(names.begin(), names.end(), nodelet_name) != names.end();
}

// The last test, since it ends the nodelet.
TEST(LiveEnd, TheNodeletIsAliveAndUnloadsAndLoadsCleanly) {
  run();
  ASSERT_TRUE(managerHolds("/selfcal")) << "the nodelet or its manager died";
  for (int i = 0; i < 5; ++i) {
    nodelet::NodeletUnload unload;
    unload.request.name = "/selfcal";
    ASSERT_TRUE(ros::service::call("/manager/unload_nodelet", unload));
    EXPECT_TRUE(unload.response.success);
    EXPECT_FALSE(managerHolds("/selfcal"));
    nodelet::NodeletLoad load;
    load.request.name = "/selfcal";
    load.request.type = "camera_self_calibration/SelfCalibrationNodelet";
    ASSERT_TRUE(ros::service::call("/manager/load_nodelet", load));
    EXPECT_TRUE(load.response.success);
    ASSERT_TRUE(managerHolds("/selfcal"));
  }
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "live_test");
  ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
