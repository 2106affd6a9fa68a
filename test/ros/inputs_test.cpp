// What cameras, drivers and bags do to a node that runs: a factory calibration to start from,
// another resolution in flight, silence, a burst that is too fast; and the frames as tf2 reads
// them.

#include <camera_self_calibration/Calibration.h>
#include <camera_self_calibration/CalibrationEvent.h>
#include <camera_self_calibration/TrackingStatus.h>
#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <tf2_ros/transform_listener.h>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "camera_self_calibration/ros/result_publisher.h"
#include "ros/picture.h"
#include "ros/recorder.h"

namespace camera_self_calibration {
namespace {

Camera cameraOf(const Calibration& message) {
  return Camera(*cameraModelFromString(message.model), static_cast<int>(message.width),
                static_cast<int>(message.height), intrinsics(message.values));
}

/// The newest sentence of a task, with its level in front; empty before it speaks.
std::string diagnosis(const Recorder<diagnostic_msgs::DiagnosticArray>& diagnostics,
                      const std::string& name) {
  std::string newest;
  for (const auto& array : diagnostics.messages) {
    for (const auto& status : array->status) {
      if (status.name == name) newest = std::to_string(status.level) + " " + status.message;
    }
  }
  return newest;
}

class Inputs : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(spinUntil(
        [this] {
          return images_.getNumSubscribers() > 0 && infos_.getNumSubscribers() > 0 &&
                 status_.connected() && event_.connected() && calibration_.connected();
        },
        20.0));
  }

  void publish(double seconds, std::uint32_t width, std::uint32_t height) {
    images_.publish(picture(seconds, width, height));
    spinUntil([] { return false; }, 0.03);
  }

  bool diagnosed(const std::string& name, const std::string& words) {
    return spinUntil([&] { return diagnosis(diagnostics_, name).find(words) != std::string::npos; },
                     10.0);
  }

  bool raised(const std::string& words) {
    return spinUntil(
        [&] {
          for (const auto& event : event_.messages) {
            if (event->type == CalibrationEvent::INPUT &&
                event->sentence.find(words) != std::string::npos) {
              return true;
            }
          }
          return false;
        },
        10.0);
  }

  ros::NodeHandle node_;
  ros::Publisher images_ = node_.advertise<sensor_msgs::Image>("/camera/image_raw", 20);
  ros::Publisher infos_ = node_.advertise<sensor_msgs::CameraInfo>("/camera/camera_info", 1, true);
  Recorder<TrackingStatus> status_{"/selfcal/tracking_status"};
  Recorder<CalibrationEvent> event_{"/selfcal/event"};
  Recorder<Calibration> calibration_{"/selfcal/calibration"};
  Recorder<diagnostic_msgs::DiagnosticArray> diagnostics_{"/diagnostics"};
};

// One story, in the order of an operator's day.
TEST_F(Inputs, FactoryStartResolutionChangeAndSilence) {
  const Camera factory = Camera(CameraModel::kEquidistant, 320, 240,
                                intrinsics({170, 170, 163, 117, -0.02, 0.003, 0.0, 0.0}));
  infos_.publish(toCameraInfo(factory)->info);
  spinUntil([] { return false; }, 0.5);
  for (int i = 0; i < 10; ++i) publish(100.0 + 0.05 * i, 320, 240);
  ASSERT_TRUE(spinUntil([this] { return !calibration_.messages.empty(); }, 10.0));
  const Camera start = cameraOf(*calibration_.messages.front());
  EXPECT_EQ(start.model(), CameraModel::kFov);
  EXPECT_LT(pixelDistance(factory, start).rms, 0.5) << "the factory's, fitted by the model";
  EXPECT_TRUE(diagnosed("selfcal: factory calibration",
                        "0 CANNOT_TELL: The video has not determined the lens yet"));

  // The driver switches to binning; a single odd image on the way does not matter.
  sensor_msgs::CameraInfo binned = toCameraInfo(factory)->info;
  binned.binning_x = binned.binning_y = 2;
  publish(100.6, 640, 480);
  publish(100.65, 320, 240);
  infos_.publish(binned);
  const std::uint64_t map_id = status_.messages.back()->map_id;
  const std::size_t before = calibration_.messages.size();
  for (int i = 0; i < 12; ++i) publish(101.0 + 0.05 * i, 160, 120);
  EXPECT_TRUE(raised("320 x 240 to 160 x 120"));
  ASSERT_TRUE(spinUntil([&] { return calibration_.messages.size() > before; }, 10.0));
  const Camera rescaled = cameraOf(*calibration_.messages.back());
  EXPECT_EQ(rescaled.width(), 160);
  EXPECT_NEAR(rescaled.parameters()[0], 0.5 * start.parameters()[0], 0.5);
  EXPECT_NEAR(rescaled.parameters()[2], 0.5 * (start.parameters()[2] + 0.5) - 0.5, 0.2);
  ASSERT_TRUE(spinUntil([&] { return status_.messages.back()->map_id > map_id; }, 10.0));
  EXPECT_GT(calibration_.messages.back()->epoch, calibration_.messages.front()->epoch);

  EXPECT_TRUE(diagnosed("selfcal: timing", "1 No images on /camera/image_raw"));
  EXPECT_TRUE(diagnosed("selfcal: tracking", "1 No image for"));
  publish(130.0, 160, 120);
  EXPECT_TRUE(raised("no image came for"));
  EXPECT_TRUE(
      spinUntil([&] { return status_.messages.back()->header.stamp == ros::Time(130.0); }, 10.0));
}

TEST_F(Inputs, ABurstIsThinnedOutAndTheNewestImageComesThrough) {
  ros::Publisher images = node_.advertise<sensor_msgs::Image>("/flood/image_raw", 200);
  Recorder<TrackingStatus> status{"/busy/tracking_status"};
  ASSERT_TRUE(
      spinUntil([&] { return images.getNumSubscribers() > 0 && status.connected(); }, 20.0));
  sensor_msgs::Image image = picture(100.0, 960, 720);
  constexpr int kImages = 60;
  for (int i = 1; i <= kImages; ++i) {
    image.header.stamp = ros::Time(100.0 + i / 120.0);
    images.publish(image);
  }
  ASSERT_TRUE(spinUntil(
      [&] {
        return !status.messages.empty() &&
               status.messages.back()->header.stamp == image.header.stamp;
      },
      20.0));
  EXPECT_LT(status.messages.size(), static_cast<std::size_t>(kImages));
  // Dropped here or, by ROS's own queue, before.
  const bool said = spinUntil(
      [&] {
        const std::string text = diagnosis(diagnostics_, "busy: timing");
        return text.find("dropped") != std::string::npos ||
               text.find("did not arrive") != std::string::npos;
      },
      5.0);
  EXPECT_TRUE(said) << diagnosis(diagnostics_, "busy: timing");
}

TEST_F(Inputs, TwoCamerasOnOneTopicAreNamed) {
  ros::Publisher images = node_.advertise<sensor_msgs::Image>("/twin/image_raw", 20);
  ASSERT_TRUE(spinUntil([&] { return images.getNumSubscribers() > 0; }, 20.0));
  double seconds = 100.0;
  const bool said = spinUntil(
      [&] {
        images.publish(picture(seconds += 0.05, 64, 48));
        const std::string text = diagnosis(diagnostics_, "shared: timing");
        return text.find(ros::this_node::getName()) != std::string::npos &&
               text.find("/second_camera") != std::string::npos;
      },
      20.0);
  EXPECT_TRUE(said) << diagnosis(diagnostics_, "shared: timing");
}

TEST_F(Inputs, ANodeDoesNotListenToItself) {
  EXPECT_TRUE(diagnosed("loop: tracking", "2 Idle"));
  EXPECT_TRUE(diagnosed("loop: tracking", "/loop/image_raw"));
}

/// As a robot's tf tree: base_link carries the camera, and a map is to hang on it, or it on the
/// map.
TEST(Frames, Tf2FindsTheCameraInTheMapBothWays) {
  FrameResult result;
  result.stamp_ns = 50000000000;
  result.state = TrackingState::kTracking;
  result.world_from_camera = {expSo3(Eigen::Vector3d(0.3, -0.2, 0.9)), {1.0, 2.0, 3.0}};
  for (const bool invert : {false, true}) {
    tf2_ros::Buffer buffer;
    const tf2_ros::TransformListener listener(buffer);
    NodeOptions options;
    options.invert_tf = invert;
    options.world_frame = invert ? "/inverted_map" : "map";
    ResultPublisher publisher(ros::NodeHandle("~"), options);
    publisher.setImageFrame("/lens");
    EXPECT_EQ(publisher.frameProblem(), "");
    geometry_msgs::TransformStamped found;
    const auto arrived = [&] {
      publisher.publish(result, 0);
      try {
        found = buffer.lookupTransform(invert ? "inverted_map" : "map", "lens", ros::Time(50.0));
        return true;
      } catch (const tf2::TransformException&) {
        return false;
      }
    };
    ASSERT_TRUE(spinUntil(arrived, 10.0)) << "invert_tf " << invert;
    EXPECT_NEAR(found.transform.translation.x, 1.0, 1e-9);
    EXPECT_NEAR(found.transform.translation.z, 3.0, 1e-9);
    EXPECT_NEAR(found.transform.rotation.w, result.world_from_camera.rotation.w(), 1e-9);
    // Inverted, the camera keeps a place for its parent on the robot.
    std::string parent;
    ASSERT_TRUE(buffer._getParent(invert ? "inverted_map" : "lens", ros::Time(50.0), parent));
    EXPECT_EQ(parent, invert ? "lens" : "map");
  }
}

TEST(Frames, NothingIsPublishedOfAPoseThatIsNotKnown) {
  Recorder<geometry_msgs::PoseWithCovarianceStamped> poses{"pose", ros::NodeHandle("~")};
  NodeOptions options;
  options.publish_tf = false;
  ResultPublisher publisher(ros::NodeHandle("~"), options);
  ASSERT_TRUE(spinUntil([&] { return poses.connected(); }, 10.0));
  spinUntil([] { return false; }, 0.3);
  FrameResult result;
  for (const TrackingState state :
       {TrackingState::kInitializing, TrackingState::kLost, TrackingState::kTracking}) {
    result.state = state;
    result.stamp_ns += 1000000000;
    result.pose_covariance = 0.01 * Matrix6d::Identity();
    publisher.publish(result, 0);
  }
  ASSERT_TRUE(spinUntil([&] { return !poses.messages.empty(); }, 5.0));
  ASSERT_EQ(poses.messages.size(), 1u);
  EXPECT_EQ(poses.messages[0]->header.stamp, ros::Time(3.0));
  EXPECT_EQ(poses.messages[0]->pose.covariance[0], 0.01);
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "inputs_test");
  ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
