#include "camera_self_calibration/map/map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

const Camera kCamera = camera640(CameraModel::kFov, {320, 322, 316, 243, 0.95});

// A camera that moves along a row of points; tracks of known truth.
class MapTest : public testing::Test {
 protected:
  static Rigid3 poseAt(int k) {
    return {expSo3({0.03 * k, -0.04 * k, 0.02 * k}), Eigen::Vector3d(0.1 * k, 0.05 * k, -0.02 * k)};
  }

  static Eigen::Vector3d pointAt(std::int64_t id) {
    Random random(static_cast<std::uint64_t>(id) + 1);
    return {random.uniform(-1.5, 1.5), random.uniform(-1.0, 1.0), random.uniform(2.0, 5.0)};
  }

  static Eigen::Vector2d pixelOf(std::int64_t id, int k) {
    Eigen::Vector2d pixel(NAN, NAN);
    EXPECT_TRUE(kCamera.project(poseAt(k).inverse() * pointAt(id), &pixel));
    return pixel;
  }

  static Track trackOf(std::int64_t id, int k, int detected_at) {
    return {id, pixelOf(id, k), pixelOf(id, detected_at), 0.2};
  }

  static Keyframe keyframeAt(int k) {
    Keyframe keyframe;
    keyframe.id = k;
    keyframe.stamp_ns = 1000 * k;
    keyframe.world_from_camera = poseAt(k);
    return keyframe;
  }

  // Keyframes `first` to `end` - 1, which all see tracks 0 to `count` - 1, detected in keyframe 0.
  static void addKeyframes(int first, int end, int count, Map* map) {
    for (int k = first; k < end; ++k) {
      std::vector<Track> tracks;
      for (int id = 0; id < count; ++id) tracks.push_back(trackOf(id, k, 0));
      map->addKeyframe(keyframeAt(k), tracks, 0.3, kCamera);
    }
  }

  // Where the map has a point.
  static Eigen::Vector3d pointIn(const Map& map, std::int64_t id) {
    const auto point = map.worldPoint(map.points().at(id), kCamera);
    if (!point) return Eigen::Vector3d::Constant(NAN);
    return point->origin + point->direction / point->inverse_depth;
  }

  static void setTrueDepths(Map* map) {
    Segment segment = map->segmentFrom(0, kCamera);
    for (Landmark& landmark : segment.landmarks) {
      const Rigid3& reference = segment.keyframes[landmark.reference].world_from_camera;
      landmark.inverse_depth = 1.0 / (reference.inverse() * pointAt(landmark.track_id)).norm();
    }
    map->update(segment);
  }
};

TEST_F(MapTest, StaysBounded) {
  Map map(5);
  for (int k = 0; k < 50; ++k) {
    std::vector<Track> tracks;
    for (int id = std::max(0, k - 3); id <= k; ++id) tracks.push_back(trackOf(id, k % 8, id % 8));
    map.addKeyframe(keyframeAt(k), tracks, 0.3, kCamera);
    EXPECT_LE(map.keyframes().size(), 5u);
    EXPECT_LE(map.points().size(), 4u + 5u);  // seen in one of the five keyframes
    for (const auto& [id, point] : map.points()) {
      EXPECT_NE(map.keyframe(point.anchor_id), nullptr);
      EXPECT_NE(sightingIn(point, point.anchor_id), nullptr);
      EXPECT_LE(point.sightings.size(), 5u);
    }
  }
  EXPECT_EQ(map.keyframes().front().id, 45);
  EXPECT_EQ(map.keyframe(44), nullptr);
  EXPECT_EQ(map.keyframe(46)->stamp_ns, 46000);
}

TEST_F(MapTest, TransferKeepsThePoint) {
  const Eigen::Vector3d point = pointAt(3);
  const Rigid3 a = poseAt(1), b = poseAt(7);
  const Eigen::Vector3d in_a = a.inverse() * point;
  const double rho = transferInverseDepth(a, in_a.normalized(), 1.0 / in_a.norm(), b);
  EXPECT_NEAR(rho, 1.0 / (b.inverse() * point).norm(), 1e-14);
  EXPECT_EQ(transferInverseDepth(a, in_a.normalized(), 0.0, b), 0.0);  // at infinity from anywhere
}

TEST_F(MapTest, SeenFromAnObserver) {
  const Eigen::Vector3d origin(1.0, -2.0, 0.5), observer(-0.3, 0.4, 0.7);
  const Eigen::Vector3d offset = pointAt(2) - origin;
  const WorldPoint point{offset.normalized(), origin, 1.0 / offset.norm()};
  const Eigen::Vector3d expected = pointAt(2) - observer;
  EXPECT_LT((directionFrom(point, observer).normalized() - expected.normalized()).norm(), 1e-14);
  EXPECT_NEAR(inverseDistance(point, observer), 1.0 / expected.norm(), 1e-14);
  const WorldPoint far{offset.normalized(), origin, 0.0};
  EXPECT_EQ(directionFrom(far, observer), far.direction);  // the same from anywhere
  EXPECT_EQ(inverseDistance(far, observer), 0.0);
}

TEST_F(MapTest, ReanchoringKeepsPoints) {
  Map map(3);
  addKeyframes(0, 3, 20, &map);
  setTrueDepths(&map);
  for (int k = 3; k < 8; ++k) {
    addKeyframes(k, k + 1, 20, &map);
    for (int id = 0; id < 20; ++id) {
      EXPECT_EQ(map.points().at(id).anchor_id, k - 2);
      EXPECT_LT((pointIn(map, id) - pointAt(id)).norm(), 1e-9) << "keyframe " << k;
    }
  }
}

TEST_F(MapTest, SegmentHoldsInheritedAndAnchoredLandmarks) {
  Map map(10, true);
  // 0: from the first keyframe on; 1: from the second on; 2: detected before the map began; 3: seen
  // in the last keyframe alone; 4: seen only in the first.
  map.addKeyframe(keyframeAt(0), {trackOf(0, 0, 0), trackOf(4, 0, 0)}, 0.3, kCamera);
  map.addKeyframe(keyframeAt(1), {trackOf(0, 1, 0), trackOf(1, 1, 1)}, 0.3, kCamera);
  map.addKeyframe(keyframeAt(2), {trackOf(0, 2, 0), trackOf(1, 2, 1), trackOf(2, 2, 7)}, 0.3,
                  kCamera);
  map.addKeyframe(keyframeAt(3),
                  {trackOf(0, 3, 0), trackOf(1, 3, 1), trackOf(2, 3, 7), trackOf(3, 3, 3)}, 0.3,
                  kCamera);

  const Segment whole = map.segmentFrom(0, kCamera);
  ASSERT_EQ(whole.landmarks.size(), 3u);
  EXPECT_TRUE(whole.landmarks[0].anchored);
  EXPECT_TRUE(whole.landmarks[1].anchored);
  EXPECT_FALSE(whole.landmarks[2].anchored);
  EXPECT_EQ(whole.landmarks[1].reference, 1);
  EXPECT_EQ(whole.landmarks[2].reference, 2);
  // Anchored ones have no residual in their reference keyframe, inherited ones do.
  ASSERT_EQ(whole.observations.size(), 3u + 2u + 2u);
  EXPECT_EQ(whole.observations[0].keyframe, 1);
  EXPECT_EQ(whole.observations[5].keyframe, 2);
  EXPECT_EQ(whole.observations[5].landmark, 2);

  const Segment last = map.lastKeyframes(2, kCamera);
  ASSERT_EQ(last.keyframes.size(), 2u);
  EXPECT_EQ(last.keyframes.front().id, 2);
  EXPECT_EQ(last.sequence, 3);
  ASSERT_EQ(last.landmarks.size(), 3u);
  for (const Landmark& landmark : last.landmarks) {
    EXPECT_FALSE(landmark.anchored);
    EXPECT_EQ(landmark.reference, 0);
    const Eigen::Vector3d seen = *kCamera.unproject(pixelOf(landmark.track_id, 2));
    EXPECT_LT((landmark.bearing - seen).norm(), 1e-12);
  }
  EXPECT_EQ(last.observations.size(), 6u);
  EXPECT_EQ(map.lastKeyframes(99, kCamera).keyframes.size(), 4u);

  // As if the newest keyframe were not there yet.
  const Segment before = map.lastKeyframes(3, kCamera, 1);
  ASSERT_EQ(before.keyframes.size(), 3u);
  EXPECT_EQ(before.keyframes.back().id, 2);
  EXPECT_EQ(before.sequence, 2);
  ASSERT_EQ(before.landmarks.size(), 2u) << "others are seen once until then";
  EXPECT_EQ(before.observations.size(), 2u + 1u);
  EXPECT_TRUE(map.lastKeyframes(3, kCamera, 4).keyframes.empty());
  EXPECT_TRUE(map.segmentFrom(4, kCamera).keyframes.empty());
}

// By default the reference pixel is a measurement like the others.
TEST_F(MapTest, SegmentEstimatesAllRaysUnlessReferencesAreExact) {
  Map map(10), exact(10, true);
  for (int k = 0; k < 3; ++k) {
    map.addKeyframe(keyframeAt(k), {trackOf(0, k, 0), trackOf(1, k, 7)}, 0.3, kCamera);
    exact.addKeyframe(keyframeAt(k), {trackOf(0, k, 0), trackOf(1, k, 7)}, 0.3, kCamera);
  }
  const Segment segment = map.segmentFrom(0, kCamera);
  ASSERT_EQ(segment.landmarks.size(), 2u);
  EXPECT_FALSE(segment.landmarks[0].anchored);
  ASSERT_EQ(segment.observations.size(), 6u);
  EXPECT_EQ(segment.observations[0].keyframe, 0);
  EXPECT_EQ(segment.observations[0].pixel, segment.landmarks[0].reference_pixel);
  const Segment exact_segment = exact.segmentFrom(0, kCamera);
  EXPECT_TRUE(exact_segment.landmarks[0].anchored);
  EXPECT_FALSE(exact_segment.landmarks[1].anchored);
  EXPECT_EQ(exact_segment.observations.size(), 5u);
}

TEST_F(MapTest, SegmentObservationsAreThoseSeen) {
  Map map(10);
  addKeyframes(0, 4, 6, &map);
  const Segment segment = map.segmentFrom(1, kCamera);
  ASSERT_EQ(segment.observations.size(), 18u);
  int last_landmark = 0;
  for (const Observation& observation : segment.observations) {
    EXPECT_GE(observation.landmark, last_landmark);  // grouped
    last_landmark = observation.landmark;
    const auto id = segment.landmarks[observation.landmark].track_id;
    EXPECT_EQ(observation.pixel, pixelOf(id, observation.keyframe + 1));
    EXPECT_EQ(observation.sigma, 0.2);
  }
}

TEST_F(MapTest, UpdateTakesSolutionsBack) {
  Map map(10);
  addKeyframes(0, 4, 6, &map);
  Segment segment = map.lastKeyframes(2, kCamera);
  segment.keyframes[1].world_from_camera.translation.x() += 0.25;
  segment.keyframes[1].calibration_generation = 7;
  segment.landmarks[0].inverse_depth = 0.77;
  map.update(segment);
  EXPECT_EQ(map.keyframe(3)->calibration_generation, 7u);
  EXPECT_EQ(map.keyframe(3)->world_from_camera.translation.x(), 0.3 + 0.25);
  EXPECT_EQ(map.keyframe(1)->calibration_generation, 0u);
  EXPECT_EQ(map.points().at(0).anchor_id, 2);
  EXPECT_EQ(map.points().at(0).inverse_depth, 0.77);
  const Segment again = map.lastKeyframes(2, kCamera);
  EXPECT_NEAR(again.landmarks[0].inverse_depth, 0.77, 1e-15);
}

// A solution may arrive when the map has moved on: its first keyframes have gone since, and so has
// a point, which may even have come back under the same track.
TEST_F(MapTest, UpdateFromAnOlderSegmentKeepsPointsWhole) {
  Map map(4);
  addKeyframes(0, 4, 6, &map);
  setTrueDepths(&map);
  const Segment old = map.segmentFrom(0, kCamera);
  map.removePoints({5});
  addKeyframes(4, 6, 6, &map);
  map.update(old);
  for (const auto& [id, point] : map.points()) {
    EXPECT_NE(map.keyframe(point.anchor_id), nullptr) << id;
    EXPECT_NE(sightingIn(point, point.anchor_id), nullptr) << id;
    if (id == 5) continue;  // came back with a guessed depth
    EXPECT_LT((pointIn(map, id) - pointAt(id)).norm(), 1e-9) << id;
  }
}

TEST_F(MapTest, TypicalInverseDepth) {
  Map map(10);
  EXPECT_EQ(map.typicalInverseDepthAt(0, kCamera), 1.0);
  std::vector<double> depths;
  addKeyframes(0, 2, 7, &map);
  setTrueDepths(&map);
  for (int id = 0; id < 7; ++id) {
    depths.push_back(1.0 / (poseAt(1).inverse() * pointAt(id)).norm());
  }
  std::sort(depths.begin(), depths.end());
  EXPECT_NEAR(map.typicalInverseDepthAt(1, kCamera), depths[3], 1e-9);
}

// In rotation on the spot most inverse depths are noise, of either sign.
TEST_F(MapTest, TypicalInverseDepthIsASize) {
  Map map(10);
  addKeyframes(0, 2, 7, &map);
  Segment segment = map.segmentFrom(0, kCamera);
  for (Landmark& landmark : segment.landmarks) {
    landmark.inverse_depth = landmark.track_id < 4 ? -1e-3 : 1e-3;
  }
  map.update(segment);
  EXPECT_NEAR(map.typicalInverseDepthAt(0, kCamera), 1e-3, 1e-9);
}

TEST_F(MapTest, MedianOfASegment) {
  Segment segment;
  EXPECT_EQ(medianInverseDepth(segment, 0.25), 0.25);
  for (const double depth : {3.0, -1.0, 2.0, -4.0, 0.5}) {
    segment.landmarks.emplace_back();
    segment.landmarks.back().inverse_depth = depth;
  }
  EXPECT_EQ(medianInverseDepth(segment, 0.25), 0.5);
  EXPECT_EQ(typicalInverseDepth(inverseDepths(segment)), 2.0);  // of the sizes
}

TEST_F(MapTest, RemoveAndClear) {
  Map map(10);
  map.addKeyframe(keyframeAt(0), {trackOf(0, 0, 0), trackOf(1, 0, 0)}, 0.3, kCamera);
  map.removePoints({0, 99});
  EXPECT_EQ(map.points().count(0), 0u);
  EXPECT_EQ(map.points().count(1), 1u);
  map.clear();
  EXPECT_TRUE(map.points().empty());
  EXPECT_TRUE(map.keyframes().empty());
}

}  // namespace
}  // namespace camera_self_calibration
