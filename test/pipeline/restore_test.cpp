// A saved state as the start of another run: of the same lens, and of another one.

#include <gtest/gtest.h>

#include <iostream>
#include <stdexcept>

#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/state_file.h"
#include "estimation/sample_segments.h"
#include "pipeline/track_run.h"
#include "sanitized.h"

namespace camera_self_calibration {
namespace {

constexpr int kLaterFrames = 700;  // the second run's stamps come after the first one's

std::shared_ptr<const LearntState> learn(const Camera& truth) {
  TrackRun run(truth, optionsFor(truth.model()), TrackRunOptions());
  EXPECT_TRUE(run.runUntilConverged(600));
  run.run(150);
  const auto state = decodeState(encode(*run.calibrator().state()));
  EXPECT_TRUE(state.state) << state.error;
  return state.state;
}

/// The second run, with another motion, from what the first one learnt.
class Second {
 public:
  Second(const Camera& truth, std::shared_ptr<const LearntState> state, std::uint64_t seed)
      : run(truth, optionsFor(truth.model()), runOf(seed)) {
    run.calibrator().restore(state);
    run.seek(kLaterFrames);
  }

  /// The first event of a type, or null.
  const Event* event(EventType type) const {
    for (const Event& e : run.record.events) {
      if (e.type == type) return &e;
    }
    return nullptr;
  }
  bool runUntil(EventType type, int frames) {
    for (int i = 0; i < frames && event(type) == nullptr; ++i) run.step();
    return event(type) != nullptr;
  }

  TrackRun run;

 private:
  static TrackRunOptions runOf(std::uint64_t seed) {
    TrackRunOptions options;
    options.seed = seed;
    return options;
  }
};

Camera changed(const Camera& camera, const std::vector<double>& factors) {
  Intrinsics parameters = camera.parameters();
  for (std::size_t i = 0; i < factors.size(); ++i) parameters(i) *= factors[i];
  Camera other = camera;
  other.setParameters(parameters);
  return other;
}

TEST(Restore, ConvergedAtTheFirstKeyframeAndConfirmedByNewImages) {
  for (const Camera& truth : ordinaryCameras()) {
    const auto state = learn(truth);
    for (std::uint64_t seed = 11; seed <= (kSanitized ? 11 : 12); ++seed) {
      Second second(truth, state, seed);
      second.run.step();
      const CalibrationReport first = second.run.report();
      EXPECT_EQ(first.state, CalibrationState::kConverged) << first.sentence;
      EXPECT_NE(first.sentence.find("restored"), std::string::npos);
      EXPECT_EQ(second.run.record.count(EventType::kConverged), 1);
      EXPECT_LT(pixelDistance(state->camera, first.camera).rms, 0.02);
      EXPECT_LT(first.uncertainty.rms, 1.0);
      EXPECT_EQ(first.queue.segments.size(), state->segments.size());
      ASSERT_TRUE(second.runUntil(EventType::kHandover, 600))
          << toString(truth.model()) << " seed " << seed << ": " << second.run.report().sentence;
      std::cout << toString(truth.model()) << " seed " << seed << ": after "
                << second.run.record.frames.size() << " frames, "
                << second.event(EventType::kHandover)->sentence << "\n";
      second.run.run(60);
      const CalibrationReport later = second.run.report();
      EXPECT_EQ(second.event(EventType::kCalibrationChange), nullptr);
      EXPECT_EQ(later.state, CalibrationState::kConverged);
      EXPECT_EQ(later.epoch, 0u);
      EXPECT_LT(pixelDistance(truth, later.camera).rms, 0.5);
      EXPECT_GE(later.queue.segments.size(), first.queue.segments.size());
      EXPECT_GT(later.revision, state->revision);
      EXPECT_EQ(later.sentence.find("restored"), std::string::npos);
      EXPECT_TRUE(segmentsAreDisjoint(later.queue));
    }
  }
}

TEST(Restore, AnotherLensIsNoticedAndLearntAnew) {
  const Camera before = ordinaryCameras()[1];
  const auto state = learn(before);
  for (const std::vector<double>& factors :
       {std::vector<double>{1.08, 1.08}, {0.92, 0.92}, {1.4, 1.4}, {1.0, 1.0, 1.0, 1.0, 0.8}}) {
    const Camera truth = changed(before, factors);
    Second second(truth, state, 21);
    ASSERT_TRUE(second.runUntil(EventType::kCalibrationChange, 600))
        << factors[0] << ": " << second.run.report().sentence;
    const Event event = *second.event(EventType::kCalibrationChange);
    std::cout << pixelDistance(before, truth).rms << " px away, after "
              << second.run.record.frames.size() << " frames: " << event.sentence << "\n";
    EXPECT_LE(event.onset_stamp_ns, event.stamp_ns);
    EXPECT_EQ(event.epoch, 1u);
    EXPECT_NEAR(event.magnitude_px / pixelDistance(before, truth).rms, 1.0, 0.3);
    const CalibrationReport noticed = second.run.report();
    EXPECT_EQ(noticed.epoch, 1u);
    EXPECT_GT(noticed.revision, state->revision);
    ASSERT_TRUE(second.run.runUntilConverged(600)) << second.run.report().sentence;
    EXPECT_LT(pixelDistance(truth, second.run.report().camera).rms, 1.0);
    EXPECT_EQ(second.run.record.count(EventType::kCalibrationChange), 1);
    ASSERT_TRUE(second.run.calibrator().state());
    EXPECT_EQ(second.run.calibrator().state()->epoch, 1u);
  }
}

// CONVERGED says how good it is now, by the present limit, whatever it was when it was saved.
TEST(Restore, WhatIsNotGoodEnoughAnyMoreIsNotConverged) {
  const Camera truth = ordinaryCameras()[1];
  const auto state = learn(truth);
  ASSERT_EQ(state->state, CalibrationState::kConverged);
  Options options = optionsFor(truth.model());
  options.converged_pixel_rms = 1e-3;  // far below what the state is good to
  TrackRun run(truth, options, TrackRunOptions());
  run.calibrator().restore(state);
  run.seek(kLaterFrames);
  run.step();
  EXPECT_EQ(run.report().state, CalibrationState::kConverging) << run.report().sentence;
  EXPECT_EQ(run.record.count(EventType::kConverged), 0);
}

// Images that tell nothing neither confirm nor contradict.
TEST(Restore, WithoutInformationItStaysConvergedAndUnconfirmed) {
  const Camera truth = ordinaryCameras()[1];
  TrackRunOptions options;
  options.motion = MotionKind::kForwardOnly;
  TrackRun run(truth, optionsFor(truth.model()), options);
  run.calibrator().restore(learn(truth));
  run.seek(kLaterFrames);
  run.run(150);
  EXPECT_EQ(run.report().state, CalibrationState::kConverged);
  EXPECT_EQ(run.record.count(EventType::kCalibrationChange), 0);
  EXPECT_LT(pixelDistance(truth, run.report().camera).rms, 0.5);
}

TEST(Restore, OfAnotherSizeOrModelIsRefusedInWords) {
  const auto state = learn(ordinaryCameras()[1]);
  const Camera small = Camera::defaultGuess(CameraModel::kFov, 320, 240);
  TrackRun run(small, optionsFor(CameraModel::kFov), TrackRunOptions());
  run.calibrator().restore(state);
  run.run(3);
  ASSERT_EQ(run.record.count(EventType::kInput), 1);
  EXPECT_NE(run.record.events.front().sentence.find("640 x 480"), std::string::npos);
  EXPECT_EQ(run.report().camera.width(), 320);
  EXPECT_NE(run.report().state, CalibrationState::kConverged);

  SelfCalibrator other(optionsFor(CameraModel::kPinhole), SelfCalibrator::Mode::kInline, {});
  EXPECT_THROW(other.restore(state), std::invalid_argument);
  EXPECT_THROW(other.restore(nullptr), std::invalid_argument);
  EXPECT_THROW(other.restore(std::make_shared<LearntState>()), std::invalid_argument);
}

TEST(Restore, WhereTheModelIsChosenAStateOfAnyModelIsConfirmed) {
  for (const Camera& truth : ordinaryCameras()) {
    const auto state = learn(truth);
    TrackRunOptions later;
    later.seed = 13;
    TrackRun run(truth, Options(), later);
    run.calibrator().restore(state);
    run.seek(kLaterFrames);
    for (int i = 0; i < 600 && run.record.count(EventType::kHandover) == 0; ++i) run.step();
    EXPECT_EQ(run.record.count(EventType::kHandover), 1) << toString(truth.model());
    EXPECT_EQ(run.record.count(EventType::kCalibrationChange), 0) << toString(truth.model());
    EXPECT_LT(pixelDistance(truth, run.report().camera).rms, 1.0);
  }
}

}  // namespace
}  // namespace camera_self_calibration
