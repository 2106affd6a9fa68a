// What people look at: drawn only for listeners, with the promised content.

#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>
#include <visualization_msgs/MarkerArray.h>

#include <map>
#include <memory>
#include <set>

#include "camera_self_calibration/plotting/palette.h"
#include "camera_self_calibration/ros/visualizer.h"
#include "ros/recorder.h"
#include "ros/scene_sample.h"

namespace camera_self_calibration {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

/// Pixels of a colour (one more or less in each channel) in a bgr8 image.
int count(const sensor_msgs::Image& image, const Colour& colour) {
  int found = 0;
  for (std::size_t i = 0; i + 2 < image.data.size(); i += 3) {
    bool same = true;
    for (int c = 0; c < 3; ++c) same &= std::abs(image.data[i + std::size_t(c)] - colour[c]) <= 1.0;
    found += same;
  }
  return found;
}

/// A Visualizer in this process, fed by hand.
class Fed : public ::testing::Test {
 protected:
  Fed() : pixels_(640 * 480, 90), visualizer_(ros::NodeHandle("fed"), options()) {}

  static NodeOptions options() {
    NodeOptions options;
    options.world_frame = "map";
    return options;
  }

  void feed() {
    ImageView image;
    image.data = pixels_.data();
    image.width = image.stride = 640;
    image.height = 480;
    image.stamp_ns = 9000000000LL;
    visualizer_.add(image, "camera");
    visualizer_.add(0, sceneCamera(), sceneSegment(0, 10));
    FrameResult frame;
    frame.stamp_ns = image.stamp_ns;
    frame.state = TrackingState::kTracking;
    frame.tracks.tracks.push_back({7, {100.0, 200.0}, {90.0, 200.0}, 0.1});
    visualizer_.add(frame);
    CalibrationReport report = sceneReport();
    report.stamp_ns = image.stamp_ns;
    visualizer_.add(report);
  }

  /// Feeds until the condition holds.
  bool feedUntil(const std::function<bool()>& condition) {
    for (int i = 0; i < 100 && !condition(); ++i) {
      feed();
      spinUntil(condition, 0.1);
    }
    return condition();
  }

  const std::vector<std::uint8_t> pixels_;
  Visualizer visualizer_;
};

TEST_F(Fed, NothingIsDrawnWithoutListeners) {
  for (int i = 0; i < 10; ++i) {
    feed();
    ros::WallDuration(0.08).sleep();
  }
  const Visualizer::Counts counts = visualizer_.counts();
  EXPECT_EQ(counts.markers + counts.clouds + counts.track_images + counts.charts, 0);
}

TEST_F(Fed, OnlyWhatIsHeardIsDrawn) {
  Recorder<sensor_msgs::Image> chart("fed/convergence");
  ASSERT_TRUE(feedUntil([&] { return chart.messages.size() >= 2; }));
  const Visualizer::Counts counts = visualizer_.counts();
  EXPECT_GE(counts.charts, 2);
  EXPECT_EQ(counts.markers + counts.clouds + counts.track_images, 0);
  EXPECT_EQ(chart.messages.back()->encoding, "bgr8");
  EXPECT_EQ(chart.messages.back()->header.stamp, ros::Time(9.0));
  EXPECT_GT(count(*chart.messages.back(), stateColour(CalibrationState::kConverged)), 300);
}

TEST_F(Fed, AViewerThatComesLaterSeesWhatWas) {
  feed();
  Recorder<sensor_msgs::Image> chart("fed/convergence");
  Recorder<MarkerArray> markers("fed/markers");
  ASSERT_TRUE(
      spinUntil([&] { return !chart.messages.empty() && !markers.messages.empty(); }, 10.0));
  EXPECT_GT(count(*chart.messages.back(), stateColour(CalibrationState::kConverged)), 300);
  for (const Marker& marker : markers.messages.back()->markers) {
    if (marker.ns == "trajectory") {
      EXPECT_EQ(marker.points.size(), 10u);
    }
  }
}

TEST_F(Fed, TracksAreDrawnOnTheirImage) {
  Recorder<sensor_msgs::Image> tracks("fed/track_image");
  ASSERT_TRUE(feedUntil([&] { return !tracks.messages.empty(); }));
  const sensor_msgs::Image& image = *tracks.messages.back();
  EXPECT_EQ(image.width, 640u);
  EXPECT_EQ(image.header.frame_id, "camera");
  EXPECT_EQ(image.header.stamp, ros::Time(9.0));
  const std::uint8_t* dot = &image.data[200 * image.step + 100 * 3];
  EXPECT_GT(std::max(dot[1], dot[2]), 130) << "the track at (100, 200)";
  const std::uint8_t* beside = &image.data[100 * image.step + 300 * 3];
  EXPECT_EQ(beside[0], 90) << "the image";
}

TEST_F(Fed, ALandmarkIsAsBrightAsItsImage) {
  Recorder<sensor_msgs::PointCloud2> cloud("fed/landmarks");
  ASSERT_TRUE(feedUntil([&] { return cloud.messages.size() >= 2; }));
  EXPECT_EQ(cloud.messages.back()->header.frame_id, "map");
  EXPECT_EQ(cloud.messages.back()->width, 4u);
}

/// The nodelet with a simulated camera, seen by a viewer that stays for the whole run.
struct Run {
  Recorder<MarkerArray> markers{"/selfcal/markers"};
  Recorder<sensor_msgs::PointCloud2> cloud{"/selfcal/landmarks"};
  Recorder<sensor_msgs::Image> tracks{"/selfcal/track_image"};
  Recorder<sensor_msgs::Image> chart{"/selfcal/convergence"};
  Recorder<std_msgs::Header> finished{"/simulated_camera/truth/finished"};
  std::unique_ptr<Recorder<sensor_msgs::Image>> source;

  bool listenToTheEnd() {
    const auto connected = [this] {
      return markers.connected() && cloud.connected() && tracks.connected() && chart.connected() &&
             finished.connected();
    };
    if (!spinUntil(connected, 30.0)) return false;
    spinUntil([] { return false; }, 0.5);  // until the nodelet has noticed
    source = std::make_unique<Recorder<sensor_msgs::Image>>("/simulated_camera/image_raw");
    if (!spinUntil([this] { return !finished.messages.empty(); }, 60.0)) return false;
    spinUntil([] { return false; }, 1.5);
    return true;
  }
};

const Run& run() {
  static Run recorded;
  static const bool done = recorded.listenToTheEnd();
  if (!done) ADD_FAILURE() << "not all topics were there, or the camera did not finish in time";
  return recorded;
}

TEST(Nodelet, MarkersShowTheRun) {
  ASSERT_FALSE(run().markers.messages.empty());
  std::map<std::string, Marker> last;
  for (const Marker& marker : run().markers.messages.back()->markers) last[marker.ns] = marker;
  EXPECT_GT(last["trajectory"].points.size(), 20u);
  EXPECT_EQ(last["keyframes"].points.size(), last["trajectory"].points.size());
  EXPECT_GT(last["window"].points.size(), 20u);
  EXPECT_GT(last["queue"].points.size(), 4u);
  EXPECT_GT(last["frustum"].points.size(), 90u);
  EXPECT_EQ(last["frustum"].header.frame_id, "selfcal_map");
  EXPECT_EQ(last["queue"].colors.size(), last["queue"].points.size());
}

TEST(Nodelet, LandmarksSurroundTheCamera) {
  ASSERT_FALSE(run().cloud.messages.empty());
  EXPECT_GT(run().cloud.messages.back()->width, 150u);
}

TEST(Nodelet, TracksCarryTheStampsOfImages) {
  std::set<ros::Time> stamps;
  for (const auto& image : run().source->messages) stamps.insert(image->header.stamp);
  ASSERT_GT(run().tracks.messages.size(), 5u);
  for (const auto& image : run().tracks.messages) {
    EXPECT_EQ(stamps.count(image->header.stamp), 1u);
    EXPECT_EQ(image->header.frame_id, "simulated_camera");
  }
}

TEST(Nodelet, TheChartShowsValuesBandsAndState) {
  ASSERT_FALSE(run().chart.messages.empty());
  const sensor_msgs::Image& chart = *run().chart.messages.back();
  EXPECT_GT(count(chart, palette(Theme::kDark).band), 1000);
  EXPECT_GT(count(chart, palette(Theme::kDark).curve), 100);
  EXPECT_GT(count(chart, stateColour(CalibrationState::kInitializing)), 20);
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "visual_test");
  ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
