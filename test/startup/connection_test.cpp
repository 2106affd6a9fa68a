#include "camera_self_calibration/startup/connection.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

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

}  // namespace
}  // namespace camera_self_calibration
