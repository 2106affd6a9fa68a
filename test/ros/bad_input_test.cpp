// Bad images and bad parameters: clear words, no crash, and the work goes on.

#include <camera_self_calibration/TrackingStatus.h>
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/package.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <algorithm>

#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/ros/node_options.h"
#include "ros/picture.h"
#include "ros/recorder.h"

namespace camera_self_calibration {
namespace {

bool isAdvertised(const std::string& topic) {
  ros::master::V_TopicInfo topics;
  EXPECT_TRUE(ros::master::getTopics(topics));
  return std::any_of(topics.begin(), topics.end(),
                     [&](const ros::master::TopicInfo& info) { return info.name == topic; });
}

class BadInput : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(spinUntil([this] { return publisher_.getNumSubscribers() > 0; }, 20.0));
    ASSERT_TRUE(spinUntil([this] { return status_.connected(); }, 20.0));
  }

  /// The node answers a good image: it lives.
  void expectAlive(double seconds) {
    publisher_.publish(picture(seconds));
    EXPECT_TRUE(spinUntil([&] { return hasStatus(seconds); }, 10.0)) << "at " << seconds;
  }

  bool hasStatus(double seconds) const {
    for (const auto& message : status_.messages) {
      if (message->header.stamp == ros::Time(seconds)) return true;
    }
    return false;
  }

  /// Waits for the word in a message of /diagnostics of this name.
  bool diagnosed(const std::string& name, const std::string& word) {
    return spinUntil(
        [&] {
          for (const auto& array : diagnostics_.messages) {
            for (const auto& status : array->status) {
              const bool about = status.name.find(name) != std::string::npos;
              if (about && status.message.find(word) != std::string::npos) return true;
            }
          }
          return false;
        },
        10.0);
  }

  ros::NodeHandle node_;
  ros::Publisher publisher_ = node_.advertise<sensor_msgs::Image>("/camera/image_raw", 20);
  Recorder<TrackingStatus> status_{"/selfcal/tracking_status"};
  Recorder<diagnostic_msgs::DiagnosticArray> diagnostics_{"/diagnostics"};
};

TEST_F(BadInput, MalformedImagesAreNamedAndLeftOut) {
  expectAlive(100.0);
  sensor_msgs::Image truncated = picture(100.1);
  truncated.data.resize(1000);
  publisher_.publish(truncated);
  EXPECT_TRUE(diagnosed("selfcal: timing", "truncated"));
  expectAlive(100.2);

  sensor_msgs::Image unknown = picture(100.3);
  unknown.encoding = "h265";
  publisher_.publish(unknown);
  EXPECT_TRUE(diagnosed("selfcal: timing", "h265"));
  publisher_.publish(sensor_msgs::Image());
  EXPECT_TRUE(diagnosed("selfcal: timing", "empty"));
  expectAlive(100.4);
  EXPECT_FALSE(hasStatus(100.1));
  EXPECT_FALSE(hasStatus(100.3));
}

TEST_F(BadInput, AnotherSizeIsNamedAndTheOldOneGoesOn) {
  expectAlive(200.0);
  publisher_.publish(picture(200.1, 160, 120));
  EXPECT_TRUE(diagnosed("selfcal: timing", "320 x 240 to 160 x 120"));
  expectAlive(200.2);
  EXPECT_FALSE(hasStatus(200.1));
}

TEST_F(BadInput, AClockThatJumpsBackIsNamedAndTheWorkGoesOn) {
  expectAlive(300.0);
  expectAlive(250.0);
  EXPECT_TRUE(diagnosed("selfcal: timing", "jumped back"));
  expectAlive(250.1);
}

TEST_F(BadInput, WrongParametersAreAllListedAndTheNodeStaysIdle) {
  EXPECT_TRUE(diagnosed("wrong: calibration", "Idle"));
  for (const char* word : {"alpha", "model", "max_features must be a whole number", "path_poses"}) {
    EXPECT_TRUE(diagnosed("wrong: calibration", word)) << word;
  }
  EXPECT_TRUE(isAdvertised("/selfcal/tracking_status"));
  EXPECT_FALSE(isAdvertised("/wrong/tracking_status"));
}

TEST_F(BadInput, DamagedCompressedImagesAreNamed) {
  ros::Publisher publisher =
      node_.advertise<sensor_msgs::CompressedImage>("/pictures/image_raw/compressed", 10);
  ASSERT_TRUE(spinUntil([&] { return publisher.getNumSubscribers() > 0; }, 20.0));
  sensor_msgs::CompressedImage garbage;
  garbage.format = "jpeg";
  garbage.data.assign(500, 3);
  publisher.publish(garbage);
  EXPECT_TRUE(diagnosed("jpeg: timing", "cannot be decoded"));
}

/// Every parameter as text, in the order of config/parameters.yaml.
std::vector<std::string> valuesOf(const NodeOptions& options) {
  const Options& pipeline = options.pipeline;
  std::vector<std::string> values = {options.model,
                                     pipeline.model ? toString(*pipeline.model) : "",
                                     options.image_transport,
                                     options.world_frame,
                                     options.child_frame,
                                     options.output_distortion_model,
                                     options.projection,
                                     options.score,
                                     options.camera_info_input,
                                     options.mask_url};
  for (const double value : options.initial_intrinsics) values.push_back(std::to_string(value));
  for (const double value : {options.publish_uncalibrated ? 1.0 : 0.0,
                             options.publish_tf ? 1.0 : 0.0,
                             options.invert_tf ? 1.0 : 0.0,
                             options.min_publish_change_px,
                             options.factory_warn_px,
                             1.0 * options.path_poses,
                             1.0 * pipeline.tracker.max_features,
                             pipeline.tracker.min_distance_px,
                             pipeline.keyframe.min_parallax,
                             pipeline.keyframe.min_rotation_deg,
                             pipeline.keyframe.min_tracked_share,
                             1.0 * pipeline.sliding_window_keyframes,
                             1.0 * pipeline.segment_keyframes,
                             1.0 * pipeline.queue_segments,
                             1.0 * pipeline.startup_keyframes,
                             pipeline.exact_references ? 1.0 : 0.0,
                             pipeline.handover_entropy,
                             pipeline.alpha,
                             pipeline.converged_pixel_rms,
                             1.0 * pipeline.solver_threads,
                             1.0 * pipeline.max_queued_images,
                             pipeline.false_alarms_per_hour,
                             1.0 * pipeline.relocalization_keyframes,
                             pipeline.readout_s}) {
    values.push_back(std::to_string(value));
  }
  return values;
}

TEST(ReadNodeOptions, OfFilesAndServices) {
  const NodeOptions options = readNodeOptions(ros::NodeHandle("/others")).options;
  EXPECT_EQ(options.camera_name, "eye_2");
  EXPECT_EQ(options.camera_info_url, "file:///tmp/c.yaml");
  EXPECT_EQ(options.state_file, "s.state");
  EXPECT_EQ(options.autosave_interval_s, 5.5);
  EXPECT_EQ(options.report_file, "r.yaml");
  EXPECT_EQ(options.commit_service, "/driver/set");
  const NodeOptions file = readNodeOptions(ros::NodeHandle("/defaults")).options;
  const NodeOptions defaults;
  EXPECT_EQ(file.camera_name, defaults.camera_name);
  EXPECT_EQ(file.camera_info_url, defaults.camera_info_url);
  EXPECT_EQ(file.state_file, defaults.state_file);
  EXPECT_EQ(file.autosave_interval_s, defaults.autosave_interval_s);
  EXPECT_EQ(file.report_file, defaults.report_file);
  EXPECT_EQ(file.commit_service, defaults.commit_service);
}

TEST(ReadNodeOptions, UnknownParametersAreNamedWithTheNearestKnownOne) {
  const NodeOptionsReading reading = readNodeOptions(ros::NodeHandle("/typos"));
  EXPECT_TRUE(reading.problems.empty());
  ASSERT_EQ(reading.warnings.size(), 2u) << "neither known ones nor namespaces";
  std::string all;
  for (const std::string& warning : reading.warnings) all += warning + "\n";
  EXPECT_NE(all.find("~max_feature is not known; is ~max_features meant?"), std::string::npos);
  EXPECT_NE(all.find("~exposure is not known\n"), std::string::npos) << all;
  EXPECT_TRUE(readNodeOptions(ros::NodeHandle("/others")).warnings.empty());
  EXPECT_TRUE(readNodeOptions(ros::NodeHandle("/empty")).warnings.empty());
}

TEST(ReadNodeOptions, EveryParameterThatIsReadStandsInTheFile) {
  const std::string path =
      ros::package::getPath("camera_self_calibration") + "/config/parameters.yaml";
  const std::string text = readFile(path).bytes;
  const std::vector<std::string> known = readNodeOptions(ros::NodeHandle("/defaults")).known;
  EXPECT_GT(known.size(), 25u);
  for (const std::string& name : known) {
    EXPECT_TRUE(text.find("\n" + name + ": ") != std::string::npos ||
                text.find("\n# " + name + ": ") != std::string::npos)
        << name << " is not in " << path;
  }
}

TEST(ReadNodeOptions, TheParameterFileHoldsTheDefaults) {
  const NodeOptionsReading reading = readNodeOptions(ros::NodeHandle("/defaults"));
  EXPECT_TRUE(reading.problems.empty());
  EXPECT_EQ(valuesOf(reading.options), valuesOf(NodeOptions()));
}

TEST(ReadNodeOptions, EveryParameterOfTheFileIsRead) {
  const NodeOptionsReading reading = readNodeOptions(ros::NodeHandle("/others"));
  EXPECT_TRUE(reading.problems.empty());
  std::vector<std::string> expected = {
      "plumb_bob",           "radtan", "raw",   "here",    "eye",
      "rational_polynomial", "fixed",  "pixel", "compare", "file:///mask.png"};
  for (const double value : {400.0, 401.0, 320.0, 240.0, -0.2, 0.1, 0.0,  0.0, 0.01, 1.0,  0.0,
                             1.0,   0.5,   2.5,   7.0,   99.0, 9.5, 0.02, 4.0, 0.6,  8.0,  9.0,
                             6.0,   21.0,  1.0,   -30.5, 0.9,  0.4, 3.0,  5.0, 3.5,  40.0, 0.025}) {
    expected.push_back(std::to_string(value));
  }
  EXPECT_EQ(valuesOf(reading.options), expected);
  // The test itself leaves no parameter of the file out.
  XmlRpc::XmlRpcValue file;
  XmlRpc::XmlRpcValue others;
  ASSERT_TRUE(ros::param::get("/defaults", file));
  ASSERT_TRUE(ros::param::get("/others", others));
  EXPECT_GT(file.size(), 20);
  for (const auto& parameter : file) {
    EXPECT_TRUE(others.hasMember(parameter.first)) << parameter.first;
  }
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "bad_input_test");
  ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
