#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "benchmark/changing_tracks.h"
#include "benchmark/random_lens.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/map/segment_edit.h"
#include "camera_self_calibration/pipeline/front_end.h"
#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/state_file.h"
#include "lens_change/change_samples.h"
#include "pipeline/track_run.h"
#include "sanitized.h"

namespace camera_self_calibration {
namespace {

constexpr double kChangeS = 20.0;

TrackRunOptions runWith(const std::function<Camera(double)>& lens) {
  TrackRunOptions run;
  run.rate_hz = 10.0;
  run.max_features = 60;
  run.lens = lens;
  return run;
}

const Event* firstChange(const Record& record) {
  for (const Event& event : record.events) {
    if (event.type == EventType::kCalibrationChange) return &event;
  }
  return nullptr;
}

std::int64_t newestSegmentNs(const CalibrationReport& report) {
  std::int64_t newest_ns = 0;
  for (const SegmentReport& segment : report.queue.segments) {
    newest_ns = std::max(newest_ns, segment.end_ns);
  }
  return newest_ns;
}

double since(std::int64_t stamp_ns) { return toSeconds(stamp_ns) - 1.0; }

TEST(Change, AZoomIsNoticedDatedAndLearntAnew) {
  const auto cameras = ordinaryCameras();
  for (std::size_t i = 0; i < (kSanitized ? 1 : cameras.size()); ++i) {
    const Camera before = cameras[i];
    const Camera after = zoomed(before, 1.10);
    TrackRun run(before, optionsFor(before.model()),
                 runWith([&](double t) { return t < kChangeS ? before : after; }));
    run.run(270);
    ASSERT_EQ(run.record.count(EventType::kCalibrationChange), 1) << toString(before.model());
    const Event change = *firstChange(run.record);
    EXPECT_NEAR(since(change.onset_stamp_ns), kChangeS, 0.3) << toString(before.model());
    EXPECT_LT(since(change.stamp_ns), kChangeS + 2.0) << toString(before.model());
    EXPECT_EQ(change.epoch, 1u);
    // From the three or four keyframes since then.
    EXPECT_NEAR(change.magnitude_px / pixelDistance(before, after).rms, 1.0, 0.25);
    EXPECT_LT(change.p_value, 1e-5);  // the share of one keyframe of 0.1 alarms per hour
    const CalibrationReport report = run.report();
    EXPECT_EQ(report.epoch, 1u);
    EXPECT_EQ(report.state, CalibrationState::kConverged) << report.sentence;
    EXPECT_NEAR(report.camera.parameters()(0) / after.parameters()(0), 1.0, 0.003);
    // The same map before and after.
    EXPECT_EQ(run.record.frames.back().map_id, run.record.frames.front().map_id);
    EXPECT_EQ(run.record.count(EventType::kLost), 0);
    const auto state = run.calibrator().state();
    ASSERT_TRUE(state);
    const DecodedState decoded = decodeState(encode(*state));
    ASSERT_TRUE(decoded.state) << decoded.error;
    EXPECT_EQ(decoded.state->segments.size(), state->segments.size());
  }
}

// Stamps from before the change are no reason to take what comes for the old lens.
TEST(Change, LearningGoesOnWhereTheClockIsSetBackBeyondIt) {
  const Camera before = ordinaryCameras()[1], after = zoomed(before, 1.10);
  TrackRun run(before, optionsFor(before.model()),
               runWith([&](double t) { return t < kChangeS ? before : after; }));
  run.run(250);
  ASSERT_EQ(run.report().epoch, 1u);
  run.setClockBack(20.0);
  const std::int64_t newest_ns = newestSegmentNs(run.report());
  run.run(100);
  EXPECT_EQ(run.report().epoch, 1u);
  EXPECT_EQ(run.report().state, CalibrationState::kConverged) << run.report().sentence;
  // Segments from after the jump are in the queue: they end before the newest from before it.
  int learnt = 0;
  for (const SegmentReport& segment : run.report().queue.segments) {
    learnt += segment.begin_ns < newest_ns - 12000000000;
  }
  EXPECT_GT(learnt, 0);
}

// The keyframe that a front end hands on next, after 30 images that begin at 1 s, when it is told
// of a change of the lens with this onset.
KeyframeMessage nextAfterChange(double onset_s) {
  const Camera lens = ordinaryCameras()[1];
  Options options = optionsFor(lens.model());
  options.estimate_readout = false;  // which keyframes would wait for
  FrontEnd front_end(options, lens);
  FeatureTracks tracks(makeRoom(RoomOptions()), Lens{lens, std::nullopt, 1.0},
                       syntheticMotion(SyntheticMotionOptions()), FeatureTracksOptions());
  for (int i = 0; i < 100; ++i) {
    if (i == 30) {
      CalibrationUpdate update;
      update.camera = zoomed(lens, 1.001);
      update.generation = update.epoch = 1;
      update.onset_ns = static_cast<std::int64_t>(1e9 * onset_s);
      front_end.adopt(update);
    }
    const TrackedFrame frame = tracks.track(1000000000 + i * 100000000LL);
    const FrontEndOutput output = front_end.process(frame, [&] { return tracks.detect(); });
    tracks.drop(output.outliers);
    if (i >= 30 && output.keyframe) return *output.keyframe;
  }
  ADD_FAILURE() << "no keyframe";
  return {};
}

// Found just before the clock was set back: the map that it is told to began after the change.
TEST(Change, AnOnsetThatIsYetToComePutsNoKeyframeBeforeTheChange) {
  const KeyframeMessage within = nextAfterChange(3.5);
  ASSERT_FALSE(within.history.held_lenses.empty());
  EXPECT_GT(earlierKeyframes(within.history), 0);
  const KeyframeMessage later = nextAfterChange(25.0);
  EXPECT_EQ(later.history.keyframes.size(), within.history.keyframes.size());
  EXPECT_EQ(earlierKeyframes(later.history), 0);
  EXPECT_GT(later.candidate.keyframes.size(), within.candidate.keyframes.size());
  EXPECT_EQ(earlierKeyframes(later.candidate), 0);
}

// While the lens after the first change is still being learnt.
TEST(Change, ASecondOneSoonAfterTheFirstIsNoticedToo) {
  const auto cameras = ordinaryCameras();
  for (std::size_t i = 1; i < (kSanitized ? 2 : cameras.size()); ++i) {
    const Camera before = cameras[i];
    const Camera between = zoomed(before, 1.10);
    const Camera after = zoomed(before, 1.20);
    constexpr double kSecondS = kChangeS + 2.5;
    TrackRun run(before, optionsFor(before.model()), runWith([&](double t) {
                   return t < kChangeS ? before : t < kSecondS ? between : after;
                 }));
    run.run(330);
    ASSERT_GE(run.record.count(EventType::kCalibrationChange), 2) << toString(before.model());
    const Event* second = nullptr;
    for (const Event& event : run.record.events) {
      if (second == nullptr && since(event.stamp_ns) > kSecondS) second = &event;
    }
    ASSERT_NE(second, nullptr);
    EXPECT_EQ(second->type, EventType::kCalibrationChange);
    EXPECT_LT(since(second->stamp_ns), kSecondS + 2.0) << toString(before.model());
    EXPECT_TRUE(run.runUntilConverged(90))
        << toString(before.model()) << ": " << run.report().sentence;
    const CalibrationReport report = run.report();
    EXPECT_LT(pixelDistance(after, report.camera).rms, 1.0) << toString(before.model());
  }
}

// Another focal length every eight seconds, which comes while the queue holds two or three
// segments or has not taken over at all, even while the first lens is being learnt.
TEST(Change, OneAfterTheOtherIsNoticed) {
  constexpr double kFactors[] = {1.0, 0.9, 1.12, 1.04, 0.88, 0.95};
  constexpr int kChanges = kSanitized ? 2 : 5;
  const Camera first = ordinaryCameras()[1];
  const auto lensAt = [&](double t) {
    const int change = std::min(static_cast<int>((t + 1e-6) / 8.0), kChanges);
    return zoomed(first, kFactors[change]);
  };
  for (const std::uint64_t seed : {7, 8}) {
    TrackRunOptions options = runWith(lensAt);
    options.duration_s = 8.0 * (kChanges + 1);
    options.seed = seed;
    TrackRun run(first, optionsFor(first.model()), options);
    for (int change = 0; change <= kChanges; ++change) {
      run.run(80);
      EXPECT_EQ(run.record.count(EventType::kCalibrationChange), change) << seed;
      const CalibrationReport report = run.report();
      const double error = pixelDistance(report.camera, lensAt(8.0 * change)).rms;
      EXPECT_LT(error, 3.0 * report.uncertainty.rms) << seed << " after change " << change;
      EXPECT_LT(error, 2.0) << seed << " after change " << change;
    }
  }
}

// Ten images a second of the benchmark's tracks.
class BenchmarkRun {
 public:
  template <typename Lens>
  BenchmarkRun(const ChangingTracks& options, const Camera& first, const Lens& lens)
      : tracks_(makeTracks(options, first, lens)),
        calibrator_(optionsOf(options, first), SelfCalibrator::Mode::kInline, record.callbacks()) {}

  // Until the first change is noticed, at most so many frames.
  void run(int frames) {
    for (int i = 0; i < frames && firstChange(record) == nullptr; ++i) {
      const TrackedFrame frame = tracks_.track(kChangingTracksStartNs + i * 100000000LL);
      calibrator_.processTracks(frame, [&] { return tracks_.detect(); });
    }
  }
  CalibrationReport report() { return calibrator_.calibration(); }

  Record record;

 private:
  static Options optionsOf(const ChangingTracks& options, const Camera& camera) {
    Options calibration = optionsFor(camera.model());
    calibration.tracker.max_features = options.features;
    return calibration;
  }

  FeatureTracks tracks_;
  SelfCalibrator calibrator_;
};

// Where the first segments do not contradict the queue, which takes them in, the focal length
// seemed to drift, and no test of the newest segments against that queue said otherwise. Such a
// step may go unreported, as one in four does, but then the estimate follows it, within what it
// states. One in thirty still seems to drift for a while.
TEST(Change, ASmallStepIsNotTakenForADrift) {
  constexpr double kStepS = 30.0;
  constexpr int kTrials = 6;
  int noticed = 0, drifting = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    ChangingTracks options;
    options.seed = 7001 + trial;
    const Camera before = randomLens(CameraModel::kRadtan, 640, 480, options.seed).camera;
    const Camera after = zoomed(before, 1.01);
    BenchmarkRun run(options, before, [&](double t) { return t < kStepS ? before : after; });
    run.run(450);
    const CalibrationReport report = run.report();
    EXPECT_LT(pixelDistance(after, report.camera).rms, 3.0 * report.uncertainty.rms);
    drifting += report.sentence.find("drifts") != std::string::npos;
    const Event* change = firstChange(run.record);
    if (change == nullptr) continue;
    ++noticed;
    EXPECT_GT(since(change->stamp_ns), kStepS);
    EXPECT_NEAR(since(change->onset_stamp_ns), kStepS, 3.0);
    EXPECT_NEAR(change->magnitude_px / pixelDistance(before, after).rms, 1.0, 0.3);
  }
  EXPECT_GE(noticed, kTrials / 2);
  EXPECT_LE(drifting, 1);
}

// A window of this one contradicts the queue, which lags behind, as clearly as after a step.
TEST(Change, ASlowDriftIsFollowedWithoutAnAlarm) {
  constexpr double kDriftS = 30.0;
  ChangingTracks options;
  options.seed = 420001;
  options.duration_s = 105.0;
  const Camera before = randomLens(CameraModel::kRadtan, 640, 480, options.seed).camera;
  const auto lensAt = [&](double t) {
    return zoomed(before, 1.0 + 0.01 * std::max(0.0, t - kDriftS) / 60.0);
  };
  BenchmarkRun run(options, before, lensAt);
  run.run(600);
  EXPECT_EQ(run.record.count(EventType::kCalibrationChange), 0);
  const CalibrationReport report = run.report();
  EXPECT_NE(report.sentence.find("drifts"), std::string::npos) << report.sentence;
  EXPECT_LT(pixelDistance(lensAt(60.0), report.camera).rms, 3.0 * report.uncertainty.rms);
}

TEST(Change, PosesGoOnAcrossIt) {
  const Camera before = ordinaryCameras()[1];
  const Camera after = zoomed(before, 1.10);
  TrackRun run(before, optionsFor(before.model()),
               runWith([&](double t) { return t < kChangeS ? before : after; }));
  run.run(260);
  // Rotations since some frame before the change are right long after it.
  const FrameResult& first = run.record.frames[150];
  for (const std::size_t i : {195u, 230u, 259u}) {
    const FrameResult& frame = run.record.frames[i];
    const auto relative = [](const Rigid3& a, const Rigid3& b) { return a.inverse() * b; };
    const Rigid3 estimate = relative(first.world_from_camera, frame.world_from_camera);
    const Rigid3 truth = relative(run.tracks().worldFromCamera(first.stamp_ns),
                                  run.tracks().worldFromCamera(frame.stamp_ns));
    EXPECT_LT(estimate.rotation.angularDistance(truth.rotation), 0.03) << i;
  }
  // And so is the scale, once the lens is known again: before, poses still move with it.
  const auto scale = [&](std::size_t from, std::size_t to) {
    double estimate = 0.0, truth = 0.0;
    for (std::size_t i = from; i < to; ++i) {
      const FrameResult& a = run.record.frames[i];
      const FrameResult& b = run.record.frames[i + 1];
      estimate += (b.world_from_camera.translation - a.world_from_camera.translation).norm();
      truth += (run.tracks().worldFromCamera(b.stamp_ns).translation -
                run.tracks().worldFromCamera(a.stamp_ns).translation)
                   .norm();
    }
    return estimate / truth;
  };
  EXPECT_NEAR(scale(230, 259) / scale(110, 150), 1.0, 0.15);
}

TEST(Change, ASettingThatReturnsIsRecognised) {
  const Camera before = ordinaryCameras()[1];
  const Camera after = zoomed(before, 1.08);
  TrackRun run(before, optionsFor(before.model()), runWith([&](double t) {
                 return t < kChangeS || t > kChangeS + 15.0 ? before : after;
               }));
  run.run(420);
  EXPECT_EQ(run.record.count(EventType::kCalibrationChange), 2);
  bool recognised = false;
  for (const Event& event : run.record.events) {
    recognised = recognised || event.sentence.find("known from epoch 0") != std::string::npos;
  }
  EXPECT_TRUE(recognised);
  EXPECT_EQ(run.report().state, CalibrationState::kConverged);
  EXPECT_NEAR(run.report().camera.parameters()(0) / before.parameters()(0), 1.0, 0.002);
}

// Bad data: the lens is covered, or the scene moves for a while.
TEST(Change, BadDataChangesNothing) {
  const Camera truth = ordinaryCameras()[1];
  TrackRun run(truth, optionsFor(truth.model()), runWith(nullptr));
  ASSERT_TRUE(run.runUntilConverged(300));
  run.run(60);
  run.runBlind(30);
  run.run(100);
  EXPECT_EQ(run.record.count(EventType::kCalibrationChange), 0);
  EXPECT_EQ(run.report().epoch, 0u);
  EXPECT_LT(pixelDistance(truth, run.report().camera).rms, 0.5);
}

TEST(Change, IsNeverReportedAtARateOfZero) {
  const Camera before = ordinaryCameras()[1];
  const Camera after = zoomed(before, 1.10);
  Options options = optionsFor(before.model());
  options.false_alarms_per_hour = 0.0;
  TrackRun run(before, options, runWith([&](double t) { return t < kChangeS ? before : after; }));
  run.run(240);
  EXPECT_EQ(run.record.count(EventType::kCalibrationChange), 0);
}

}  // namespace
}  // namespace camera_self_calibration
