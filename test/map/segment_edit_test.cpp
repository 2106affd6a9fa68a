#include "camera_self_calibration/map/segment_edit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/map/inverse_depth.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

SimulatedSegment sample(LandmarkOrigin origin) {
  SegmentOptions options;
  options.camera = ordinaryCameras()[1];
  options.origin = origin;
  options.keyframes = 14;
  options.tracks.max_features = 60;
  return makeSegment(options, 5);
}

double cost(Segment segment, const Camera& camera) {
  return robustCost(freeBlock(&segment, camera), camera, 0.0);
}

// (track, keyframe id) of all observations.
std::set<std::pair<std::int64_t, std::int64_t>> sightings(const Segment& segment) {
  std::set<std::pair<std::int64_t, std::int64_t>> result;
  for (const Observation& o : segment.observations) {
    result.insert({segment.landmarks[o.landmark].track_id, segment.keyframes[o.keyframe].id});
  }
  return result;
}

// `count` landmarks that `first` refers to and `others` observe.
void share(int count, int first, const std::vector<int>& others, Segment* segment) {
  for (int i = 0; i < count; ++i) {
    Landmark landmark;
    landmark.track_id = static_cast<std::int64_t>(segment->landmarks.size());
    landmark.reference = first;
    const int index = static_cast<int>(segment->landmarks.size());
    segment->landmarks.push_back(landmark);
    for (const int k : others) segment->observations.push_back({index, k, {}, 1.0, {}});
  }
}

Segment withKeyframes(int count) {
  Segment segment;
  segment.keyframes.resize(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) segment.keyframes[static_cast<std::size_t>(k)].id = 100 + k;
  return segment;
}

TEST(PrefixOf, IsWhatTheFirstKeyframesSaw) {
  const SimulatedSegment made = sample(LandmarkOrigin::kMixed);
  std::vector<int> index;
  const Segment prefix = prefixOf(made.segment, 5, 2, &index);
  EXPECT_EQ(prefix.keyframes.size(), 5u);
  ASSERT_EQ(index.size(), prefix.landmarks.size());
  std::vector<int> views(prefix.landmarks.size(), 0);
  for (const Observation& o : prefix.observations) {
    EXPECT_LT(o.keyframe, 5);
    ++views[o.landmark];
  }
  for (std::size_t l = 0; l < prefix.landmarks.size(); ++l) {
    EXPECT_GE(views[l], prefix.landmarks[l].anchored ? 2 : 3);
    EXPECT_EQ(prefix.landmarks[l].track_id, made.segment.landmarks[index[l]].track_id);
  }
  Segment changed = prefix;
  changed.keyframes[2].world_from_camera.translation.x() = 7.0;
  changed.landmarks[0].inverse_depth = 0.123;
  Segment whole = made.segment;
  adoptPrefix(changed, index, &whole);
  EXPECT_EQ(whole.keyframes[2].world_from_camera.translation.x(), 7.0);
  EXPECT_EQ(whole.landmarks[index[0]].inverse_depth, 0.123);
  EXPECT_EQ(whole.keyframes.size(), made.segment.keyframes.size());
}

TEST(Extended, GrowsToTheWholeSegmentAgain) {
  for (const auto origin : {LandmarkOrigin::kAnchored, LandmarkOrigin::kInherited}) {
    const SimulatedSegment made = sample(origin);
    std::vector<int> index;
    Segment batch = prefixOf(made.segment, 2, 1, &index);
    for (int k = 3; k <= 14; ++k) {
      batch = extended(batch, prefixOf(made.segment, k, 1, &index), made.camera);
    }
    EXPECT_EQ(sightings(batch), sightings(made.segment));
    EXPECT_EQ(batch.landmarks.size(), made.segment.landmarks.size());
    EXPECT_EQ(batch.keyframes.size(), 14u);
    for (const Landmark& landmark : batch.landmarks) {
      EXPECT_EQ(landmark.anchored, origin == LandmarkOrigin::kAnchored);
    }
  }
}

TEST(GivenUp, IsWhatHistoryCouldHoldAndDoesNot) {
  for (const auto origin : {LandmarkOrigin::kAnchored, LandmarkOrigin::kInherited}) {
    const SimulatedSegment made = sample(origin);
    std::vector<int> index;
    const Segment batch = prefixOf(made.segment, 10, 1, &index);
    // What is in forgotten keyframes alone is not given up.
    Segment history = newestKeyframes(made.segment, 8);
    ASSERT_LT(history.landmarks.size(), made.segment.landmarks.size());
    EXPECT_TRUE(givenUp(batch, history).empty());
    // One that both hold, and that is seen often in the keyframes that they share.
    int given_up = -1;
    for (std::size_t l = 0; given_up < 0 && l < history.landmarks.size(); ++l) {
      const std::int64_t id = history.landmarks[l].track_id;
      const auto views = std::count_if(
          batch.observations.begin(), batch.observations.end(), [&](const Observation& o) {
            return batch.landmarks[o.landmark].track_id == id && o.keyframe >= 6;
          });
      if (views < 3) continue;
      given_up = 0;
      while (batch.landmarks[given_up].track_id != id) ++given_up;
      removeLandmarks({static_cast<int>(l)}, &history);
    }
    ASSERT_GE(given_up, 0);
    EXPECT_EQ(givenUp(batch, history), std::vector<int>{given_up});
  }
}

TEST(Extended, KeepsWhatIsSolvedAndWhatHistoryForgot) {
  const SimulatedSegment made = sample(LandmarkOrigin::kInherited);
  std::vector<int> index;
  const Segment batch = prefixOf(made.segment, 10, 1, &index);
  // History without the first keyframes and of another scale.
  Segment history = made.segment;
  for (int k = 0; k < 4; ++k) history = withoutKeyframe(history, 0);
  for (Keyframe& keyframe : history.keyframes) keyframe.world_from_camera.translation *= 3.0;
  const Segment both = extended(batch, history, made.camera);
  ASSERT_EQ(both.keyframes.size(), 14u);
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(both.keyframes[k].id, made.segment.keyframes[k].id);
    EXPECT_EQ(both.keyframes[k].world_from_camera.translation,
              made.segment.keyframes[k].world_from_camera.translation);
  }
  const auto known = sightings(batch), all = sightings(both);
  EXPECT_TRUE(std::includes(all.begin(), all.end(), known.begin(), known.end()));
  EXPECT_GT(all.size(), known.size());
  std::map<std::int64_t, double> inverse_depth;
  for (const Landmark& landmark : batch.landmarks) {
    inverse_depth[landmark.track_id] = landmark.inverse_depth;
  }
  for (const Landmark& landmark : both.landmarks) {
    const auto before = inverse_depth.find(landmark.track_id);
    if (before != inverse_depth.end()) {
      EXPECT_EQ(landmark.inverse_depth, before->second);
    } else {
      EXPECT_GT(landmark.inverse_depth, 0.0);
    }
  }
}

// History slides on beyond a change of the lens, the batch still reaches back to it.
TEST(Extended, KeyframesKeepTheLensThatTheyWereTakenWith) {
  const SimulatedSegment made = sample(LandmarkOrigin::kInherited);
  Segment changed = made.segment;
  const Camera earlier = ordinaryCameras()[0];
  setEarlierLens(earlier, 5, &changed);
  std::vector<int> index;
  Segment batch = prefixOf(changed, 9, 1, &index);
  batch = withoutKeyframe(batch, 2);  // one of the earlier lens
  for (int oldest = 3; oldest < 8; ++oldest) {
    Segment history = changed;
    for (int k = 0; k < oldest; ++k) history = withoutKeyframe(history, 0);
    batch = extended(batch, history, made.camera);
    ASSERT_EQ(batch.keyframes.size(), 13u);
    EXPECT_EQ(earlierKeyframes(batch), 4) << oldest;
    EXPECT_EQ(batch.cameraOf(3, made.camera).model(), earlier.model()) << oldest;
    EXPECT_EQ(batch.cameraOf(3, made.camera).parameters(), earlier.parameters()) << oldest;
    EXPECT_FALSE(batch.isLensHeld(4)) << oldest;
  }
}

// What says nothing of the present lens cannot say since when it is.
TEST(Extended, AHistoryOfTheEarlierLensAloneDatesNoChange) {
  const SimulatedSegment made = sample(LandmarkOrigin::kInherited);
  std::vector<int> index;
  const Segment batch = prefixOf(made.segment, 9, 1, &index);
  Segment history = made.segment;
  setEarlierLens(ordinaryCameras()[0], 14, &history);
  const Segment both = extended(batch, history, made.camera);
  ASSERT_EQ(both.keyframes.size(), 14u);
  EXPECT_EQ(earlierKeyframes(both), 0);
}

// What is left out takes its observations with it and changes no other prediction.
TEST(WithoutKeyframe, LeavesTheRestAsItWas) {
  for (const auto origin : {LandmarkOrigin::kAnchored, LandmarkOrigin::kInherited}) {
    SimulatedSegment made = sample(origin);
    for (Observation& o : made.segment.observations) {  // without noise, as the truth predicts it
      const Keyframe& keyframe = made.segment.keyframes[o.keyframe];
      ASSERT_TRUE(made.camera.project(
          keyframe.world_from_camera.inverse() * made.points[o.landmark], &o.pixel));
    }
    for (const int k : {0, 6, 13}) {
      const Segment rest = withoutKeyframe(made.segment, k);
      EXPECT_EQ(rest.keyframes.size(), 13u);
      EXPECT_GT(rest.landmarks.size(), made.segment.landmarks.size() / 2);
      for (const auto& [track, keyframe] : sightings(rest)) {
        EXPECT_NE(keyframe, made.segment.keyframes[k].id);
      }
      EXPECT_LT(cost(rest, made.camera), 1e-6 + 1e-12 * cost(made.segment, made.camera)) << k;
    }
  }
}

TEST(NewestKeyframes, AreTheLastOrAll) {
  const Segment segment = sample(LandmarkOrigin::kMixed).segment;
  const Segment newest = newestKeyframes(segment, 5);
  ASSERT_EQ(newest.keyframes.size(), 5u);
  for (int k = 0; k < 5; ++k) EXPECT_EQ(newest.keyframes[k].id, segment.keyframes[9 + k].id);
  EXPECT_FALSE(newest.landmarks.empty());
  EXPECT_EQ(newestKeyframes(segment, 20).keyframes.size(), 14u);
}

TEST(PartsOfPresentLens, ShareNoKeyframe) {
  const SimulatedSegment made = sample(LandmarkOrigin::kMixed);
  Segment segment = made.segment;
  setEarlierLens(made.camera, 4, &segment);
  const std::vector<Segment> parts = partsOfPresentLens(segment, 2);
  ASSERT_EQ(parts.size(), 2u);
  for (int part = 0; part < 2; ++part) {
    ASSERT_EQ(parts[part].keyframes.size(), 5u);
    EXPECT_EQ(parts[part].keyframes.front().id, segment.keyframes[4 + 5 * part].id);
    EXPECT_FALSE(parts[part].isLensHeld(0));
    EXPECT_FALSE(parts[part].landmarks.empty());
  }
}

TEST(Connection, GoesByWayOfOthers) {
  Segment segment = withKeyframes(4);
  share(kConnectingLandmarks, 0, {2}, &segment);
  share(kConnectingLandmarks, 1, {3}, &segment);
  EXPECT_EQ(connectedComponents(segment), (std::vector<int>{0, 1, 0, 1}));
  share(kConnectingLandmarks, 0, {1}, &segment);
  EXPECT_EQ(connectedComponents(segment), (std::vector<int>{0, 0, 0, 0}));
}

TEST(Connection, TakesSeveralLandmarks) {
  Segment segment = withKeyframes(2);
  share(kConnectingLandmarks - 1, 0, {1}, &segment);
  EXPECT_EQ(connectedComponents(segment), (std::vector<int>{0, 1}));
  share(1, 0, {1}, &segment);
  EXPECT_EQ(connectedComponents(segment), (std::vector<int>{0, 0}));
}

TEST(Connection, CountsInheritedLandmarksOnce) {
  Segment segment = withKeyframes(2);
  share(kConnectingLandmarks, 0, {0, 1}, &segment);  // observed in their reference too
  for (Landmark& landmark : segment.landmarks) landmark.anchored = false;
  EXPECT_EQ(connectedComponents(segment), (std::vector<int>{0, 0}));
  segment.landmarks.pop_back();
  segment.observations.resize(segment.observations.size() - 2);
  EXPECT_EQ(connectedComponents(segment), (std::vector<int>{0, 1}));
}

TEST(Connection, KeepsWhatIsConnectedToTheNewest) {
  Segment segment = withKeyframes(5);
  share(20, 0, {1, 3}, &segment);
  share(10, 2, {4}, &segment);
  share(2, 0, {4}, &segment);
  const Segment connected = connectedToNewest(segment);
  ASSERT_EQ(connected.keyframes.size(), 2u);
  EXPECT_EQ(connected.keyframes[0].id, 102);
  EXPECT_EQ(connected.keyframes[1].id, 104);
  EXPECT_EQ(connected.landmarks.size(), 10u);
  EXPECT_EQ(connected.observations.size(), 10u);
  for (const Observation& observation : connected.observations) EXPECT_EQ(observation.keyframe, 1);
}

TEST(Connection, LeavesAConnectedSegmentAsItIs) {
  Segment segment = withKeyframes(3);
  share(8, 0, {1, 2}, &segment);
  share(1, 1, {}, &segment);  // seen once
  EXPECT_EQ(connectedToNewest(segment).landmarks.size(), 9u);
  EXPECT_TRUE(connectedToNewest(Segment()).keyframes.empty());
}

TEST(Restarted, TakesPosesAndLandmarksThatAreKnown) {
  const Segment segment = sample(LandmarkOrigin::kMixed).segment;
  Segment start = perturbed(segment, SegmentPerturbation(), 1);
  start.landmarks[1].reference += 1;  // its depth is that of another ray
  removeLandmarks({2}, &start);
  const Segment again = restarted(segment, start);
  EXPECT_EQ(sightings(again), sightings(segment));
  for (std::size_t k = 0; k < segment.keyframes.size(); ++k) {
    EXPECT_EQ(again.keyframes[k].world_from_camera.translation,
              start.keyframes[k].world_from_camera.translation);
  }
  EXPECT_EQ(again.landmarks[0].inverse_depth, start.landmarks[0].inverse_depth);
  EXPECT_EQ(again.landmarks[1].inverse_depth, segment.landmarks[1].inverse_depth);
  EXPECT_EQ(again.landmarks[2].inverse_depth, segment.landmarks[2].inverse_depth);
  EXPECT_EQ(again.landmarks[3].inverse_depth, start.landmarks[2].inverse_depth);
}

TEST(RemoveLandmarks, KeepsTheOthersWhole) {
  const Segment before = sample(LandmarkOrigin::kMixed).segment;
  Segment after = before;
  removeLandmarks({0, 7, 3}, &after);
  EXPECT_EQ(after.landmarks.size(), before.landmarks.size() - 3);
  std::size_t next = 0;
  for (const Observation& o : before.observations) {
    if (o.landmark == 0 || o.landmark == 7 || o.landmark == 3) continue;
    ASSERT_LT(next, after.observations.size());
    const Observation& kept = after.observations[next++];
    EXPECT_EQ(kept.pixel, o.pixel);
    EXPECT_EQ(kept.keyframe, o.keyframe);
    EXPECT_EQ(after.landmarks[kept.landmark].track_id, before.landmarks[o.landmark].track_id);
  }
  EXPECT_EQ(next, after.observations.size());
  removeLandmarks({}, &after);
  EXPECT_EQ(next, after.observations.size());
  std::vector<int> all(after.landmarks.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  removeLandmarks(all, &after);
  EXPECT_TRUE(after.landmarks.empty());
  EXPECT_TRUE(after.observations.empty());
}

// The unit of the map changes, and nothing that is seen.
TEST(KeepPoseAndScale, MovesAndScalesTheWhole) {
  const SimulatedSegment made = sample(LandmarkOrigin::kMixed);
  const Rigid3 pose{expSo3({0.3, -0.2, 0.5}), Eigen::Vector3d(4.0, -1.0, 2.0)};
  Segment moved = made.segment;
  keepPoseAndScale(6, pose, 0.7, &moved);
  const Rigid3& kept = moved.keyframes[6].world_from_camera;
  EXPECT_LT((kept.translation - pose.translation).norm(), 1e-9);
  EXPECT_LT(kept.rotation.angularDistance(pose.rotation), 1e-9);
  EXPECT_NEAR(typicalInverseDepthAt(6, moved), 0.7, 1e-9);
  const double before = cost(made.segment, made.camera);
  EXPECT_NEAR(cost(moved, made.camera), before, 1e-6 * before);
}

}  // namespace
}  // namespace camera_self_calibration
