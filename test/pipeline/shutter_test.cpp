#include <gtest/gtest.h>

#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/map/rolling_shutter.h"
#include "camera_self_calibration/pipeline/front_end.h"
#include "camera_self_calibration/pipeline/state_file.h"
#include "camera_self_calibration/queue/segment_queue.h"
#include "estimation/sample_segments.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {
namespace {

constexpr double kReadout = 0.015;  // [s]
constexpr int kFrames = 420;

TrackRunOptions tracksWith(double readout_s) {
  TrackRunOptions options;
  options.rate_hz = 30.0;
  options.motion_speed = 1.0;
  options.pixel_sigma = 0.15;
  options.readout_s = readout_s;
  options.duration_s = 30.0;
  return options;
}

struct Learnt {
  CalibrationReport report;
  double error_px = 0.0;
  std::shared_ptr<const LearntState> state;
};

Learnt learn(const Camera& truth, double readout_s, const std::string& rolling_shutter) {
  Options options = optionsFor(truth.model());
  EXPECT_TRUE(setRollingShutter(rolling_shutter, &options));
  TrackRun run(truth, options, tracksWith(readout_s));
  run.run(kFrames);
  return {run.report(), pixelDistance(truth, run.report().camera).rms, run.calibrator().state()};
}

const Learnt& rolling() {
  static const Learnt learnt = learn(ordinaryCameras()[1], kReadout, "auto");
  return learnt;
}

TEST(Shutter, ReadoutTimeIsLearntWithTheIntrinsics) {
  const CalibrationReport& report = rolling().report;
  EXPECT_EQ(report.state, CalibrationState::kConverged) << report.sentence;
  EXPECT_TRUE(report.shutter.rolls);
  EXPECT_NEAR(report.shutter.readout_s, kReadout, 3.0 * report.shutter.sigma_s);
  EXPECT_LT(report.shutter.sigma_s, 0.02 * kReadout);
  const Learnt global = learn(ordinaryCameras()[1], 0.0, "off");
  EXPECT_LT(rolling().error_px, 2.0 * global.error_px + report.uncertainty.rms);
  EXPECT_LT(rolling().error_px, 3.0 * report.uncertainty.rms);
  std::cout << describe(report.shutter) << "; " << rolling().error_px << " px, global shutter "
            << global.error_px << " px\n";
}

TEST(Shutter, StampsOfArrivalDoNotSpoilIt) {
  TrackRunOptions tracks = tracksWith(kReadout);
  tracks.stamp_jitter_s = 4e-3;
  const Camera truth = ordinaryCameras()[1];
  TrackRun run(truth, optionsFor(truth.model()), tracks);
  run.run(kFrames);
  const CalibrationReport report = run.report();
  EXPECT_EQ(report.state, CalibrationState::kConverged) << report.sentence;
  EXPECT_NEAR(report.shutter.readout_s, kReadout, 0.05 * kReadout)
      << "8 % too short by the stamps alone";
  EXPECT_LT(pixelDistance(truth, report.camera).rms, 3.0 * report.uncertainty.rms);
}

// By differences to the neighbouring images alone it is 5 sigma too long.
TEST(Shutter, AHandThatShakesFastDoesNotSpoilIt) {
  TrackRunOptions tracks = tracksWith(0.027);
  tracks.motion_speed = 2.5;
  const Camera truth = ordinaryCameras()[1];
  TrackRun run(truth, optionsFor(truth.model()), tracks);
  run.run(kFrames);
  const CalibrationReport report = run.report();
  EXPECT_EQ(report.state, CalibrationState::kConverged) << report.sentence;
  EXPECT_NEAR(report.shutter.readout_s, 0.027, 3.0 * report.shutter.sigma_s);
  EXPECT_LT(pixelDistance(truth, report.camera).rms, 3.0 * report.uncertainty.rms);
  std::cout << describe(report.shutter) << "; " << pixelDistance(truth, report.camera).rms
            << " px, stated " << report.uncertainty.rms << " px\n";
}

int mostImages(const KeyframeMessage& message) {
  int most = 0;
  for (const Observation& observation : message.candidate.observations) {
    if (observation.keyframe + 1 < static_cast<int>(message.candidate.keyframes.size())) continue;
    most = std::max(most, observation.shift.motion.images);
  }
  return most;
}

// With "off" there is no motion to wait for.
TEST(Shutter, AKeyframeIsHandedOnWhenTheMotionInItIsKnown) {
  for (const bool rolls : {true, false}) {
    const Camera truth = ordinaryCameras()[1];
    Options options = optionsFor(truth.model());
    ASSERT_TRUE(setRollingShutter(rolls ? "auto" : "off", &options));
    TrackRun run(truth, options, tracksWith(kReadout));
    int messages = 0;
    run.record.on_keyframe = [&](const KeyframeMessage& message) {
      EXPECT_EQ(message.candidate.keyframes.back().id, messages);
      EXPECT_EQ(message.keyframes, ++messages) << "each once";
      if (messages == 1) return;  // at once: it says nothing but that the map begins
      EXPECT_EQ(message.history.endNs(), message.candidate.endNs());
      const std::int64_t newest = run.record.frames.empty() ? 0 : run.record.frames.back().stamp_ns;
      const double late_s = toSeconds(newest - message.candidate.endNs());
      EXPECT_NEAR(late_s, rolls ? 1.0 / 30.0 : -1.0 / 30.0, 1e-3)
          << "the present frame comes later";
      EXPECT_EQ(mostImages(message), rolls ? 5 : 0);
    };
    run.run(60);
    EXPECT_GT(messages, 5);
  }
}

TEST(Shutter, GlobalOneIsFoundToBeGlobal) {
  const Learnt learnt = learn(ordinaryCameras()[1], 0.0, "auto");
  EXPECT_FALSE(learnt.report.shutter.rolls) << describe(learnt.report.shutter);
  EXPECT_NEAR(learnt.report.shutter.readout_s, 0.0, 4.0 * learnt.report.shutter.sigma_s);
  EXPECT_LT(learnt.report.shutter.sigma_s, 1e-3);
  EXPECT_LT(learnt.error_px, 3.0 * learnt.report.uncertainty.rms);
}

TEST(Shutter, GivenReadoutTimeIsUsedAsItIs) {
  const Learnt learnt = learn(ordinaryCameras()[1], kReadout, "0.015");
  EXPECT_EQ(learnt.report.state, CalibrationState::kConverged);
  EXPECT_EQ(learnt.report.shutter.readout_s, kReadout);
  EXPECT_EQ(learnt.report.shutter.sigma_s, 0.0);
  EXPECT_LT(learnt.error_px, 3.0 * learnt.report.uncertainty.rms);
}

TEST(Shutter, StateKeepsIt) {
  const Camera truth = ordinaryCameras()[1];
  ASSERT_TRUE(rolling().state);
  const DecodedState decoded = decodeState(encode(*rolling().state));
  ASSERT_TRUE(decoded.state) << decoded.error;
  TrackRun run(truth, optionsFor(truth.model()), tracksWith(kReadout));
  run.calibrator().restore(decoded.state);
  run.run(90);
  EXPECT_EQ(run.record.reports.front().state, CalibrationState::kConverged);
  EXPECT_TRUE(run.report().shutter.rolls);
  EXPECT_NEAR(run.report().shutter.readout_s, rolling().report.shutter.readout_s,
              rolling().report.shutter.sigma_s);
  EXPECT_EQ(run.record.count(EventType::kCalibrationChange), 0);
}

// The least cost with the line delay held, poses, depths and intrinsics solved for.
double solvedCost(double line_delay_s, const std::vector<Candidate>& candidates, Camera camera) {
  std::vector<Segment> segments;
  for (const Candidate& candidate : candidates) {
    segments.push_back(candidate.segment);
    setLineDelayOfScene(line_delay_s, camera, &segments.back());
  }
  Problem problem{&camera, true, {}};
  for (std::size_t i = 0; i < segments.size(); ++i) {
    problem.blocks.push_back(freeBlock(&segments[i], camera));
    problem.blocks.back().sigma_scale = candidates[i].sigma_scale;
  }
  return solve(problem, SolverOptions()).final_cost;
}

TEST(Shutter, ProfileToFirstOrderIsThatOfSolutions) {
  ASSERT_TRUE(rolling().state);
  SegmentQueue queue(QueuePolicy(20, 0.95), 1);
  queue.rebuild(rolling().state->segments, {rolling().state->camera});
  const std::vector<Candidate>& candidates = queue.candidates();
  const QueueSolution& solution = queue.solution();
  ASSERT_EQ(candidates.size(), rolling().state->segments.size());
  const LineDelayEstimate estimate = queue.lineDelay();
  ASSERT_TRUE(estimate.usable);
  const double present = candidates.front().segment.keyframes.front().line_delay_s;
  const double step = 2.0 * estimate.sigma_s;
  const double before = solvedCost(present - step, candidates, solution.camera);
  const double here = solvedCost(present, candidates, solution.camera);
  const double after = solvedCost(present + step, candidates, solution.camera);
  const double bend = (before - 2.0 * here + after) / (step * step);
  const double solved = present - 0.5 * (after - before) / step / bend;
  EXPECT_NEAR(estimate.line_delay_s, solved, 0.3 * estimate.sigma_s);
  EXPECT_NEAR(estimate.sigma_s * std::sqrt(bend), solution.scatter.birgeRatio(), 0.15);
}

TEST(Shutter, PixelsCanBePutBack) {
  ASSERT_TRUE(rolling().state);
  const Camera truth = ordinaryCameras()[1];
  const Segment freed = rolling().state->segments.front().segment;
  Segment segment = freed;
  setLineDelay(0.0, truth.height(), &segment);
  double moved = 0.0;
  double left = 0.0;
  for (std::size_t i = 0; i < segment.observations.size(); ++i) {
    const Observation& before = freed.observations[i];
    const Eigen::Vector2d& seen = segment.observations[i].pixel;
    moved = std::max(moved, (seen - before.pixel).norm());
    left = std::max(left, (seen - before.pixel - before.shift.shift).norm());
  }
  EXPECT_GT(moved, 1.0) << "pixels as they were seen";
  EXPECT_LT(left, 1e-9);
  setLineDelayOfScene(freed.keyframes.front().line_delay_s, truth, &segment);
  double apart = 0.0;
  for (std::size_t i = 0; i < segment.observations.size(); ++i) {
    apart = std::max(apart, (segment.observations[i].pixel - freed.observations[i].pixel).norm());
  }
  EXPECT_LT(apart, 0.03) << "and freed again, with the structure solved since";
}

TEST(Shutter, WordsAndNumbersAreRead) {
  Options options;
  EXPECT_TRUE(setRollingShutter("off", &options));
  EXPECT_FALSE(options.estimate_readout);
  EXPECT_EQ(options.readout_s, 0.0);
  EXPECT_TRUE(setRollingShutter("-0.02", &options));
  EXPECT_EQ(options.readout_s, -0.02);
  EXPECT_TRUE(options.problems().empty());
  EXPECT_FALSE(setRollingShutter("15 ms", &options));
  EXPECT_EQ(options.readout_s, -0.02) << "nothing changed";
  EXPECT_TRUE(setRollingShutter("15", &options));
  EXPECT_FALSE(options.problems().empty()) << "milliseconds for seconds";
  EXPECT_TRUE(setRollingShutter("auto", &options));
  EXPECT_TRUE(options.estimate_readout);
}

}  // namespace
}  // namespace camera_self_calibration
