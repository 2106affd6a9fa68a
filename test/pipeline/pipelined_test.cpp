// The back end at work while the next images are located, and nothing left to chance.

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>

#include "estimation/sample_segments.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {
namespace {

const Camera kTruth = ordinaryCameras()[1];

TrackRunOptions pipelined() {
  TrackRunOptions run;
  run.mode = SelfCalibrator::Mode::kPipelined;
  return run;
}

TEST(Pipelined, TheSameInputGivesTheSameOutput) {
  TrackRun first(kTruth, optionsFor(kTruth.model()), pipelined());
  TrackRun second(kTruth, optionsFor(kTruth.model()), pipelined());
  ASSERT_TRUE(first.runUntilConverged(600)) << first.report().sentence;
  second.run(static_cast<int>(first.record.frames.size()));
  ASSERT_EQ(first.record.reports.size(), second.record.reports.size());
  for (std::size_t i = 0; i < first.record.reports.size(); ++i) {
    EXPECT_EQ(first.record.reports[i].camera.parameters(),
              second.record.reports[i].camera.parameters())
        << i;
  }
  for (std::size_t i = 0; i < first.record.frames.size(); ++i) {
    EXPECT_EQ(first.record.frames[i].world_from_camera.translation,
              second.record.frames[i].world_from_camera.translation)
        << i;
  }
  EXPECT_LT(pixelDistance(kTruth, first.report().camera).rms, 1.0);
}

// Inline a keyframe's report comes with it, pipelined with the next one; flush() brings the last.
TEST(Pipelined, AReportComesOneKeyframeLater) {
  TrackRun single(kTruth, optionsFor(kTruth.model()), TrackRunOptions());
  TrackRun run(kTruth, optionsFor(kTruth.model()), pipelined());
  // Until the first estimate the front ends of both do the same.
  while (single.record.reports.size() < 2) {
    single.step();
    run.step();
    EXPECT_EQ(run.record.reports.size() + (single.record.reports.empty() ? 0 : 1),
              single.record.reports.size());
  }
  run.calibrator().flush();
  ASSERT_EQ(run.record.reports.size(), single.record.reports.size());
  EXPECT_EQ(run.report().stamp_ns, single.report().stamp_ns);
  run.calibrator().flush();
  EXPECT_EQ(run.record.reports.size(), single.record.reports.size());
}

TEST(Pipelined, CallsBackFromTheThreadOfTheCaller) {
  const std::thread::id caller = std::this_thread::get_id();
  int calls = 0;
  const auto called = [&] {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    ++calls;
  };
  TrackRunOptions options = pipelined();
  options.listen = [&](const Callbacks&) {
    Callbacks callbacks;
    callbacks.frame = [&](const FrameResult&) { called(); };
    callbacks.calibration = [&](const CalibrationReport&) { called(); };
    callbacks.event = [&](const Event&) { called(); };
    callbacks.keyframe = [&](const KeyframeMessage&) { called(); };
    callbacks.map = [&](const MapView&) { called(); };
    return callbacks;
  };
  TrackRun run(kTruth, optionsFor(kTruth.model()), options);
  run.run(30);
  run.calibrator().flush();
  EXPECT_GT(calls, 30);
}

// What a listener throws reaches the caller, as inline, and what is learnt stays.
TEST(Pipelined, AnExceptionReachesTheCaller) {
  bool fails = false;
  TrackRunOptions options = pipelined();
  options.listen = [&](Callbacks callbacks) {
    callbacks.calibration = [&](const CalibrationReport&) {
      if (fails) throw std::runtime_error("a listener failed");
    };
    return callbacks;
  };
  TrackRun run(kTruth, optionsFor(kTruth.model()), options);
  ASSERT_TRUE(run.runUntilConverged(600)) << run.report().sentence;
  fails = true;
  EXPECT_THROW(run.run(60), std::runtime_error);
  fails = false;
  run.run(60);
  EXPECT_EQ(run.report().state, CalibrationState::kConverged) << run.report().sentence;
}

// The back end is still busy with a keyframe from before it.
TEST(Pipelined, AResetForgetsWhatIsUnderWay) {
  TrackRun run(kTruth, optionsFor(kTruth.model()), pipelined());
  ASSERT_TRUE(run.runUntilConverged(600)) << run.report().sentence;
  run.calibrator().reset();
  run.step();
  run.calibrator().flush();
  EXPECT_NE(run.report().state, CalibrationState::kConverged);
  EXPECT_FALSE(run.report().handed_over);
  EXPECT_FALSE(run.calibrator().state());
  ASSERT_TRUE(run.runUntilConverged(600)) << run.report().sentence;
}

}  // namespace
}  // namespace camera_self_calibration
