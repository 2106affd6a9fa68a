#include "camera_self_calibration/reference/whole_trajectory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/reference/trajectory_batch.h"
#include "reference/batch_scene.h"

namespace camera_self_calibration {
namespace {

const Camera kFov = camera640(CameraModel::kFov, {320, 322, 316, 243, 0.95});

/// The keyframes [first, first + count) of a scene as the map offers them: all landmarks with a
/// bearing, in a frame and scale of the window's own.
Segment windowOf(const Segment& whole, int first, int count, double scale) {
  Segment window;
  window.keyframes.assign(whole.keyframes.begin() + first, whole.keyframes.begin() + first + count);
  const Rigid3 origin = window.keyframes.front().world_from_camera.inverse();
  for (Keyframe& keyframe : window.keyframes) {
    keyframe.world_from_camera = origin * keyframe.world_from_camera;
    keyframe.world_from_camera.translation *= scale;
  }
  for (std::size_t l = 0; l < whole.landmarks.size(); ++l) {
    std::vector<Observation> seen;
    for (const Observation& observation : whole.observations) {
      const bool inside = observation.keyframe >= first && observation.keyframe < first + count;
      if (observation.landmark == static_cast<int>(l) && inside) seen.push_back(observation);
    }
    if (seen.size() < 2) continue;
    const Keyframe& old_reference = whole.keyframes[whole.landmarks[l].reference];
    const Keyframe& reference = whole.keyframes[seen.front().keyframe];
    const Eigen::Vector3d point = old_reference.world_from_camera *
                                  (whole.landmarks[l].bearing / whole.landmarks[l].inverse_depth);
    const Eigen::Vector3d local = reference.world_from_camera.inverse() * point;
    Landmark landmark = whole.landmarks[l];
    landmark.anchored = false;
    landmark.reference = seen.front().keyframe - first;
    landmark.bearing = local.normalized();
    landmark.inverse_depth = 1.0 / (scale * local.norm());
    for (Observation& observation : seen) {
      observation.landmark = static_cast<int>(window.landmarks.size());
      observation.keyframe -= first;
      window.observations.push_back(observation);
    }
    window.landmarks.push_back(landmark);
  }
  return window;
}

/// With a bearing for all, observed in the reference keyframe too.
Segment inheritedOnly(const BatchScene& scene, double sigma, std::uint64_t seed) {
  Segment whole = scene.noisy(sigma, seed);
  std::mt19937_64 random(seed + 1000);
  std::normal_distribution<double> normal(0.0, sigma);
  for (std::size_t l = 0; l < whole.landmarks.size(); ++l) {
    Landmark& landmark = whole.landmarks[l];
    if (!landmark.anchored) continue;
    landmark.anchored = false;
    const Eigen::Vector2d noise(normal(random), normal(random));
    whole.observations.push_back({static_cast<int>(l), landmark.reference,
                                  landmark.reference_pixel + noise, std::max(sigma, 1e-3)});
  }
  std::stable_sort(whole.observations.begin(), whole.observations.end(),
                   [](const Observation& a, const Observation& b) {
                     return std::tie(a.landmark, a.keyframe) < std::tie(b.landmark, b.keyframe);
                   });
  return whole;
}

TEST(WholeTrajectory, WindowsOfDifferentScaleMakeOneSegment) {
  const Segment whole = inheritedOnly(BatchScene(kFov, 14, 60, 3), 0.0, 0);
  WholeTrajectory trajectory;
  for (int first = 0; first + 6 <= 14; ++first) {
    trajectory.add(windowOf(whole, first, 6, 1.0 + 0.2 * first));
  }
  const std::vector<Segment> parts = trajectory.parts();
  ASSERT_EQ(parts.size(), 1u);
  ASSERT_EQ(trajectory.keyframes(), 14);
  const Rigid3 origin = whole.keyframes.front().world_from_camera.inverse();
  for (int k = 0; k < 14; ++k) {
    const Rigid3 expected = origin * whole.keyframes[k].world_from_camera;
    const Rigid3& got = parts[0].keyframes[k].world_from_camera;
    EXPECT_LT((got.translation - expected.translation).norm(), 1e-9) << k;
    EXPECT_LT(got.rotation.angularDistance(expected.rotation), 1e-9) << k;
  }
  // Every sighting once. One that no window holds beside another sighting is not to be had.
  std::map<std::pair<std::int64_t, int>, int> seen;
  for (const Observation& observation : parts[0].observations) {
    ++seen[{parts[0].landmarks[observation.landmark].track_id, observation.keyframe}];
  }
  for (const auto& [key, count] : seen) EXPECT_EQ(count, 1) << key.first << " in " << key.second;
  EXPECT_GT(seen.size(), whole.observations.size() * 9 / 10);
}

TEST(WholeTrajectory, AWindowWithoutCommonKeyframesBeginsAPart) {
  const Segment whole = inheritedOnly(BatchScene(kFov, 12, 60, 3), 0.0, 0);
  WholeTrajectory trajectory;
  trajectory.add(windowOf(whole, 0, 6, 1.0));
  trajectory.add(windowOf(whole, 6, 6, 1.0));
  EXPECT_EQ(trajectory.parts().size(), 2u);
  EXPECT_EQ(trajectory.keyframes(), 12);
  trajectory.add(Segment());
  EXPECT_EQ(trajectory.parts().size(), 2u);
}

TEST(TrajectoryBatch, FindsTheLensAndLeavesOutTracksThatDoNotFit) {
  Segment whole = inheritedOnly(BatchScene(kFov, 14, 80, 3), 0.2, 9);
  std::size_t spoilt = 0;
  for (Observation& observation : whole.observations) {
    if (observation.landmark % 10 != 4) continue;
    ++spoilt;
    observation.pixel += Eigen::Vector2d(3.0 * (observation.keyframe % 3), -4.0);
  }
  TrajectoryBatch batch;
  for (int first = 0; first + 6 <= 14; ++first) batch.add(windowOf(whole, first, 6, 1.0));
  Camera start = kFov;
  Intrinsics parameters = kFov.parameters();
  parameters(0) *= 1.03;
  parameters(2) += 4.0;
  start.setParameters(parameters);
  const BatchEstimate estimate = batch.solve(start);
  EXPECT_TRUE(estimate.converged);
  EXPECT_EQ(estimate.keyframes, 14);
  EXPECT_LE(static_cast<std::size_t>(estimate.observations), whole.observations.size() - spoilt);
  EXPECT_GT(static_cast<std::size_t>(estimate.observations), whole.observations.size() * 7 / 10);
  ASSERT_EQ(estimate.covariance.rows(), 5);
  for (int i = 0; i < 5; ++i) {
    const double sigma = std::sqrt(estimate.covariance(i, i));
    EXPECT_NEAR(estimate.camera.parameters()(i), kFov.parameters()(i), 4.0 * sigma) << i;
  }
  EXPECT_LT(pixelDistance(kFov, estimate.camera).rms, 3.0 * estimate.uncertainty.rms);
}

TEST(TrajectoryBatch, WithoutEnoughKeyframesItKnowsNothing) {
  TrajectoryBatch batch;
  EXPECT_EQ(batch.solve(kFov).covariance.size(), 0);
  batch.add(windowOf(inheritedOnly(BatchScene(kFov, 12, 60, 3), 0.0, 0), 0, 3, 1.0));
  const BatchEstimate estimate = batch.solve(kFov);
  EXPECT_EQ(estimate.covariance.size(), 0);
  EXPECT_FALSE(estimate.converged);
  EXPECT_TRUE(std::isinf(estimate.uncertainty.rms));
}

}  // namespace
}  // namespace camera_self_calibration
