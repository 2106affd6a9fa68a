#include "camera_self_calibration/estimation/rigid_gate.h"

#include <gtest/gtest.h>

#include <vector>

#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

struct Found {
  int moving = 0;  // of those that move
  int all_moving = 0;
  int standing = 0;  // of the others
  int all_standing = 0;
};

// From the true poses, but from depths that are all wrong.
Found find(bool carried) {
  Found found;
  for (const Camera& camera : ordinaryCameras()) {
    for (std::uint64_t seed = 0; seed < 3; ++seed) {
      Segment segment = smallSegment(camera, LandmarkOrigin::kMixed, 0.2, seed, 8, 60).segment;
      const std::vector<char> moves = letMove(5, carried, &segment);
      for (Landmark& landmark : segment.landmarks) landmark.inverse_depth = 0.4;
      std::vector<char> named(moves.size(), 0);
      for (const int l : nonRigidTracks(&segment, camera)) named[static_cast<std::size_t>(l)] = 1;
      for (std::size_t l = 0; l < moves.size(); ++l) {
        (moves[l] ? found.all_moving : found.all_standing) += 1;
        (moves[l] ? found.moving : found.standing) += named[l];
      }
    }
  }
  return found;
}

TEST(NonRigidTracks, AreThoseThatNoDepthExplains) {
  const Found found = find(false);
  ASSERT_GT(found.all_moving, 100);
  EXPECT_GT(found.moving, 0.9 * found.all_moving);
  EXPECT_LT(found.standing, 0.01 * found.all_standing);
}

TEST(NonRigidTracks, AreThoseThatTheCameraCarries) {
  const Found found = find(true);
  ASSERT_GT(found.all_moving, 100);
  EXPECT_GT(found.moving, 0.9 * found.all_moving);
  EXPECT_LT(found.standing, 0.01 * found.all_standing);
}

TEST(NonRigidTracks, DepthsAreFoundOnTheWay) {
  const SimulatedSegment made =
      smallSegment(ordinaryCameras()[0], LandmarkOrigin::kMixed, 0.0, 5, 8, 60);
  Segment segment = made.segment;
  for (Landmark& landmark : segment.landmarks) landmark.inverse_depth *= 1.3;
  EXPECT_TRUE(nonRigidTracks(&segment, made.camera).empty());
  for (std::size_t l = 0; l < segment.landmarks.size(); ++l) {
    EXPECT_NEAR(segment.landmarks[l].inverse_depth, made.segment.landmarks[l].inverse_depth, 3e-3);
  }
  for (std::size_t k = 0; k < segment.keyframes.size(); ++k) {
    EXPECT_EQ(segment.keyframes[k].world_from_camera.translation,
              made.segment.keyframes[k].world_from_camera.translation);
  }
}

}  // namespace
}  // namespace camera_self_calibration
