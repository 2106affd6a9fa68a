#include "camera_self_calibration/simulation/segment_maker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/stamp.h"

namespace camera_self_calibration {
namespace {

// Eq. (1), (2): the measured minus the predicted pixel of each observation.
std::vector<Eigen::Vector2d> residuals(const SimulatedSegment& made, const Segment& segment) {
  std::vector<Eigen::Vector2d> all;
  for (const Observation& observation : segment.observations) {
    const Landmark& landmark = segment.landmarks[static_cast<std::size_t>(observation.landmark)];
    const auto keyframe = [&](int i) { return segment.keyframes[static_cast<std::size_t>(i)]; };
    const Rigid3 world_from_r = keyframe(landmark.reference).world_from_camera;
    const Rigid3 world_from_i = keyframe(observation.keyframe).world_from_camera;
    const auto ray = made.camera.unproject(landmark.reference_pixel);
    EXPECT_TRUE(ray);
    const Eigen::Vector3d bearing = landmark.anchored ? *ray : landmark.bearing;
    const Eigen::Vector3d x =
        world_from_i.rotation.conjugate() *
        (world_from_r.rotation * bearing +
         landmark.inverse_depth * (world_from_r.translation - world_from_i.translation));
    Eigen::Vector2d predicted;
    EXPECT_TRUE(made.camera.project(x, &predicted));
    all.push_back(observation.pixel - predicted);
  }
  return all;
}

double rms(const std::vector<Eigen::Vector2d>& residuals) {
  double sum = 0.0;
  for (const Eigen::Vector2d& r : residuals) sum += r.squaredNorm();
  return std::sqrt(sum / (2.0 * static_cast<double>(residuals.size())));
}

SegmentOptions withOrigin(LandmarkOrigin origin, double sigma) {
  SegmentOptions options;
  options.origin = origin;
  options.tracks.pixel_sigma = sigma;
  return options;
}

const LandmarkOrigin kOrigins[] = {LandmarkOrigin::kAnchored, LandmarkOrigin::kInherited,
                                   LandmarkOrigin::kMixed};

TEST(MakeSegment, ResidualsVanishWithoutNoise) {
  for (const LandmarkOrigin origin : kOrigins) {
    for (const CameraModel model : {CameraModel::kPinhole, CameraModel::kFov, CameraModel::kRadtan,
                                    CameraModel::kEquidistant}) {
      SegmentOptions options = withOrigin(origin, 0.0);
      options.camera = Camera::defaultGuess(model, 640, 480);
      const SimulatedSegment made = makeSegment(options, 3);
      for (const Eigen::Vector2d& r : residuals(made, made.segment)) EXPECT_LT(r.norm(), 1e-6);
    }
  }
}

TEST(MakeSegment, ResidualsHaveTheSigmaOfTheNoise) {
  for (const LandmarkOrigin origin : kOrigins) {
    const SimulatedSegment made = makeSegment(withOrigin(origin, 0.3), 4);
    EXPECT_NEAR(rms(residuals(made, made.segment)), 0.3, 0.03);
    for (const Observation& observation : made.segment.observations) {
      EXPECT_EQ(observation.sigma, 0.3);
    }
  }
}

TEST(MakeSegment, KeepsTheRulesOfItsTypes) {
  for (const LandmarkOrigin origin : kOrigins) {
    const SimulatedSegment made = makeSegment(withOrigin(origin, 0.2), 5);
    const Segment& segment = made.segment;
    ASSERT_EQ(segment.keyframes.size(), 10u);
    ASSERT_GT(segment.landmarks.size(), 60u);
    ASSERT_EQ(made.points.size(), segment.landmarks.size());
    ASSERT_EQ(made.outliers.size(), segment.observations.size());
    std::vector<int> first(segment.landmarks.size(), -1);
    std::vector<int> views(segment.landmarks.size(), 0);
    int last = 0;
    for (const Observation& o : segment.observations) {
      EXPECT_GE(o.landmark, last) << "observations are grouped by landmark";
      last = o.landmark;
      const auto l = static_cast<std::size_t>(o.landmark);
      if (first[l] < 0) first[l] = o.keyframe;
      ++views[l];
    }
    bool any_anchored = false;
    bool any_inherited = false;
    for (std::size_t l = 0; l < segment.landmarks.size(); ++l) {
      const Landmark& landmark = segment.landmarks[l];
      (landmark.anchored ? any_anchored : any_inherited) = true;
      EXPECT_GE(views[l] + (landmark.anchored ? 1 : 0), 3);
      if (landmark.anchored) {
        EXPECT_LT(landmark.reference, first[l]);
      } else {
        EXPECT_EQ(landmark.reference, first[l]);
        EXPECT_EQ(first[l], 0);
      }
      EXPECT_GT(landmark.inverse_depth, 0.1);
    }
    EXPECT_EQ(any_anchored, origin != LandmarkOrigin::kInherited);
    EXPECT_EQ(any_inherited, origin != LandmarkOrigin::kAnchored);
  }
}

TEST(MakeSegment, EveryKeyframeSeesEnoughOverManySeeds) {
  for (const LandmarkOrigin origin : kOrigins) {
    int fewest = 1000;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const SimulatedSegment made = makeSegment(withOrigin(origin, 0.2), seed);
      std::vector<int> seen(10, 0);
      for (const Observation& o : made.segment.observations) {
        ++seen[static_cast<std::size_t>(o.keyframe)];
      }
      if (origin == LandmarkOrigin::kAnchored) seen[0] = 1000;  // its landmarks are anchors there
      fewest = std::min(fewest, *std::min_element(seen.begin(), seen.end()));
    }
    EXPECT_GE(fewest, 8) << static_cast<int>(origin);
  }
}

TEST(MakeSegment, MarksOutliers) {
  SegmentOptions options = withOrigin(LandmarkOrigin::kMixed, 0.2);
  options.tracks.outlier_share = 0.05;
  const SimulatedSegment made = makeSegment(options, 6);
  const std::vector<Eigen::Vector2d> r = residuals(made, made.segment);
  int outliers = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (r[i].norm() > 1.5) ++outliers;
    EXPECT_EQ(r[i].norm() > 1.5, made.outliers[i]);
  }
  EXPECT_NEAR(static_cast<double>(outliers) / static_cast<double>(r.size()), 0.05, 0.025);
}

TEST(MakeSegment, VelocityLeadsFromKeyframeToKeyframe) {
  SegmentOptions options;
  options.keyframe_interval_s = 0.02;
  const std::vector<Keyframe> keyframes = makeSegment(options, 7).segment.keyframes;
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    const double seconds = toSeconds(keyframes[i].stamp_ns - keyframes[i - 1].stamp_ns);
    const Vector6d mean = 0.5 * (keyframes[i - 1].velocity + keyframes[i].velocity);
    const Rigid3 predicted = keyframes[i - 1].world_from_camera * expSe3(seconds * mean);
    const Vector6d error = logSe3(predicted.inverse() * keyframes[i].world_from_camera);
    EXPECT_LT(error.norm(), 1e-5);
    EXPECT_GT(keyframes[i].velocity.norm(), 0.02);
  }
}

TEST(MakeSegment, KeyframesFollowTimeAndRotation) {
  SegmentOptions options;
  options.motion_speed = 3.0;
  const std::vector<Keyframe> keyframes = makeSegment(options, 7).segment.keyframes;
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    const auto step = keyframes[i].stamp_ns - keyframes[i - 1].stamp_ns;
    const double turn = keyframes[i - 1].world_from_camera.rotation.angularDistance(
        keyframes[i].world_from_camera.rotation);
    EXPECT_GT(step, 0);
    EXPECT_LE(step, 250000000);
    EXPECT_LT(turn, 9.0 * kDegree);
  }
}

TEST(MakeSegment, FollowsItsSeed) {
  const SimulatedSegment a = makeSegment(SegmentOptions(), 8);
  const SimulatedSegment b = makeSegment(SegmentOptions(), 8);
  const SimulatedSegment c = makeSegment(SegmentOptions(), 9);
  ASSERT_EQ(a.segment.observations.size(), b.segment.observations.size());
  EXPECT_EQ(a.segment.observations.back().pixel, b.segment.observations.back().pixel);
  EXPECT_NE(a.segment.observations.back().pixel, c.segment.observations.back().pixel);
}

TEST(MakeSegment, PerturbationMovesAllButTheFirstPose) {
  const SimulatedSegment made = makeSegment(withOrigin(LandmarkOrigin::kMixed, 0.0), 10);
  const Segment start = perturbed(made.segment, SegmentPerturbation(), 1);
  EXPECT_EQ(start.keyframes[0].world_from_camera.translation,
            made.segment.keyframes[0].world_from_camera.translation);
  EXPECT_NE(start.keyframes[1].world_from_camera.translation,
            made.segment.keyframes[1].world_from_camera.translation);
  EXPECT_GT(rms(residuals(made, start)), 1.0);
  EXPECT_LT(rms(residuals(made, start)), 30.0);
}

TEST(MakeSegment, RefusesImpossibleOptions) {
  SegmentOptions options;
  options.keyframes = 1;
  options.start_s = 0.0;
  EXPECT_EQ(options.problems().size(), 2u);
  EXPECT_THROW(makeSegment(options, 1), std::invalid_argument);
}

}  // namespace
}  // namespace camera_self_calibration
