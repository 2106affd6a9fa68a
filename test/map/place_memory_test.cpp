#include "camera_self_calibration/map/place_memory.h"

#include <gtest/gtest.h>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

const Camera kCamera = camera640(CameraModel::kFov, {320, 322, 316, 243, 0.95});
constexpr int kPoints = 20;

Rigid3 poseAt(double step) {
  return {expSo3({0.02 * step, -0.03 * step, 0.01 * step}),
          Eigen::Vector3d(0.1 * step, 0.04 * step, -0.02 * step)};
}

Keyframe keyframeAt(std::int64_t id, const Rigid3& pose) {
  Keyframe keyframe;
  keyframe.id = id;
  keyframe.stamp_ns = 1000 * id;
  keyframe.world_from_camera = pose;
  return keyframe;
}

Eigen::Vector3d pointAt(std::int64_t id) {
  Random random(static_cast<std::uint64_t>(id) + 1);
  return {random.uniform(-1.0, 1.0), random.uniform(-0.7, 0.7), random.uniform(2.0, 5.0)};
}

// The first byte tells whose it is.
std::vector<Appearance> appearances() {
  std::vector<Appearance> result(kPoints + 1);
  for (int id = 0; id < kPoints; ++id) {
    result[id].track_id = id;
    result[id].descriptor[0] = static_cast<std::uint8_t>(id);
  }
  return result;  // the last is a corner without a track
}

// Keyframes 0 to 4 of a map that knows the depths of all points.
Map mapOfFive() {
  Map map(10);
  for (int k = 0; k < 5; ++k) {
    std::vector<Track> tracks;
    for (int id = 0; id < kPoints; ++id) {
      Eigen::Vector2d now, first;
      EXPECT_TRUE(kCamera.project(poseAt(k).inverse() * pointAt(id), &now));
      EXPECT_TRUE(kCamera.project(poseAt(0).inverse() * pointAt(id), &first));
      tracks.push_back({id, now, first, 0.2});
    }
    map.addKeyframe(keyframeAt(k, poseAt(k)), tracks, 0.3, kCamera);
  }
  Segment segment = map.segmentFrom(0, kCamera);
  for (Landmark& landmark : segment.landmarks) {
    const Rigid3& reference = segment.keyframes[landmark.reference].world_from_camera;
    landmark.inverse_depth = 1.0 / (reference.inverse() * pointAt(landmark.track_id)).norm();
  }
  map.update(segment);
  return map;
}

Eigen::Vector3d positionOf(const PlacePoint& point) {
  return point.origin + point.direction / point.inverse_depth;
}

TEST(PlaceMemory, RemembersTracksInOrderAndNoOtherCorners) {
  PlaceMemory memory(10);
  memory.add(7, keyframeAt(2, poseAt(2)), appearances());
  ASSERT_EQ(memory.places().size(), 1u);
  const Place& place = memory.places().front();
  EXPECT_EQ(place.map_id, 7u);
  EXPECT_EQ(place.keyframe_id, 2);
  ASSERT_EQ(place.points.size(), static_cast<std::size_t>(kPoints));
  ASSERT_EQ(place.descriptors.size(), place.points.size());
  for (int id = 0; id < kPoints; ++id) {
    EXPECT_EQ(place.points[id].track_id, id);
    EXPECT_EQ(place.descriptors[id][0], id);
    EXPECT_FALSE(place.points[id].known);
  }
}

TEST(PlaceMemory, ForgetsTheOldestWhenFull) {
  PlaceMemory memory(3);
  for (int k = 0; k < 10; ++k) memory.add(1, keyframeAt(k, poseAt(20.0 * k)), appearances());
  ASSERT_EQ(memory.places().size(), 3u);
  EXPECT_EQ(memory.places().front().keyframe_id, 7);
  EXPECT_EQ(memory.places().back().keyframe_id, 9);
}

// Who stands still remembers one view, the newest, and what was seen elsewhere is not lost for it.
TEST(PlaceMemory, OneViewOfAMapTakesThePlaceOfNearlyTheSame) {
  PlaceMemory memory(3);
  memory.add(1, keyframeAt(0, poseAt(100.0)), appearances());
  for (int k = 1; k < 10; ++k) memory.add(1, keyframeAt(k, poseAt(0.01 * k)), appearances());
  ASSERT_EQ(memory.places().size(), 2u);
  EXPECT_EQ(memory.places().front().keyframe_id, 0);
  EXPECT_EQ(memory.places().back().keyframe_id, 9);
  // The same pose in another map is another place.
  memory.add(2, keyframeAt(10, poseAt(0.09)), appearances());
  EXPECT_EQ(memory.places().size(), 3u);
}

TEST(PlaceMemory, TakesPosesAndDepthsFromTheMap) {
  PlaceMemory memory(10);
  memory.add(1, keyframeAt(2, Rigid3()), appearances());
  memory.add(2, keyframeAt(2, Rigid3()), appearances());
  memory.refresh(1, mapOfFive(), kCamera);
  const Place& place = memory.places().front();
  EXPECT_LT((place.world_from_camera.translation - poseAt(2).translation).norm(), 1e-12);
  double nearest = 1e9, farthest = 0.0;
  for (const PlacePoint& point : place.points) {
    ASSERT_TRUE(point.known);
    EXPECT_LT((positionOf(point) - pointAt(point.track_id)).norm(), 1e-6);
    const double distance = (pointAt(point.track_id) - poseAt(2).translation).norm();
    nearest = std::min(nearest, distance);
    farthest = std::max(farthest, distance);
  }
  EXPECT_GT(1.0 / place.inverse_depth, nearest);
  EXPECT_LT(1.0 / place.inverse_depth, farthest);
  EXPECT_FALSE(memory.places().back().points.front().known);  // of another map
}

// A keyframe that has left the map keeps what was last known of it.
TEST(PlaceMemory, OutlivesItsKeyframe) {
  PlaceMemory memory(10);
  memory.add(1, keyframeAt(2, Rigid3()), appearances());
  memory.refresh(1, mapOfFive(), kCamera);
  memory.refresh(1, Map(10), kCamera);
  EXPECT_TRUE(memory.places().front().points.front().known);
  EXPECT_LT((memory.places().front().world_from_camera.translation - poseAt(2).translation).norm(),
            1e-12);
}

TEST(PlaceMemory, MovesAMapIntoAnother) {
  PlaceMemory memory(10);
  memory.add(1, keyframeAt(2, Rigid3()), appearances());
  memory.add(3, keyframeAt(9, poseAt(50.0)), appearances());
  memory.refresh(1, mapOfFive(), kCamera);
  const double inverse_depth = memory.places().front().inverse_depth;
  const Similarity3 new_from_old{{Eigen::Quaterniond(expSo3({0.3, 0.2, -0.1})), {1, 2, 3}}, 2.5};
  memory.move(1, 3, new_from_old);
  for (const Place& place : memory.places()) EXPECT_EQ(place.map_id, 3u);
  const Place& moved = memory.places().front();
  EXPECT_LT((moved.world_from_camera.translation - new_from_old * poseAt(2).translation).norm(),
            1e-12);
  EXPECT_NEAR(moved.inverse_depth, inverse_depth / 2.5, 1e-12);
  for (const PlacePoint& point : moved.points) {
    EXPECT_LT((positionOf(point) - new_from_old * pointAt(point.track_id)).norm(), 1e-6);
  }
  EXPECT_EQ(memory.places().back().world_from_camera.translation, poseAt(50.0).translation);
}

TEST(PlaceMemory, KnowsWhichMapsItHas) {
  PlaceMemory memory(10);
  EXPECT_FALSE(memory.knowsMapBefore(5));
  memory.add(5, keyframeAt(0, Rigid3()), appearances());
  EXPECT_FALSE(memory.knowsMapBefore(5));
  EXPECT_TRUE(memory.knowsMapBefore(6));
  memory.add(6, keyframeAt(1, Rigid3()), appearances());
  memory.keepOnly(6);
  ASSERT_EQ(memory.places().size(), 1u);
  EXPECT_EQ(memory.places().front().map_id, 6u);
  EXPECT_FALSE(memory.knowsMapBefore(6));
}

}  // namespace
}  // namespace camera_self_calibration
