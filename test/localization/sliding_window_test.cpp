#include "camera_self_calibration/localization/sliding_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/map/segment_edit.h"
#include "camera_self_calibration/simulation/feature_tracks.h"
#include "camera_self_calibration/simulation/room.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

// Keyframes along a handheld motion, and the window that follows them.
class SlidingWindowTest : public testing::Test {
 protected:
  explicit SlidingWindowTest(double pixel_sigma = 0.2, const Trajectory& trajectory = motion())
      : tracks_(makeRoom(RoomOptions()), Lens{kTruth, std::nullopt, 1.0}, trajectory,
                options(pixel_sigma)) {}

  static Trajectory motion() {
    SyntheticMotionOptions options;
    options.speed = 0.6;
    return syntheticMotion(options);
  }
  static FeatureTracksOptions options(double pixel_sigma) {
    FeatureTracksOptions options;
    options.pixel_sigma = pixel_sigma;
    return options;
  }

  std::int64_t stampOf(int k) const { return 250000000LL * (k + 4); }

  // The next keyframe, its pose first located against the map; the first two begin at the truth.
  std::vector<std::int64_t> addKeyframe(SlidingWindow* window) {
    TrackedFrame frame = tracks_.track(stampOf(keyframes_));
    Keyframe keyframe;
    keyframe.id = keyframes_;
    keyframe.stamp_ns = frame.stamp_ns;
    keyframe.world_from_camera = tracks_.worldFromCamera(frame.stamp_ns);
    if (keyframes_ > 1) {
      const PoseEstimate pose = window->localize(frame, window->newestPose());
      EXPECT_TRUE(pose.usable);
      keyframe.world_from_camera = pose.world_from_camera;
    }
    ++keyframes_;
    newest_ = frame;
    const std::vector<Track> started = tracks_.detect();
    frame.tracks.insert(frame.tracks.end(), started.begin(), started.end());
    const auto outliers = window->addKeyframe(keyframe, frame.tracks);
    tracks_.drop(outliers);
    return outliers;
  }

  // From the window's first to its last keyframe.
  static double length(const SlidingWindow& window, int keyframes = 10) {
    const auto& list = window.map().keyframes();
    double sum = 0.0;
    for (std::size_t k = list.size() - keyframes + 1; k < list.size(); ++k) {
      sum += (list[k].world_from_camera.translation - list[k - 1].world_from_camera.translation)
                 .norm();
    }
    return sum;
  }

  static Camera offFocal(double share) {
    Intrinsics parameters = kTruth.parameters();
    parameters.head<2>() *= 1.0 + share;
    return withParameters(kTruth, parameters);
  }

  // Relative to the window's own oldest active keyframe, so that drift before it does not count;
  // after scaling to the true length.
  double worstPositionError(const SlidingWindow& window) const {
    const auto& list = window.map().keyframes();
    const std::size_t first = list.size() - 10;
    const auto relative = [&](std::size_t k) {
      return (list[first].world_from_camera.inverse() * list[k].world_from_camera).translation;
    };
    const auto truth = [&](std::size_t k) {
      return (tracks_.worldFromCamera(list[first].stamp_ns).inverse() *
              tracks_.worldFromCamera(list[k].stamp_ns))
          .translation;
    };
    double dot = 0.0, square = 0.0, worst = 0.0;
    for (std::size_t k = first; k < list.size(); ++k) {
      dot += truth(k).dot(relative(k));
      square += relative(k).squaredNorm();
    }
    for (std::size_t k = first; k < list.size(); ++k) {
      worst = std::max(worst, (truth(k) - dot / square * relative(k)).norm());
    }
    return worst / length(window);
  }

  // True length of the window over its length in the map.
  double scaleOf(const SlidingWindow& window) const {
    const auto& list = window.map().keyframes();
    double sum = 0.0;
    for (std::size_t k = list.size() - 9; k < list.size(); ++k) {
      sum += (tracks_.worldFromCamera(list[k].stamp_ns).translation -
              tracks_.worldFromCamera(list[k - 1].stamp_ns).translation)
                 .norm();
    }
    return sum / length(window);
  }

  static const Camera kTruth;
  FeatureTracks tracks_;
  int keyframes_ = 0;
  TrackedFrame newest_;
};

const Camera SlidingWindowTest::kTruth = ordinaryCameras()[1];

TEST_F(SlidingWindowTest, FollowsTheCamera) {
  SlidingWindow window(SlidingWindowOptions(), kTruth);
  double scale = 0.0;  // set by the first two keyframes
  for (int k = 0; k < 60; ++k) {
    addKeyframe(&window);
    EXPECT_LE(window.map().keyframes().size(), 40u);
    if (k < 12) continue;
    EXPECT_LT(worstPositionError(window), 0.02) << k;
    if (k == 20) scale = scaleOf(window);
    if (k > 20) {
      EXPECT_NEAR(scaleOf(window) / scale, 1.0, 0.02) << k;
    }
  }
}

// Turns on the spot for a while, then moves as it turns on.
Trajectory turnThenMove(double turn_s) {
  const auto pose = [turn_s](double time_s) {
    const Eigen::AngleAxisd turn(0.6 * std::sin(time_s), Eigen::Vector3d::UnitY());
    const Eigen::Vector3d velocity(0.4, -0.1, 0.3);
    return Rigid3(Eigen::Quaterniond(turn), std::max(0.0, time_s - turn_s) * velocity);
  };
  return Trajectory(pose, turn_s + 2.0);
}

// Depths that come of noise lead into a wrong minimum once the camera moves on.
TEST_F(SlidingWindowTest, FollowsTheCameraAfterATurnOnTheSpot) {
  constexpr double kTurnS = 12.0;
  for (std::uint64_t seed = 5; seed <= 8; ++seed) {
    FeatureTracksOptions noisy = options(0.3);
    noisy.seed = seed;
    tracks_ = FeatureTracks(makeRoom(RoomOptions()), Lens{kTruth, std::nullopt, 1.0},
                            turnThenMove(kTurnS), noisy);
    keyframes_ = 0;
    SlidingWindow window(SlidingWindowOptions(), kTruth);
    window.adopt(kTruth, 1, true);
    while (toSeconds(stampOf(keyframes_)) < kTurnS + 1.0) addKeyframe(&window);
    const double scale = scaleOf(window);
    std::cout << "seed " << seed << ": position error " << worstPositionError(window) << ", scale "
              << scale << "\n";
    EXPECT_LT(worstPositionError(window), 0.1) << seed;
    // As the map's other depths had it, in the order of size.
    EXPECT_GT(scale, 0.1) << seed;
    EXPECT_LT(scale, 10.0) << seed;
  }
}

TEST_F(SlidingWindowTest, AdoptingAnotherCalibrationMovesNothingFar) {
  for (const double share : {0.05, -0.05}) {
    SlidingWindow window(SlidingWindowOptions(), offFocal(share));
    keyframes_ = 0;
    tracks_.reset();
    for (int k = 0; k < 25; ++k) addKeyframe(&window);
    const Rigid3 before = window.newestPose();
    const std::int64_t newest = window.map().keyframes().back().id;
    const double depth_before = window.map().typicalInverseDepthAt(newest, window.camera());
    const double path = length(window);

    window.adopt(kTruth, 7, false);
    EXPECT_EQ(window.generation(), 7u);
    const Rigid3 after = window.newestPose();
    EXPECT_LT((after.translation - before.translation).norm(), 0.01 * path);
    EXPECT_LT(after.rotation.angularDistance(before.rotation), 0.01);
    EXPECT_NEAR(window.map().typicalInverseDepthAt(newest, kTruth) / depth_before, 1.0, 0.01);
    // The frame located anew against the adopted map is where it was.
    const PoseEstimate located = window.localize(newest_, after);
    ASSERT_TRUE(located.usable);
    EXPECT_LT((located.world_from_camera.translation - before.translation).norm(), 0.01 * path);
    // And the window is right under the right lens, which it was not before.
    EXPECT_LT(worstPositionError(window), 0.02);
  }
}

TEST_F(SlidingWindowTest, KeyframesOfAFarCalibrationConditionNoMore) {
  // A point seen for long keeps its anchor in the oldest keyframe that the window looks at.
  const auto oldest_anchor = [&](double focal_share) {
    keyframes_ = 0;
    tracks_.reset();
    SlidingWindow window(SlidingWindowOptions(), kTruth);
    for (int k = 0; k < 25; ++k) addKeyframe(&window);
    const Camera other = offFocal(focal_share);
    window.adopt(other, 1, false);
    addKeyframe(&window);
    std::int64_t oldest = keyframes_;
    for (const auto& [id, point] : window.map().points()) {
      if (point.sightings.back().keyframe_id != keyframes_ - 1) continue;
      oldest = std::min(oldest, point.anchor_id);
    }
    return oldest;
  };
  // 26 keyframes: 16 to 25 are active, 6 to 15 may condition, 15 is of the new calibration.
  EXPECT_GT(pixelDistance(kTruth, offFocal(0.02)).rms, 0.5);
  EXPECT_LT(pixelDistance(kTruth, offFocal(0.0005)).rms, 0.5);
  EXPECT_LT(oldest_anchor(0.0005), 15);
  EXPECT_EQ(oldest_anchor(0.02), 15);
}

TEST_F(SlidingWindowTest, GenerationsFarApartAddUp) {
  SlidingWindow window(SlidingWindowOptions(), offFocal(0.0));
  for (int k = 0; k < 25; ++k) {
    addKeyframe(&window);
    window.adopt(offFocal(0.0002 * k), static_cast<std::uint64_t>(k + 1), false);
    EXPECT_EQ(window.map().keyframes().back().calibration_generation,
              static_cast<std::uint64_t>(k > 0 ? k + 1 : 0));
  }
  EXPECT_EQ(window.camera().parameters(), offFocal(0.0002 * 24).parameters());
}

TEST_F(SlidingWindowTest, EndsTracksThatDoNotFitUnderTrustedIntrinsicsOnly) {
  for (const bool trusted : {false, true}) {
    SlidingWindow window(SlidingWindowOptions(), kTruth);
    keyframes_ = 0;
    tracks_.reset();
    for (int k = 0; k < 10; ++k) addKeyframe(&window);
    window.adopt(kTruth, 1, trusted);
    TrackedFrame frame = tracks_.track(stampOf(keyframes_));
    Keyframe keyframe;
    keyframe.id = keyframes_++;
    keyframe.world_from_camera = window.localize(frame, window.newestPose()).world_from_camera;
    Track& wrong = frame.tracks[frame.tracks.size() / 2];
    wrong.pixel += Eigen::Vector2d(15.0, -20.0);
    const auto ended = window.addKeyframe(keyframe, frame.tracks);
    if (!trusted) {
      EXPECT_TRUE(ended.empty());
      continue;
    }
    EXPECT_EQ(ended, std::vector<std::int64_t>{wrong.id});
    EXPECT_EQ(window.map().points().count(wrong.id), 0u);
  }
}

TEST_F(SlidingWindowTest, ReseedTakesASolutionAndKeepsPoseAndScale) {
  SlidingWindow window(SlidingWindowOptions(), kTruth);
  for (int k = 0; k < 12; ++k) addKeyframe(&window);
  const Rigid3 pose = window.newestPose();
  const double depth = window.map().typicalInverseDepthAt(11, kTruth);
  const double path = length(window);
  // The same in another frame, at three times the scale.
  Segment solution = window.map().segmentFrom(0, kTruth);
  const Rigid3 moved(Eigen::Quaterniond(0.8, 0.0, 0.6, 0.0), Eigen::Vector3d(5.0, 6.0, 7.0));
  for (Keyframe& keyframe : solution.keyframes) {
    Rigid3 scaled = keyframe.world_from_camera;
    scaled.translation *= 3.0;
    keyframe.world_from_camera = moved * scaled;
  }
  for (Landmark& landmark : solution.landmarks) landmark.inverse_depth /= 3.0;
  for (int again = 0; again < 20; ++again) window.reseed(solution);  // as at each keyframe
  EXPECT_LT((window.newestPose().translation - pose.translation).norm(), 1e-9);
  EXPECT_NEAR(window.map().typicalInverseDepthAt(11, kTruth) / depth, 1.0, 0.01);
  EXPECT_NEAR(length(window) / path, 1.0, 0.01);
  // Of keyframes that the map does not know: nothing.
  for (Keyframe& keyframe : solution.keyframes) keyframe.id += 1000;
  window.reseed(solution);
  EXPECT_LT((window.newestPose().translation - pose.translation).norm(), 1e-9);
  window.reseed(Segment());
}

// What came since the change was solved with the wrong lens, and its scale is of no worth.
TEST_F(SlidingWindowTest, ReseedAcrossAChangeOfTheLensKeepsWhatCameBefore) {
  SlidingWindow window(SlidingWindowOptions(), kTruth);
  for (int k = 0; k < 12; ++k) addKeyframe(&window);
  // Of the way since the change to that before it.
  const auto growth = [&window] {
    const auto& list = window.map().keyframes();
    const auto way = [&](int a, int b) {
      return (list[b].world_from_camera.translation - list[a].world_from_camera.translation).norm();
    };
    return way(5, 11) / way(0, 5);
  };
  const double true_growth = growth();
  const Segment right = window.map().segmentFrom(0, kTruth);
  Segment wrong = right;
  for (std::size_t k = 6; k < 12; ++k) {
    const Eigen::Vector3d origin = right.keyframes[5].world_from_camera.translation;
    Eigen::Vector3d& position = wrong.keyframes[k].world_from_camera.translation;
    position = origin + 2.0 * (position - origin);
  }
  window.reseed(wrong);
  const Rigid3 first = window.map().keyframes().front().world_from_camera;
  const double depth = window.map().typicalInverseDepthAt(0, kTruth);
  EXPECT_NEAR(growth() / true_growth, 2.0, 1e-6);
  Segment solution = right;  // at three times the scale
  for (Keyframe& keyframe : solution.keyframes) keyframe.world_from_camera.translation *= 3.0;
  for (Landmark& landmark : solution.landmarks) landmark.inverse_depth /= 3.0;
  setEarlierLens(kTruth, 6, &solution);
  window.reseed(solution);
  const Rigid3& kept = window.map().keyframes().front().world_from_camera;
  EXPECT_LT((kept.translation - first.translation).norm(), 1e-9);
  EXPECT_LT(kept.rotation.angularDistance(first.rotation), 1e-9);
  EXPECT_NEAR(window.map().typicalInverseDepthAt(0, kTruth) / depth, 1.0, 1e-6);
  EXPECT_NEAR(growth() / true_growth, 1.0, 1e-6);
}

// Whatever it is given, the next keyframe comes.
TEST_F(SlidingWindowTest, ReseedWithAnOldSolutionLeavesTheMapWhole) {
  SlidingWindowOptions small;
  small.map_keyframes = 20;
  SlidingWindow window(small, kTruth);
  for (int k = 0; k < 18; ++k) addKeyframe(&window);
  const Segment old = window.map().segmentFrom(0, kTruth);
  for (int k = 0; k < 12; ++k) addKeyframe(&window);
  window.reseed(old);
  for (int k = 0; k < 5; ++k) addKeyframe(&window);
  EXPECT_LT(worstPositionError(window), 0.05);
}

// Moves, turns on the spot four times, and moves on.
Trajectory turningOnTheSpot() {
  constexpr double kTurnS = 6.0, kMoveOnS = 66.0;
  SyntheticMotionOptions options;
  options.speed = 0.6;
  const Trajectory moving = syntheticMotion(options);
  return Trajectory(
      [moving](double t) {
        if (t < kTurnS) return moving.worldFromCamera(t);
        if (t > kMoveOnS) return moving.worldFromCamera(t - kMoveOnS + kTurnS);
        Rigid3 pose = moving.worldFromCamera(kTurnS);
        const double angle = 8.0 * M_PI * (t - kTurnS) / (kMoveOnS - kTurnS);
        pose.rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * pose.rotation;
        return pose;
      },
      75.0);
}

class TurningOnTheSpot : public SlidingWindowTest {
 protected:
  TurningOnTheSpot() : SlidingWindowTest(0.2, turningOnTheSpot()) {}
};

TEST_F(TurningOnTheSpot, KeepsScaleAndSign) {
  SlidingWindow window(SlidingWindowOptions(), kTruth);
  while (keyframes_ < 20) addKeyframe(&window);
  const double before = scaleOf(window);
  while (keyframes_ < 285) addKeyframe(&window);
  EXPECT_NEAR(std::log(scaleOf(window) / before), 0.0, std::log(2.0));
  int seen = 0;
  int behind = 0;
  for (const auto& [track_id, point] : window.map().points()) {
    if (point.sightings.size() <= 3) continue;
    ++seen;
    behind += point.inverse_depth < 0.0;
  }
  EXPECT_GT(seen, 50);
  EXPECT_LT(behind, 0.05 * seen);
  EXPECT_LT(worstPositionError(window), 0.1);
}

TEST_F(SlidingWindowTest, EmptyMap) {
  SlidingWindow window(SlidingWindowOptions(), kTruth);
  EXPECT_EQ(window.newestPose().translation, Eigen::Vector3d::Zero());
  EXPECT_FALSE(window.localize(tracks_.track(stampOf(0)), Rigid3()).usable);
  window.adopt(offFocal(0.1), 3, true);
  EXPECT_EQ(window.generation(), 3u);
  addKeyframe(&window);
  addKeyframe(&window);
  window.clear();
  EXPECT_TRUE(window.map().keyframes().empty());
  EXPECT_EQ(window.camera().parameters(), offFocal(0.1).parameters());
}

}  // namespace
}  // namespace camera_self_calibration
