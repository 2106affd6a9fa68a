#include "camera_self_calibration/estimation/landmark_solver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera_self_calibration/estimation/robust_cost.h"
#include "camera_self_calibration/estimation/solver.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

SegmentBlock posesHeld(Segment* segment) {
  SegmentBlock block;
  block.segment = segment;
  block.fixed_keyframes = static_cast<int>(segment->keyframes.size());
  return block;
}

Segment withoutDepths(Segment segment) {
  for (Landmark& landmark : segment.landmarks) landmark.inverse_depth = 0.4;
  return segment;
}

double distance(const Landmark& a, const Landmark& b) {
  return std::abs(a.inverse_depth - b.inverse_depth) + (a.bearing - b.bearing).norm();
}

TEST(SolveLandmarks, FindsWhatTheJointSolutionFinds) {
  for (const Camera& camera : ordinaryCameras()) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      Segment alone =
          withoutDepths(smallSegment(camera, LandmarkOrigin::kMixed, 0.2, seed, 8, 40).segment);
      Segment jointly = alone;
      solveLandmarks(posesHeld(&alone), camera, LandmarkSolverOptions());
      Camera held = camera;
      ASSERT_TRUE(solve({&held, false, {posesHeld(&jointly)}}, SolverOptions()).usable);
      EXPECT_NEAR(robustCost(posesHeld(&alone), camera, kHuberThreshold),
                  robustCost(posesHeld(&jointly), camera, kHuberThreshold), 0.01);
      int other = 0;
      for (std::size_t l = 0; l < alone.landmarks.size(); ++l) {
        other += distance(alone.landmarks[l], jointly.landmarks[l]) > 1e-3;
      }
      EXPECT_LE(other, 1) << "of " << alone.landmarks.size();
    }
  }
}

TEST(SolveLandmarks, NoneHoldsUpAnother) {
  const Camera camera = ordinaryCameras()[2];
  Segment still =
      withoutDepths(smallSegment(camera, LandmarkOrigin::kMixed, 0.2, 3, 8, 40).segment);
  Segment some_move = still;
  const std::vector<char> moves = letMove(3, false, &some_move);
  solveLandmarks(posesHeld(&still), camera, LandmarkSolverOptions());
  solveLandmarks(posesHeld(&some_move), camera, LandmarkSolverOptions());
  for (std::size_t l = 0; l < moves.size(); ++l) {
    if (moves[l] != 0) continue;
    EXPECT_EQ(distance(still.landmarks[l], some_move.landmarks[l]), 0.0);
  }
}

TEST(SolveLandmarks, WhatNothingDeterminesStays) {
  const Camera camera = ordinaryCameras()[0];
  Segment segment = smallSegment(camera, LandmarkOrigin::kMixed, 0.2, 1, 8, 40).segment;
  for (Keyframe& keyframe : segment.keyframes) keyframe.world_from_camera.translation.setZero();
  const Segment before = segment;
  solveLandmarks(posesHeld(&segment), camera, LandmarkSolverOptions());
  for (std::size_t l = 0; l < segment.landmarks.size(); ++l) {
    EXPECT_EQ(segment.landmarks[l].inverse_depth, before.landmarks[l].inverse_depth);
  }
}

TEST(SolveLandmarks, NeverRaisesACost) {
  const Camera camera = ordinaryCameras()[3];
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    Segment segment = smallSegment(camera, LandmarkOrigin::kMixed, 2.0, seed, 8, 40).segment;
    for (Landmark& landmark : segment.landmarks) landmark.inverse_depth *= -3.0;
    const double before = robustCost(posesHeld(&segment), camera, kHuberThreshold);
    LandmarkSolverOptions options;
    for (const int evaluations : {1, 3, 10}) {
      options.max_evaluations = evaluations;
      Segment solved = segment;
      solveLandmarks(posesHeld(&solved), camera, options);
      EXPECT_LE(robustCost(posesHeld(&solved), camera, kHuberThreshold), before);
    }
  }
}

}  // namespace
}  // namespace camera_self_calibration
