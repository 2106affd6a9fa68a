#include "camera_self_calibration/ros/scene_messages.h"

#include <gtest/gtest.h>
#include <sensor_msgs/point_cloud2_iterator.h>

#include <cmath>

#include "camera_self_calibration/plotting/palette.h"
#include "ros/scene_sample.h"

namespace camera_self_calibration {
namespace {

using visualization_msgs::Marker;

Scene makeScene() {
  Scene scene;
  scene.add(0, sceneSegment(0, 10));
  scene.addLandmarks(sceneCamera(), sceneSegment(0, 10), nullptr);
  scene.add(sceneReport());
  FrameResult frame;
  frame.state = TrackingState::kTracking;
  frame.world_from_camera.translation.x() = 0.95;
  scene.add(frame);
  return scene;
}

Marker markerOf(const Scene& scene, const std::string& name) {
  for (const Marker& marker : toMarkers(scene, "map", ros::Time(5.0)).markers) {
    if (marker.ns == name) return marker;
  }
  ADD_FAILURE() << "no marker " << name;
  return {};
}

bool hasColour(const std_msgs::ColorRGBA& colour, const Colour& bgr) {
  return std::abs(255.0 * colour.b - bgr[0]) < 1.0 && std::abs(255.0 * colour.g - bgr[1]) < 1.0 &&
         std::abs(255.0 * colour.r - bgr[2]) < 1.0;
}

TEST(SceneMessages, EveryMarkerHasFrameAndStamp) {
  const auto array = toMarkers(makeScene(), "map", ros::Time(5.0));
  ASSERT_EQ(array.markers.size(), 6u + Scene::kMaxEvents);
  for (const Marker& marker : array.markers) {
    if (marker.ns == "events") continue;
    EXPECT_EQ(marker.header.frame_id, "map");
    EXPECT_EQ(marker.header.stamp, ros::Time(5.0));
    EXPECT_EQ(marker.action, Marker::ADD) << marker.ns;
    EXPECT_FALSE(marker.points.empty()) << marker.ns;
    EXPECT_NEAR(marker.pose.orientation.w, 1.0, 1e-9);
  }
}

TEST(SceneMessages, TheTrajectoryGoesThroughTheKeyframes) {
  const Marker line = markerOf(makeScene(), "trajectory");
  ASSERT_EQ(line.points.size(), 10u);
  EXPECT_NEAR(line.points[7].x, 0.7, 1e-12);
  EXPECT_EQ(markerOf(makeScene(), "keyframes").points.size(), 10u);
}

TEST(SceneMessages, SegmentsAreColouredByScore) {
  const Marker queue = markerOf(makeScene(), "queue");
  ASSERT_EQ(queue.points.size(), 12u) << "two segments of four keyframes";
  ASSERT_EQ(queue.colors.size(), 12u);
  EXPECT_TRUE(hasColour(queue.colors.front(), scoreColour(0.0)));
  EXPECT_TRUE(hasColour(queue.colors.back(), scoreColour(1.0)));
  EXPECT_NEAR(queue.points.back().x, 0.8, 1e-12);
}

TEST(SceneMessages, TheFrustumShowsTheEstimatedFieldOfView) {
  const Scene scene = makeScene();
  const Marker frustum = markerOf(scene, "frustum");
  EXPECT_NEAR(frustum.pose.position.x, 0.95, 1e-12);
  EXPECT_TRUE(hasColour(frustum.color, stateColour(CalibrationState::kConverged)));
  double widest = 0.0;
  for (const auto& point : frustum.points) {
    if (point.z > 0.0) widest = std::max(widest, std::abs(point.x / point.z));
  }
  EXPECT_NEAR(widest, 1.0, 1e-6) << "f = 320 px, 320 px from the centre to the border";
}

TEST(SceneMessages, EventsAreWordsWhereTheyHappened) {
  Scene scene = makeScene();
  Event change{EventType::kCalibrationChange, 1, 1, "the lens changed"};
  change.magnitude_px = 35.24;
  scene.add(change);
  scene.add(Event{EventType::kConverged, 2, 2, "good"});
  std::vector<Marker> events;
  for (const Marker& marker : toMarkers(scene, "map", ros::Time(5.0)).markers) {
    if (marker.ns == "events") events.push_back(marker);
  }
  ASSERT_EQ(events.size(), Scene::kMaxEvents);
  EXPECT_EQ(events[0].text, "the lens changed by 35 px");
  EXPECT_NEAR(events[0].pose.position.x, 0.95, 1e-12);
  EXPECT_TRUE(hasColour(events[0].color, eventColour(EventType::kCalibrationChange)));
  EXPECT_EQ(events[1].text, "calibrated");
  EXPECT_GT(events[0].pose.position.y - events[1].pose.position.y, events[0].scale.z)
      << "one above the other";
  EXPECT_EQ(events[1].action, Marker::ADD);
  EXPECT_EQ(events[2].action, Marker::DELETE);
}

TEST(SceneMessages, LabelsNeedNoManual) {
  for (const EventType type :
       {EventType::kCalibrationChange, EventType::kHandover, EventType::kConverged,
        EventType::kLost, EventType::kRelocalized, EventType::kInput, EventType::kMountChanged,
        EventType::kNoLongerConverged}) {
    Scene scene = makeScene();
    scene.add(Event{type, 1, 1, "what happened"});
    const std::string text = markerOf(scene, "events").text;
    EXPECT_FALSE(text.empty());
    EXPECT_EQ(text.find(toString(type)), std::string::npos) << text;
  }
}

TEST(SceneMessages, WhatIsEmptyIsTakenAway) {
  for (const Marker& marker : toMarkers(Scene(), "map", ros::Time(5.0)).markers) {
    EXPECT_EQ(marker.action, Marker::DELETE) << marker.ns;
  }
  EXPECT_EQ(toCloud(Scene(), "map", ros::Time(5.0)).width, 0u);
}

TEST(SceneMessages, TheCloudHoldsTheLandmarks) {
  const sensor_msgs::PointCloud2 cloud = toCloud(makeScene(), "map", ros::Time(5.0));
  EXPECT_EQ(cloud.header.frame_id, "map");
  ASSERT_EQ(cloud.width * cloud.height, 4u);
  sensor_msgs::PointCloud2ConstIterator<float> x(cloud, "x");
  EXPECT_NEAR(x[0], 0.0f, 1e-6f);
  EXPECT_NEAR(x[2], 2.0f, 1e-6f);
  sensor_msgs::PointCloud2ConstIterator<std::uint8_t> red(cloud, "r");
  EXPECT_GT(red[0], 100) << "to be seen before a dark background";
}

}  // namespace
}  // namespace camera_self_calibration
