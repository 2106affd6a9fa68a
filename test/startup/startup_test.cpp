#include "camera_self_calibration/startup/startup.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/map/segment_edit.h"
#include "camera_self_calibration/queue/segment_fit.h"
#include "camera_self_calibration/startup/growth.h"
#include "estimation/sample_segments.h"
#include "lens_change/change_samples.h"
#include "sanitized.h"

namespace camera_self_calibration {
namespace {

SimulatedSegment longSegment(const Camera& camera, MotionKind motion, std::uint64_t seed,
                             int keyframes = 16) {
  SegmentOptions options;
  options.camera = camera;
  options.motion = motion;
  options.keyframes = keyframes;
  options.tracks.max_features = 80;
  options.tracks.pixel_sigma = 0.25;
  options.tracks.outlier_share = 0.01;
  return makeSegment(options, seed);
}

// As a front end hands over its history that knows nothing but the default guess.
Segment forgotten(Segment segment, const Camera& guess) {
  for (Keyframe& keyframe : segment.keyframes) keyframe.world_from_camera = Rigid3();
  std::vector<char> seen(segment.landmarks.size(), 0);
  for (const Observation& o : segment.observations) {
    if (seen[o.landmark]++ != 0 || segment.landmarks[o.landmark].anchored) continue;
    segment.landmarks[o.landmark].bearing =
        guess.unproject(o.pixel).value_or(Eigen::Vector3d::UnitZ());
  }
  for (Landmark& landmark : segment.landmarks) landmark.inverse_depth = 1.0;
  return segment;
}

// Keyframe by keyframe, but for those in `dropped`.
Startup grown(const SimulatedSegment& made, const std::vector<int>& dropped = {}) {
  const Camera guess =
      Camera::defaultGuess(made.camera.model(), made.camera.width(), made.camera.height());
  const Segment history = forgotten(made.segment, guess);
  Startup startup(StartupOptions(), guess);
  for (int k = 2; k <= static_cast<int>(history.keyframes.size()); ++k) {
    if (std::count(dropped.begin(), dropped.end(), k) > 0) continue;
    std::vector<int> index;
    startup.add(prefixOf(history, k, 1, &index));
  }
  return startup;
}

bool isRight(const Startup& startup, const Camera& truth) {
  const auto covariance = covarianceFromInformation(startup.information());
  if (!startup.usable() || !covariance) return false;
  if (startup.camera().parameterCount() != truth.parameterCount()) return false;
  const Eigen::VectorXd error = startup.camera().parameters() - truth.parameters();
  // Chi-square with up to 9 degrees, 1 in 10000 or fewer.
  return error.dot(covariance->ldlt().solve(error)) < 34.0;
}

TEST(Startup, ReachesTheTruthFromTheDefaultGuess) {
  for (const Camera& truth : ordinaryCameras()) {
    int right = 0;
    constexpr int kTrials = kSanitized ? 2 : 10;
    for (std::uint64_t seed = 0; seed < kTrials; ++seed) {
      right += isRight(grown(longSegment(truth, MotionKind::kHandheld, seed)), truth);
    }
    std::cout << toString(truth.model()) << ": " << right << " of " << kTrials << " right\n";
    EXPECT_GE(right, kTrials - 1) << toString(truth.model());
  }
}

// The same seen by a camera that is turned by a quarter about its axis.
SimulatedSegment heldUpright(SimulatedSegment made) {
  const Intrinsics p = made.camera.parameters();
  const double bottom = made.camera.height() - 1.0;
  const auto turn = [bottom](Eigen::Vector2d* pixel) {
    *pixel = {bottom - pixel->y(), pixel->x()};
  };
  made.camera = Camera(CameraModel::kPinhole, made.camera.height(), made.camera.width(),
                       Eigen::Vector4d(p[1], p[0], bottom - p[3], p[2]));
  for (Observation& seen : made.segment.observations) turn(&seen.pixel);
  for (Landmark& landmark : made.segment.landmarks) {
    turn(&landmark.reference_pixel);
    const Eigen::Vector3d level = landmark.bearing;
    landmark.bearing = {-level.y(), level.x(), level.z()};
  }
  return made;
}

// Of a wide image: what is assumed of an unknown lens must not follow from the shorter side.
TEST(Startup, ACameraHeldUprightIsLearntAsWell) {
  const Camera wide(CameraModel::kPinhole, 1242, 375, Eigen::Vector4d(721, 719, 610, 173));
  const SimulatedSegment level = longSegment(wide, MotionKind::kHandheld, 3);
  const Startup one = grown(level);
  const Startup other = grown(heldUpright(level));
  EXPECT_TRUE(isRight(one, wide));
  const Intrinsics& a = one.camera().parameters();
  const Intrinsics& b = other.camera().parameters();
  const Eigen::Vector4d turned(b[1], b[0], b[3], wide.height() - 1.0 - b[2]);
  EXPECT_LT((turned - a).norm(), 0.01) << turned.transpose() << " | " << a.transpose();
}

// By themselves, or not at all: as on what the camera carries.
TEST(Startup, ReachesTheTruthWhereAFifthOfTheTracksIsNotOfTheScene) {
  for (const bool carried : {false, true}) {
    int right = 0;
    constexpr int kTrials = kSanitized ? 2 : 8;
    for (std::uint64_t seed = 0; seed < kTrials; ++seed) {
      const Camera truth = ordinaryCameras()[seed % 4];
      SimulatedSegment made = longSegment(truth, MotionKind::kHandheld, seed);
      letMove(5, carried, &made.segment);
      right += isRight(grown(made), truth);
    }
    std::cout << (carried ? "carried: " : "moving: ") << right << " of " << kTrials << " right\n";
    EXPECT_GE(right, kTrials - 2);
  }
}

TEST(Startup, SolvesPosesAndDepthsToo) {
  const Camera truth = ordinaryCameras()[1];
  const SimulatedSegment made = longSegment(truth, MotionKind::kHandheld, 3);
  const Startup startup = grown(made);
  ASSERT_TRUE(isRight(startup, truth));
  EXPECT_NEAR(startup.residualScale(), 1.0, 0.15);
  // Up to the scale.
  const auto& solved = startup.segment().keyframes;
  const auto& right = made.segment.keyframes;
  ASSERT_EQ(solved.size(), right.size());
  const auto from_first = [](const std::vector<Keyframe>& keyframes, std::size_t k) {
    return keyframes.front().world_from_camera.inverse() * keyframes[k].world_from_camera;
  };
  const std::size_t last = right.size() - 1;
  const double scale =
      from_first(right, last).translation.norm() / from_first(solved, last).translation.norm();
  for (std::size_t k = 1; k <= last; ++k) {
    const Rigid3 a = from_first(solved, k), b = from_first(right, k);
    EXPECT_LT((scale * a.translation - b.translation).norm(), 0.05) << k;
    EXPECT_LT(a.rotation.angularDistance(b.rotation), 0.03) << k;
  }
}

// The uncertainty stays far above what would be handed over (2 px at this width), infinite where
// there is no estimate.
TEST(Startup, WaitsWhereMotionDoesNotInform) {
  for (const MotionKind motion : {MotionKind::kForwardOnly, MotionKind::kSidewaysOnly}) {
    int usable = 0;
    constexpr int kTrials = kSanitized ? 1 : 4;
    for (std::uint64_t seed = 0; seed < kTrials; ++seed) {
      const Camera truth = ordinaryCameras()[seed % 4];
      const Startup startup = grown(longSegment(truth, motion, seed, 14));
      usable += startup.usable();
      EXPECT_FALSE(startup.isInformative()) << toString(motion) << " " << toString(truth.model());
      EXPECT_GT(startup.wholeImageUncertainty().rms, 8.0)
          << toString(motion) << " " << toString(truth.model());
    }
    EXPECT_GT(usable, 0) << toString(motion) << ": there is an estimate, and it is not believed";
  }
}

// Motion that tells nothing, longer than the batch is: it stays full, and the intrinsics stay sane.
TEST(Startup, WaitsAtConstantSizeWithoutRunningAway) {
  const SimulatedSegment made =
      longSegment(ordinaryCameras()[0], MotionKind::kForwardOnly, 2, kSanitized ? 14 : 24);
  const Camera guess = Camera::defaultGuess(made.camera.model(), 640, 480);
  const Segment history = forgotten(made.segment, guess);
  StartupOptions options;
  options.max_keyframes = 12;
  options.choice.keep_newest = 6;
  Startup startup(options, guess);
  for (int k = 2; k <= static_cast<int>(history.keyframes.size()); ++k) {
    std::vector<int> index;
    startup.add(prefixOf(history, k, 1, &index));
    EXPECT_EQ(startup.segment().keyframes.size(), std::min(k, 12));
    EXPECT_EQ(startup.segment().keyframes.back().id, history.keyframes[k - 1].id);
    EXPECT_FALSE(startup.isInformative()) << k;
    EXPECT_GT(startup.camera().parameters()(0), 80.0) << k;
    EXPECT_LT(startup.camera().parameters()(0), 1600.0) << k;
  }
}

// Half of the keyframes of a slow motion left out: the rest tell more than as many newest ones.
TEST(Startup, RemembersWhatToldTheLens) {
  const Camera truth = ordinaryCameras()[1];
  const SimulatedSegment made = longSegment(truth, MotionKind::kHandheld, 3, 24);
  const Camera guess = Camera::defaultGuess(truth.model(), 640, 480);
  const Segment history = forgotten(made.segment, guess);
  StartupOptions options;
  options.max_keyframes = 12;
  options.choice.keep_newest = 6;
  Startup chosen(options, guess), newest(options, guess);
  for (int k = 2; k <= 24; ++k) {
    std::vector<int> index;
    chosen.add(prefixOf(history, k, 1, &index));
  }
  Segment last = history;
  while (last.keyframes.size() > 12) last = withoutKeyframe(last, 0);
  newest.add(last);
  EXPECT_TRUE(isRight(chosen, truth));
  EXPECT_EQ(chosen.segment().keyframes.size(), 12u);
  EXPECT_LT(chosen.wholeImageUncertainty().rms, 0.8 * newest.wholeImageUncertainty().rms);
}

TEST(GrowByKeyframe, BearsWhatCannotBePredicted) {
  const SimulatedSegment made = longSegment(ordinaryCameras()[0], MotionKind::kHandheld, 3, 6);
  Segment segment = made.segment;
  segment.keyframes[2].world_from_camera.rotation = Eigen::Quaterniond(0.0, 0.0, 1.0, 0.0);
  Camera camera = made.camera;
  const double cost = growByKeyframe(GrowthOptions(), 3, &segment, &camera);
  EXPECT_TRUE(std::isfinite(cost));
  EXPECT_TRUE(camera.valid());
  for (const Keyframe& keyframe : segment.keyframes) {
    EXPECT_TRUE(keyframe.world_from_camera.translation.allFinite());
  }
}

// A car that drives ahead, a meter and a small turn from keyframe to keyframe, between points
// beside its way: their depths differ by a factor of twenty.
SimulatedSegment driving(std::uint64_t seed) {
  constexpr int kKeyframes = 6;
  constexpr int kPointsAhead = 60;  // of each keyframe
  const Eigen::AlignedBox2d image(Eigen::Vector2d::Zero(), Eigen::Vector2d(1241.0, 374.0));
  Random random(seed);
  SimulatedSegment made;
  made.camera = Camera::defaultGuess(CameraModel::kPinhole, 1242, 375);
  Rigid3 pose;
  for (int k = 0; k < kKeyframes; ++k) {
    Keyframe keyframe;
    keyframe.id = k;
    keyframe.stamp_ns = k * 100'000'000;
    keyframe.world_from_camera = pose;
    made.segment.keyframes.push_back(keyframe);
    pose = pose * Rigid3(Eigen::Quaterniond(expSo3(0.01 * random.normal3())),
                         Eigen::Vector3d(0.0, 0.0, 1.0) + 0.02 * random.normal3());
  }
  for (int l = 0; l < kKeyframes * kPointsAhead; ++l) {
    Landmark landmark;
    landmark.track_id = l;
    landmark.reference = l / kPointsAhead;
    landmark.reference_pixel = {random.uniform(20.0, 1220.0), random.uniform(20.0, 355.0)};
    const auto ray = made.camera.unproject(landmark.reference_pixel);
    const double distance = 3.0 * std::pow(20.0, random.uniform(0.0, 1.0));
    landmark.bearing = *ray;
    landmark.inverse_depth = 1.0 / distance;
    const Eigen::Vector3d point =
        made.segment.keyframes[landmark.reference].world_from_camera * (distance * *ray);
    int views = 0;
    for (int k = landmark.reference + 1; k < std::min(kKeyframes, landmark.reference + 4); ++k) {
      Observation observation;
      observation.landmark = static_cast<int>(made.segment.landmarks.size());
      observation.keyframe = k;
      observation.sigma = 0.2;
      if (!made.camera.project(made.segment.keyframes[k].world_from_camera.inverse() * point,
                               &observation.pixel) ||
          !image.contains(observation.pixel)) {
        break;
      }
      observation.pixel += 0.2 * random.normal2();
      made.segment.observations.push_back(observation);
      ++views;
    }
    if (views > 0) made.segment.landmarks.push_back(landmark);
  }
  return made;
}

TEST(Bootstrap, BeginsWhileDrivingPastWhatIsNearAndFar) {
  int right = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const SimulatedSegment made = driving(seed);
    Camera camera = Camera::defaultGuess(CameraModel::kPinhole, 1242, 375);
    GrowthOptions options;
    options.prior = vaguePrior(camera);
    Segment segment = forgotten(made.segment, camera);
    const double cost = bootstrap(options, &segment, &camera);
    // A residual of two coordinates costs 1 on average.
    right += cost < 2.0 * static_cast<double>(segment.observations.size());
  }
  EXPECT_EQ(right, 20);
}

TEST(Bootstrap, GivesUpOnceTheCostIsAboveWhatIsNeeded) {
  const SimulatedSegment made = longSegment(ordinaryCameras()[1], MotionKind::kHandheld, 3, 12);
  const Camera guess = Camera::defaultGuess(made.camera.model(), 640, 480);
  const GrowthOptions options;
  const auto from = [&](double give_up_above, Segment* segment, Camera* camera) {
    *segment = forgotten(made.segment, guess);
    *camera = guess;
    return bootstrap(options, segment, camera, give_up_above);
  };
  Segment whole, good_enough, abandoned;
  Camera camera;
  const double cost = from(std::numeric_limits<double>::infinity(), &whole, &camera);
  const Eigen::VectorXd solved = camera.parameters();
  EXPECT_EQ(from(1e3 * cost, &good_enough, &camera), cost);
  EXPECT_EQ(camera.parameters(), solved);
  const double needed = 1e-3 * cost;
  const double at_the_end = from(needed, &abandoned, &camera);
  EXPECT_GT(at_the_end, needed);
  EXPECT_LT(at_the_end, cost);
  const Rigid3& first_free =
      abandoned.keyframes[options.free_after_keyframes - 1].world_from_camera;
  EXPECT_FALSE(first_free.translation.isZero());
  EXPECT_TRUE(abandoned.keyframes.back().world_from_camera.translation.isZero());
}

// With two threads the newest keyframe may find the batch busy, and is left out.
TEST(Startup, BearsKeyframesThatItNeverSees) {
  const Camera truth = ordinaryCameras()[1];
  const SimulatedSegment made = longSegment(truth, MotionKind::kHandheld, 3);
  const Startup startup = grown(made, {6, 9, 10, 14});
  EXPECT_TRUE(isRight(startup, truth));
  EXPECT_EQ(startup.segment().keyframes.size(), made.segment.keyframes.size());
}

// All tracks end before keyframe `k`; those that go on there are others.
Segment splitAt(Segment segment, int k) {
  const auto tracks = static_cast<int>(segment.landmarks.size());
  std::vector<int> rest(segment.landmarks.size(), -1);
  for (Observation& observation : segment.observations) {
    if (observation.keyframe < k || segment.landmarks[observation.landmark].reference >= k)
      continue;
    int& other = rest[observation.landmark];
    if (other < 0) {
      other = static_cast<int>(segment.landmarks.size());
      Landmark landmark;
      landmark.track_id = 100000 + observation.landmark;
      landmark.reference = observation.keyframe;
      landmark.anchored = false;
      segment.landmarks.push_back(landmark);
    }
    observation.landmark = other;
  }
  EXPECT_GT(static_cast<int>(segment.landmarks.size()), tracks);
  return segment;
}

TEST(Startup, LeavesOutWhatNoTrackConnects) {
  SimulatedSegment made = longSegment(ordinaryCameras()[1], MotionKind::kHandheld, 3, 24);
  constexpr int kSplit = 9;
  made.segment = splitAt(made.segment, kSplit);
  const Startup startup = grown(made);
  ASSERT_EQ(startup.segment().keyframes.size(), made.segment.keyframes.size() - kSplit);
  EXPECT_EQ(startup.segment().keyframes.front().id, made.segment.keyframes[kSplit].id);
  EXPECT_EQ(startup.keyframesAdded(), static_cast<int>(made.segment.keyframes.size()));
  EXPECT_TRUE(isRight(startup, made.camera));
}

// Pixels without any sense: nothing grows without end.
TEST(Startup, DoesNotRunAway) {
  for (const Camera& lens : ordinaryCameras()) {
    SimulatedSegment made = longSegment(lens, MotionKind::kForwardOnly, 5, kSanitized ? 8 : 24);
    Random random(7);
    for (Observation& observation : made.segment.observations) {
      observation.pixel = {random.uniform(0.0, 639.0), random.uniform(0.0, 479.0)};
    }
    const Startup startup = grown(made);
    EXPECT_FALSE(startup.usable() && ranAway(startup.camera())) << toString(lens.model());
    EXPECT_FALSE(startup.isInformative()) << toString(lens.model());
    for (const Keyframe& keyframe : startup.segment().keyframes) {
      EXPECT_TRUE(keyframe.world_from_camera.translation.allFinite()) << toString(lens.model());
    }
  }
}

// A lens whose distortion needs the third radial coefficient gets it, one that does not does not.
TEST(Startup, AddsK3WhenObservationsDemandIt) {
  const Camera needs =
      camera640(CameraModel::kRadtan, {350, 351, 318, 243, -0.33, 0.166, -7e-4, -1.3e-3, -0.0545});
  int right = 0;
  constexpr int kTrials = kSanitized ? 1 : 5;
  for (std::uint64_t seed = 0; seed < kTrials; ++seed) {
    const Startup startup = grown(longSegment(needs, MotionKind::kHandheld, seed));
    EXPECT_EQ(startup.camera().estimatedCount(), 9) << seed;
    EXPECT_EQ(startup.information().rows(), startup.camera().estimatedCount());
    right += isRight(startup, needs);
    const Camera without = ordinaryCameras()[2];
    EXPECT_EQ(grown(longSegment(without, MotionKind::kHandheld, seed)).camera().estimatedCount(), 8)
        << seed;
  }
  EXPECT_GE(right, kTrials - 1);
}

// As after an alarm: from the keyframes before the change, whose lens was known to 0.4 %, comes an
// estimate of the new one that is no better.
TEST(Startup, AnEarlierLensLendsWhatWasKnownOfIt) {
  const Camera before = ordinaryCameras()[1], after = zoomed(before, 1.1);
  const int count = before.estimatedCount();
  IntrinsicsMatrix doubt = IntrinsicsMatrix::Identity(count, count) * 1e-8;
  doubt.topLeftCorner<2, 2>().setConstant(std::pow(0.004 * before.parameters()(0), 2));
  doubt.topLeftCorner<2, 2>() += Eigen::Matrix2d::Identity() * 1e-2;
  int trusting_right = 0;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const SimulatedSegment made = longSegment(before, MotionKind::kHandheld, seed, 24);
    Segment history = withChange(made.segment, before, after, 6);
    setEarlierLens(zoomed(before, 1.004), 6, &history);
    std::vector<int> index;
    Segment solved = prefixOf(history, 9, 1, &index);
    Camera camera = before;
    const SegmentFit fit = fitSegment(SegmentFitOptions(), &solved, &camera);
    ASSERT_TRUE(fit.usable);
    Startup startup(StartupOptions(), before), trusting = startup;
    startup.resume(camera, fit.marginal.information, solved, doubt);
    trusting.resume(camera, fit.marginal.information, solved, IntrinsicsMatrix());
    EXPECT_TRUE(startup.halves().empty());  // nothing of the lens before
    EXPECT_FALSE(startup.comparable());
    trusting.add(prefixOf(history, 10, 1, &index));
    trusting_right += isRight(trusting, after);
    for (int k = 10; k <= 24; ++k) {
      startup.add(prefixOf(history, k, 1, &index));
      EXPECT_TRUE(isRight(startup, after)) << seed << " after keyframe " << k;
    }
    EXPECT_EQ(earlierKeyframes(startup.segment()), 6) << seed;
  }
  EXPECT_LT(trusting_right, 3);
}

// As from a map that follows: later, and no track in common.
Segment following(const Segment& before, Segment segment) {
  const Keyframe& last = before.keyframes.back();
  for (Keyframe& keyframe : segment.keyframes) {
    keyframe.id += last.id + 1;
    keyframe.stamp_ns += last.stamp_ns + 1;
  }
  for (Landmark& landmark : segment.landmarks) landmark.track_id += 100000;
  segment.sequence = segment.keyframes.back().id;
  return segment;
}

TEST(Startup, AnEndedBatchIsTakenOnce) {
  const Camera truth = ordinaryCameras()[1];
  const SimulatedSegment made = longSegment(truth, MotionKind::kHandheld, 3);
  Startup startup = grown(made);
  ASSERT_TRUE(startup.isInformative());
  EXPECT_FALSE(startup.takeFinished());  // it goes on
  const double rms = startup.wholeImageUncertainty().rms;
  const SimulatedSegment next = longSegment(truth, MotionKind::kHandheld, 4, 4);
  startup.add(following(made.segment, forgotten(next.segment, startup.camera())));
  const std::optional<Startup::Solution> finished = startup.takeFinished();
  ASSERT_TRUE(finished);
  EXPECT_LE(finished->rms, rms);
  EXPECT_EQ(finished->segment.keyframes.front().id, made.segment.keyframes.front().id);
  EXPECT_LT(pixelDistance(finished->camera, truth).rms, 4.0 * finished->rms);
  EXPECT_FALSE(startup.takeFinished());
}

// Forward motion is all that the newest keyframes show, and a batch this short holds no others.
TEST(Startup, WhatABatchForgetsIsTaken) {
  const Camera truth = ordinaryCameras()[1];
  const SimulatedSegment turning = longSegment(truth, MotionKind::kHandheld, 3, 10);
  const Camera guess = Camera::defaultGuess(truth.model(), 640, 480);
  StartupOptions options;
  options.max_keyframes = 8;
  Startup startup(options, guess);
  const Segment history = forgotten(turning.segment, guess);
  std::vector<int> index;
  for (int k = 2; k <= 10; ++k) startup.add(prefixOf(history, k, 1, &index));
  ASSERT_TRUE(startup.isInformative());
  const double rms = startup.wholeImageUncertainty().rms;
  // Tracks of the batch's newest keyframe alone connect it to what follows.
  const SimulatedSegment ahead = longSegment(truth, MotionKind::kForwardOnly, 4, 10);
  std::optional<Startup::Solution> finished;
  const Segment after = following(history, forgotten(ahead.segment, guess));
  for (int k = 4; k <= 10 && !finished; ++k) {
    startup.add(prefixOf(after, k, 1, &index));
    finished = startup.takeFinished();
  }
  ASSERT_TRUE(finished);
  EXPECT_LE(finished->rms, rms);
  EXPECT_FALSE(startup.isInformative());
}

TEST(Startup, ResetForgets) {
  const Camera truth = ordinaryCameras()[1];
  Startup startup = grown(longSegment(truth, MotionKind::kHandheld, 3));
  ASSERT_TRUE(startup.usable());
  startup.reset(truth);
  EXPECT_FALSE(startup.usable());
  EXPECT_EQ(startup.camera().parameters(), truth.parameters());
  EXPECT_TRUE(startup.segment().keyframes.empty());
}

TEST(Startup, BearsSegmentsWithoutContent) {
  const Camera guess = Camera::defaultGuess(CameraModel::kFov, 640, 480);
  Startup startup(StartupOptions(), guess);
  Segment segment;
  startup.add(segment);
  for (int k = 0; k < 12; ++k) {
    Keyframe keyframe;
    keyframe.id = k;
    segment.keyframes.push_back(keyframe);
    startup.add(segment);
    EXPECT_FALSE(startup.usable());
  }
  EXPECT_TRUE(startup.camera().valid());
}

}  // namespace
}  // namespace camera_self_calibration
