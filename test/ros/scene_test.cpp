#include "camera_self_calibration/ros/scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "ros/scene_sample.h"

namespace camera_self_calibration {
namespace {

TEST(Scene, KeepsKeyframesWithTheirNewestPoses) {
  Scene scene;
  scene.add(0, sceneSegment(0, 10));
  Segment moved = sceneSegment(5, 10);
  moved.keyframes[0].world_from_camera.translation.y() = 7.0;
  scene.add(0, moved);
  ASSERT_EQ(scene.keyframes().size(), 15u);
  EXPECT_EQ(scene.keyframes().at(5).world_from_camera.translation.y(), 7.0);
  EXPECT_DOUBLE_EQ(scene.unit(), 2.0);
}

TEST(Scene, AnotherMapReplacesEverything) {
  Scene scene;
  scene.add(0, sceneSegment(0, 10));
  scene.addLandmarks(sceneCamera(), sceneSegment(0, 10), nullptr);
  scene.add(sceneReport());
  ASSERT_EQ(scene.queue().size(), 2u);
  scene.add(1, sceneSegment(20, 2));
  EXPECT_EQ(scene.keyframes().size(), 2u);
  EXPECT_TRUE(scene.landmarks().empty());
  EXPECT_TRUE(scene.queue().empty());
  FrameResult late;  // of the map before
  late.state = TrackingState::kTracking;
  late.world_from_camera.translation.x() = 3.0;
  scene.add(late);
  EXPECT_EQ(scene.worldFromCamera().translation.x(), 0.0);
}

TEST(Scene, AMapThatIsFoundAgainIsWhole) {
  Scene scene;
  scene.add(0, sceneSegment(0, 10));
  scene.addLandmarks(sceneCamera(), sceneSegment(0, 10), nullptr);
  scene.add(sceneReport());
  scene.add(Event{EventType::kLost, 9000000000LL, 9000000000LL, "lost"});
  scene.add(1, sceneSegment(20, 4));
  EXPECT_TRUE(scene.events().empty()) << "of another map";
  // The window is in the old map already, when the result tells of it.
  Segment found = sceneSegment(22, 3);
  found.keyframes[0].world_from_camera.translation.y() = 5.0;
  scene.add(0, found);
  FrameResult frame;
  frame.state = TrackingState::kTracking;
  frame.map_id = 0;
  frame.moved = MapMove{1, 0, {Rigid3(), 3.0}};
  frame.world_from_camera.translation.x() = 4.0;
  scene.add(frame);
  ASSERT_EQ(scene.keyframes().size(), 15u);
  EXPECT_NEAR(scene.keyframes().at(20).world_from_camera.translation.x(), 6.0, 1e-12);
  EXPECT_EQ(scene.keyframes().at(22).world_from_camera.translation.y(), 5.0) << "known better";
  EXPECT_EQ(scene.landmarks().size(), 4u);
  EXPECT_EQ(scene.queue().size(), 2u);
  EXPECT_EQ(scene.worldFromCamera().translation.x(), 4.0);
  ASSERT_EQ(scene.events().size(), 1u);
  EXPECT_EQ(scene.events()[0].event.type, EventType::kLost);
}

TEST(Scene, EventsStandWhereTheyHappenedAndAreFew) {
  Scene scene;
  scene.add(0, sceneSegment(0, 10));
  for (int i = 0; i < 20; ++i) {
    FrameResult frame;
    frame.state = TrackingState::kTracking;
    frame.world_from_camera.translation.x() = i;
    scene.add(frame);
    scene.add(Event{EventType::kInput, i, i, "input"});
  }
  ASSERT_EQ(scene.events().size(), Scene::kMaxEvents);
  EXPECT_EQ(scene.events().back().position.x(), 19.0);
}

TEST(Scene, TheQueueLiesOnTheTrajectory) {
  Scene scene;
  scene.add(0, sceneSegment(0, 10));
  scene.add(sceneReport());
  const auto queue = scene.queue();
  ASSERT_EQ(queue.size(), 2u);
  ASSERT_EQ(queue[0].positions.size(), 4u);
  EXPECT_NEAR(queue[0].positions.back().x(), 0.3, 1e-12);
  EXPECT_NEAR(queue[1].positions.front().x(), 0.5, 1e-12);
  EXPECT_EQ(queue[0].score, 0.0) << "informs most";
  EXPECT_EQ(queue[1].score, 1.0);
}

TEST(Scene, IsBoundedAndKeepsTheQueueWhole) {
  Scene scene;
  for (std::int64_t first = 0; first < 5000; first += 10) {
    scene.add(0, sceneSegment(first, 10));
    scene.addLandmarks(sceneCamera(), sceneSegment(first, 10), nullptr);
    scene.add(sceneReport());
    ASSERT_LE(scene.keyframes().size(), 2010u);
  }
  EXPECT_EQ(scene.keyframes().rbegin()->first, 4999);
  EXPECT_EQ(scene.keyframes().count(4801), 1u) << "the newest are not thinned out";
  EXPECT_LE(scene.landmarks().size(), 6000u);
  EXPECT_EQ(scene.queue().front().positions.size(), 4u);
}

TEST(Scene, LandmarksStandWhereTheirRaysEnd) {
  std::vector<std::uint8_t> pixels(640 * 480, 10);
  pixels[240 * 640 + 352] = 200;
  ImageView image;
  image.data = pixels.data();
  image.width = image.stride = 640;
  image.height = 480;
  Scene scene;
  const Segment segment = sceneSegment(3, 6);
  scene.add(0, segment);
  scene.addLandmarks(sceneCamera(), segment, &image);
  ASSERT_EQ(scene.landmarks().size(), 4u);
  const Scene::Point& point = scene.landmarks().at(32);
  const Eigen::Vector3d ray = Eigen::Vector3d(0.1, 0.0, 1.0).normalized();
  EXPECT_LT((point.position - (Eigen::Vector3d(0.3, 0.0, 0.0) + 2.0 * ray)).norm(), 1e-9);
  EXPECT_EQ(point.brightness, 200);
  EXPECT_EQ(scene.landmarks().at(30).brightness, 10);
}

TEST(Scene, UncertainLandmarksStayOut) {
  Scene scene;
  Segment segment = sceneSegment(0, 6);
  segment.landmarks[0].inverse_depth = -0.1;
  segment.landmarks[1].inverse_depth = 0.001;
  segment.observations.resize(segment.observations.size() - 4);  // two sightings of the last
  scene.add(0, segment);
  scene.addLandmarks(sceneCamera(), segment, nullptr);
  ASSERT_EQ(scene.landmarks().size(), 1u);
  EXPECT_EQ(scene.landmarks().begin()->first, 2);
  EXPECT_LT(scene.landmarks().begin()->second.brightness, 0);
}

TEST(FieldOfView, IsTheBorderOfTheImage) {
  const auto rays = fieldOfView(sceneCamera(), 8);
  ASSERT_EQ(rays.size(), 32u);
  EXPECT_NEAR(rays[0].x() / rays[0].z(), -1.0, 1e-9);
  EXPECT_NEAR(rays[0].y() / rays[0].z(), -0.75, 1e-9);
  EXPECT_NEAR(rays[8].x() / rays[8].z(), 319.0 / 320.0, 1e-9);
  for (const auto& ray : rays) EXPECT_NEAR(ray.norm(), 1.0, 1e-12);
}

TEST(FieldOfView, GoesInwardsWhereTheBorderHasNoRay) {
  // The distortion folds well inside the image.
  const Camera folded(CameraModel::kRadtan, 640, 480,
                      (Intrinsics(8) << 300, 300, 320, 240, -0.5, 0, 0, 0).finished());
  ASSERT_FALSE(folded.unproject({0.0, 0.0}));
  EXPECT_EQ(fieldOfView(folded, 4).size(), 16u);
  EXPECT_TRUE(fieldOfView(Camera(), 4).empty());
}

}  // namespace
}  // namespace camera_self_calibration
