#include "camera_self_calibration/startup/keyframe_choice.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "camera_self_calibration/startup/growth.h"
#include "camera_self_calibration/startup/startup.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

SimulatedSegment sample(LandmarkOrigin origin, MotionKind motion = MotionKind::kHandheld,
                        int keyframes = 14) {
  SegmentOptions options;
  options.camera = ordinaryCameras()[1];
  options.origin = origin;
  options.motion = motion;
  options.keyframes = keyframes;
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
  std::map<std::int64_t, double> depth;
  for (const Landmark& landmark : batch.landmarks) {
    depth[landmark.track_id] = landmark.inverse_depth;
  }
  for (const Landmark& landmark : both.landmarks) {
    const auto before = depth.find(landmark.track_id);
    if (before != depth.end()) {
      EXPECT_EQ(landmark.inverse_depth, before->second);
    } else {
      EXPECT_GT(landmark.inverse_depth, 0.0);
    }
  }
}

// What is left out takes its observations with it and changes no other prediction.
// History slides on beyond a change of the lens, the batch still reaches back to it.
TEST(Extended, KeyframesKeepTheLensThatTheyWereTakenWith) {
  const SimulatedSegment made = sample(LandmarkOrigin::kInherited);
  Segment changed = made.segment;
  changed.earlier_camera = std::make_shared<const Camera>(made.camera);
  changed.earlier_keyframes = 5;
  std::vector<int> index;
  Segment batch = prefixOf(changed, 9, 1, &index);
  batch = withoutKeyframe(batch, 2);  // one of the earlier lens
  for (int oldest = 3; oldest < 8; ++oldest) {
    Segment history = changed;
    for (int k = 0; k < oldest; ++k) history = withoutKeyframe(history, 0);
    history.earlier_camera = changed.earlier_camera;  // the map still knows of it
    batch = extended(batch, history, made.camera);
    ASSERT_EQ(batch.keyframes.size(), 13u);
    EXPECT_EQ(batch.earlier_keyframes, 4) << oldest;
    EXPECT_EQ(batch.earlier_camera, changed.earlier_camera) << oldest;
  }
}

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

// Half a batch that tells nothing, half that tells much: what tells nothing goes.
TEST(LeastInformative, KeepsWhatTellsTheLens) {
  const SimulatedSegment made = sample(LandmarkOrigin::kInherited, MotionKind::kHandheld, 24);
  const IntrinsicsPrior prior = vaguePrior(made.camera);
  Segment chosen = made.segment, newest = made.segment;
  KeyframeChoiceOptions options;
  options.keep_newest = 6;
  while (chosen.keyframes.size() > 14) {
    chosen = withoutKeyframe(chosen, leastInformative(options, chosen, made.camera, prior));
    newest = withoutKeyframe(newest, 0);
  }
  const auto determinant = [&](Segment segment) {
    Camera camera = made.camera;
    const Problem problem{&camera, true, {freeBlock(&segment, camera)}};
    return std::log(Eigen::MatrixXd(marginalize(problem, 2.0).information).determinant());
  };
  // In nats: 5 would be half the sigma of each parameter.
  EXPECT_GT(determinant(chosen), determinant(newest) + 1.0);
  for (int k = 1; k <= 6; ++k) {
    EXPECT_EQ(chosen.keyframes[14 - k].id, made.segment.keyframes[24 - k].id);
  }
}

}  // namespace
}  // namespace camera_self_calibration
