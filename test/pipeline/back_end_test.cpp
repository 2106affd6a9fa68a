// The back end's state machine, driven by what the front end of a simulated run sends.

#include "camera_self_calibration/pipeline/back_end.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "camera_self_calibration/pipeline/back_end_report.h"
#include "camera_self_calibration/pipeline/checked_back_end.h"
#include "lens_change/change_samples.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {
namespace {

using Transition = std::pair<Phase, Phase>;

TrackRunOptions shortRun() {
  TrackRunOptions run;
  run.rate_hz = 10.0;
  run.max_features = 60;
  return run;
}

const Camera& lens() {
  static const Camera lens = ordinaryCameras()[1];
  return lens;
}

Camera guess() { return Camera::defaultGuess(lens().model(), lens().width(), lens().height()); }

/// A back end that receives what that of a run does, and the rules that hold whatever happens.
class Watched {
 public:
  explicit Watched(const Options& options, const TrackRunOptions& run_options = shortRun())
      : run(lens(), options, run_options), back_end(options, guess()) {
    run.record.on_keyframe = [this](const KeyframeMessage& message) {
      const Phase before = back_end.state().phase;
      const std::uint64_t revision = back_end.state().counters.revision;
      const std::size_t events = outputs.empty() ? 0 : eventCount();
      outputs.push_back(back_end.process(message));
      expectRules(revision);
      if (before != back_end.state().phase) transitions.insert({before, back_end.state().phase});
      if (isStarting(before) && back_end.state().phase == Phase::kHandedOver) {
        EXPECT_GT(eventCount(), events) << "hand-over is an event";
      }
    };
  }

  bool runUntil(Phase phase, int frames) {
    for (int i = 0; i < frames && back_end.state().phase != phase; ++i) run.step();
    return back_end.state().phase == phase;
  }
  std::size_t eventCount() const {
    std::size_t count = 0;
    for (const BackEndOutput& output : outputs) count += output.events.size();
    return count;
  }
  const CalibrationReport& report() const { return outputs.back().report; }

  TrackRun run;
  BackEnd back_end;
  std::vector<BackEndOutput> outputs;
  std::set<Transition> transitions;

 private:
  void expectRules(std::uint64_t revision) const {
    const BackEndOutput& output = outputs.back();
    const Phase phase = back_end.state().phase;
    EXPECT_EQ(output.report.handed_over, !isStarting(phase)) << toString(phase);
    EXPECT_EQ(output.report.revision, revision + (output.update ? 1 : 0));
    EXPECT_EQ(output.report.queue.segments.size(), back_end.state().queue.candidates().size());
    EXPECT_TRUE(segmentsAreDisjoint(output.report.queue));
    for (const Event& event : output.events) EXPECT_EQ(event.epoch, output.report.epoch);
    EXPECT_EQ(learntStateOf(back_end.state()) != nullptr, !isStarting(phase));
    if (!output.update) return;
    EXPECT_EQ(output.update->generation, output.report.revision);
    EXPECT_EQ(output.update->camera.parameters(), output.report.camera.parameters());
    EXPECT_EQ(output.update->handed_over, phase == Phase::kHandedOver);
    EXPECT_EQ(output.update->solution.has_value(), !queueLeads(phase)) << toString(phase);
  }
};

TEST(BackEnd, LearnsFromNothingToHandover) {
  Watched watched(optionsFor(lens().model()));
  EXPECT_EQ(watched.back_end.state().phase, Phase::kNothingKnown);
  ASSERT_TRUE(watched.runUntil(Phase::kHandedOver, 300));
  EXPECT_TRUE(watched.transitions.count({Phase::kNothingKnown, Phase::kStartupLeads}));
  EXPECT_EQ(watched.outputs.front().report.queue.last_decision,
            "not considered: all keyframes together do not determine the lens yet");
  EXPECT_LT(pixelDistance(lens(), watched.back_end.state().known.camera).rms, 2.0);
  // Nothing but a change of the lens leads out of it.
  watched.run.run(60);
  EXPECT_EQ(watched.back_end.state().phase, Phase::kHandedOver);
  // The same input, the same output as that of the run's own.
  const CalibrationReport own = watched.run.report();
  EXPECT_EQ(own.camera.parameters(), watched.report().camera.parameters());
  EXPECT_EQ(own.revision, watched.report().revision);
  EXPECT_EQ(own.sentence, watched.report().sentence);
}

TEST(BackEnd, StaysWhereNothingIsKnownWhileMotionDoesNotInform) {
  TrackRunOptions run = shortRun();
  run.motion = MotionKind::kForwardOnly;
  Watched watched(optionsFor(lens().model()), run);
  watched.run.run(120);
  ASSERT_GT(watched.outputs.size(), 12u);
  EXPECT_EQ(watched.back_end.state().phase, Phase::kNothingKnown);
  EXPECT_TRUE(watched.transitions.empty());
  EXPECT_TRUE(watched.back_end.state().queue.candidates().empty());
  for (const BackEndOutput& output : watched.outputs) EXPECT_FALSE(output.update);
}

// Where hand-over never comes, the better of batch and queue leads. A new map ends the batch, not
// the queue.
TEST(BackEnd, BeforeHandoverTheBetterLeads) {
  Options options = optionsFor(lens().model());
  options.converged_pixel_rms = 1e-4;
  Watched watched(options);
  ASSERT_TRUE(watched.runUntil(Phase::kStartupLeads, 100));
  watched.run.run(80);
  watched.run.calibrator().resetTracking();
  ASSERT_TRUE(watched.runUntil(Phase::kQueueLeads, 100));
  watched.run.run(60);
  EXPECT_TRUE(isStarting(watched.back_end.state().phase));
  EXPECT_NE(watched.report().sentence.find("(needed: "), std::string::npos)
      << watched.report().sentence;
  EXPECT_EQ(watched.report().state, CalibrationState::kInitializing);
  EXPECT_LT(pixelDistance(lens(), watched.back_end.state().known.camera).rms, 2.0);
}

TEST(BackEnd, AnotherLensBeginsAnEpochAndOneThatReturnsIsRecognised) {
  constexpr double kChangeS = 20.0, kReturnS = 28.0;
  TrackRunOptions run = shortRun();
  run.lens = [](double t) { return t < kChangeS || t > kReturnS ? lens() : zoomed(lens(), 1.15); };
  Options options = optionsFor(lens().model());
  options.converged_pixel_rms = 3.0;  // so that the batch soon tells which setting it is
  Watched watched(options, run);
  ASSERT_TRUE(watched.runUntil(Phase::kHandedOver, 200));
  while (watched.back_end.state().phase == Phase::kHandedOver &&
         watched.run.record.frames.size() < 260) {
    watched.run.step();
  }
  ASSERT_TRUE(isStarting(watched.back_end.state().phase));
  EXPECT_EQ(watched.back_end.state().counters.epoch, 1u);
  EXPECT_TRUE(watched.transitions.count({Phase::kHandedOver, Phase::kStartupLeads}));
  const BackEndOutput& change = watched.outputs.back();
  ASSERT_FALSE(change.events.empty());
  EXPECT_EQ(change.events.front().type, EventType::kCalibrationChange);
  for (const Event& event : change.events) {
    EXPECT_NE(event.type, EventType::kNoLongerConverged) << "the change says it";
  }
  EXPECT_EQ(change.report.last_change, change.events.front().sentence);
  EXPECT_NE(change.report.state, CalibrationState::kConverged);
  ASSERT_TRUE(change.update) << "the front end needs it at once";
  EXPECT_EQ(change.update->onset_ns, change.events.front().onset_stamp_ns);
  EXPECT_EQ(watched.back_end.state().keyframesOfLens(), 0) << "all seen so far are of the old lens";
  EXPECT_GT(change.report.keyframes, 0);
  EXPECT_GT(change.update->camera.parameters()(0), 1.05 * lens().parameters()(0));
  for (const Candidate& candidate : watched.back_end.state().queue.candidates()) {
    EXPECT_GE(candidate.segment.beginNs(), change.update->onset_ns) << "of the old lens";
  }
  ASSERT_TRUE(watched.runUntil(Phase::kHandedOver, 100));
  watched.run.run(200);
  EXPECT_EQ(watched.back_end.state().counters.epoch, 2u);
  EXPECT_EQ(watched.back_end.state().phase, Phase::kHandedOver);
  EXPECT_LT(pixelDistance(lens(), watched.back_end.state().known.camera).rms, 1.0);
  bool recognised = false;
  for (const BackEndOutput& output : watched.outputs) {
    for (const Event& event : output.events) {
      recognised |= event.sentence.find("known from epoch 0") != std::string::npos;
    }
  }
  EXPECT_TRUE(recognised);
}

TEST(BackEnd, HeldIntrinsicsStayAsGiven) {
  Options options = optionsFor(lens().model());
  options.initial_camera = lens();
  options.fix_intrinsics = true;
  TrackRun run(lens(), options, shortRun());
  BackEnd back_end(options, lens());
  int keyframes = 0;
  run.record.on_keyframe = [&](const KeyframeMessage& message) {
    const BackEndOutput output = back_end.process(message);
    EXPECT_FALSE(output.update);
    EXPECT_EQ(output.report.state, CalibrationState::kConverged);
    EXPECT_EQ(output.report.uncertainty.rms, 0.0);
    EXPECT_EQ(output.report.keyframes, message.keyframes);
    ++keyframes;
  };
  run.run(60);
  EXPECT_GT(keyframes, 3);
  EXPECT_EQ(back_end.state().phase, Phase::kHeld);
  EXPECT_EQ(back_end.state().known.camera.parameters(), lens().parameters());
  EXPECT_FALSE(learntStateOf(back_end.state()));
}

/// What a run learnt, and the keyframes that followed.
struct Learnt {
  std::shared_ptr<const LearntState> state;
  std::vector<KeyframeMessage> later;
};

const Learnt& learnt() {
  static const Learnt learnt = [] {
    TrackRun run(lens(), optionsFor(lens().model()), shortRun());
    EXPECT_TRUE(run.runUntilConverged(400));
    run.run(50);
    Learnt result;
    result.state = run.calibrator().state();
    EXPECT_TRUE(result.state);
    run.record.on_keyframe = [&](const KeyframeMessage& message) {
      result.later.push_back(message);
    };
    run.run(40);
    return result;
  }();
  return learnt;
}

TEST(BackEnd, ARestoredQueueIsHeldUntilItIsConfirmed) {
  ASSERT_TRUE(learnt().state);
  BackEnd back_end(optionsFor(lens().model()), guess());
  ASSERT_TRUE(back_end.restore(*learnt().state));
  EXPECT_EQ(back_end.state().phase, Phase::kRestored);
  EXPECT_EQ(back_end.state().queue.candidates().size(), learnt().state->segments.size());
  EXPECT_EQ(back_end.state().counters.revision, learnt().state->revision);
  const Camera restored = back_end.state().known.camera;
  EXPECT_LT(pixelDistance(restored, learnt().state->camera).rms, 0.02);
  const BackEndOutput first = back_end.hold(learnt().later[0], "; a remark");
  EXPECT_EQ(first.report.state, CalibrationState::kConverged);
  EXPECT_TRUE(first.report.handed_over);
  EXPECT_NE(first.report.sentence.find("; a remark"), std::string::npos);
  ASSERT_EQ(first.events.size(), 1u);
  EXPECT_EQ(first.events[0].type, EventType::kConverged);
  ASSERT_TRUE(first.update);
  EXPECT_FALSE(first.update->handed_over) << "the front end still sends the whole history";
  EXPECT_FALSE(first.update->solution);
  const BackEndOutput second = back_end.hold(learnt().later[1], "");
  EXPECT_TRUE(second.events.empty());
  EXPECT_FALSE(second.update);
  EXPECT_EQ(back_end.state().known.camera.parameters(), restored.parameters())
      << "nothing is learnt";
  const BackEndOutput confirmed = back_end.confirm({});
  EXPECT_EQ(back_end.state().phase, Phase::kHandedOver);
  ASSERT_TRUE(confirmed.update);
  EXPECT_TRUE(confirmed.update->handed_over);
  EXPECT_EQ(back_end.state().known.camera.parameters(), restored.parameters());
}

/// A queue that was CONVERGED when it was saved, of three segments of the lens, and what is said
/// when two of another lens come between them.
class Contradicted {
 public:
  explicit Contradicted(double limit_px) : back_end_(optionsWith(limit_px), lens()) {
    LearntState state;
    state.camera = lens();
    state.state = CalibrationState::kConverged;
    for (const int seed : {0, 2, 4}) {
      state.segments.push_back(candidateOf(lens(), perturbedCamera(lens(), seed), seed));
    }
    seen_.keyframes = 40;
    seen_.candidate = state.segments.back().segment;
    state.stamp_ns = seen_.candidate.endNs();
    EXPECT_TRUE(back_end_.restore(state));
    before = back_end_.hold(seen_, "");
    std::vector<Candidate> others;
    for (const int seed : {1, 3}) {
      others.push_back(candidateOf(zoomed(lens(), 1.03), perturbedCamera(lens(), seed), seed));
    }
    contradicted = back_end_.confirm(others);
    EXPECT_EQ(back_end_.state().queue.candidates().size(), 5u);
    after = back_end_.hold(seen_, "");
  }

  BackEndOutput before, contradicted, after;

 private:
  static Options optionsWith(double limit_px) {
    Options options = optionsFor(lens().model());
    options.estimate_readout = false;
    options.converged_pixel_rms = limit_px;
    return options;
  }

  BackEnd back_end_;
  KeyframeMessage seen_;
};

// CONVERGED is left at one and a half limits: the limit is put so that this lies between.
TEST(BackEnd, ItIsAnEventThatConvergedIsLeft) {
  const Contradicted measured(1.0);
  const double good = measured.before.report.uncertainty.rms;
  const double bad = measured.contradicted.report.uncertainty.rms;
  ASSERT_TRUE(std::isfinite(bad));
  ASSERT_GT(bad, 1.1 * good);
  const double limit_px = std::sqrt(good * bad) / 1.5;
  const Contradicted told(limit_px);
  EXPECT_EQ(told.before.report.state, CalibrationState::kConverged) << told.before.report.sentence;
  ASSERT_EQ(told.before.events.size(), 1u);
  EXPECT_EQ(told.before.events[0].type, EventType::kConverged);
  const CalibrationReport& worse = told.contradicted.report;
  EXPECT_EQ(worse.state, CalibrationState::kConverging);
  EXPECT_FALSE(worse.isGoodNow());
  ASSERT_EQ(told.contradicted.events.size(), 1u);
  const Event& event = told.contradicted.events[0];
  EXPECT_EQ(event.type, EventType::kNoLongerConverged);
  EXPECT_EQ(event.epoch, 0u);
  EXPECT_FALSE(event.sentence.empty());
  EXPECT_EQ(worse.sentence.find(event.sentence), 0u) << "why: " << event.sentence;
  EXPECT_TRUE(told.after.events.empty()) << "said once";
}

// Here the limit is put so that the hysteresis keeps CONVERGED.
TEST(BackEnd, SaysWhereConvergedIsOnlyKept) {
  const Contradicted measured(1.0);
  const double good = measured.before.report.uncertainty.rms;
  const double bad = measured.contradicted.report.uncertainty.rms;
  const double limit_px = std::max(std::sqrt(good * bad), bad / 1.4);
  ASSERT_LT(limit_px, bad);
  const Contradicted told(limit_px);
  EXPECT_TRUE(told.before.report.isGoodNow());
  const CalibrationReport& kept = told.contradicted.report;
  EXPECT_EQ(kept.state, CalibrationState::kConverged);
  EXPECT_FALSE(kept.isGoodNow());
  ASSERT_TRUE(kept.afresh);
  EXPECT_EQ(kept.afresh->state, CalibrationState::kConverging);
  EXPECT_FALSE(kept.afresh->hint.empty());
  EXPECT_TRUE(told.contradicted.events.empty());
}

TEST(BackEnd, WhatCannotBeRestoredChangesNothing) {
  ASSERT_TRUE(learnt().state);
  const auto refuses = [](BackEnd back_end, const LearntState& state) {
    const Camera before = back_end.state().known.camera;
    EXPECT_FALSE(back_end.restore(state));
    EXPECT_EQ(back_end.state().phase, Phase::kNothingKnown);
    EXPECT_EQ(back_end.state().known.camera.parameters(), before.parameters());
    EXPECT_TRUE(back_end.state().queue.candidates().empty());
    EXPECT_EQ(back_end.state().counters.revision, 0u);
  };
  const Options options = optionsFor(lens().model());
  refuses(BackEnd(options, Camera::defaultGuess(lens().model(), 320, 240)), *learnt().state);
  refuses(BackEnd(options, Camera::defaultGuess(CameraModel::kPinhole, 640, 480)), *learnt().state);
  refuses(BackEnd(options, guess()), LearntState());
}

TEST(BackEnd, CountsOnFromWhereItBegins) {
  BackEnd back_end(optionsFor(lens().model()), guess(), {7, 2});
  const BackEndOutput first = back_end.process(learnt().later[0]);
  EXPECT_EQ(first.report.revision, 8u);
  EXPECT_EQ(first.report.epoch, 2u);
  ASSERT_TRUE(first.update) << "what the front end has is no longer in use";
  EXPECT_EQ(first.update->epoch, 2u);
  EXPECT_FALSE(back_end.process(learnt().later[0]).update);
}

// What was seen before a restored start says nothing of how long this lens is being learnt.
TEST(BackEnd, CountsTheKeyframesOfTheLensFromItsOwnFirst) {
  ASSERT_GE(learnt().later.size(), 2u);
  BackEnd back_end(optionsFor(lens().model()), guess());
  KeyframeMessage message = learnt().later[0];
  message.keyframes = 5000;
  const BackEndOutput first = back_end.process(message);
  EXPECT_EQ(back_end.state().keyframesOfLens(), 1);
  EXPECT_EQ(first.report.keyframes, 5000);
  EXPECT_EQ(first.report.state, CalibrationState::kWaitingForMotion) << first.report.sentence;
  message = learnt().later[1];
  message.keyframes = 5001;
  back_end.process(message);
  EXPECT_EQ(back_end.state().keyframesOfLens(), 2);
}

TEST(CheckedBackEnd, AResetForgetsAllButTheRevision) {
  ASSERT_TRUE(learnt().state);
  Beginning known;
  known.camera = learnt().state->camera;
  known.state = learnt().state;
  CheckedBackEnd back_end(optionsFor(lens().model()), known);
  const std::uint64_t before = back_end.process(learnt().later[0], false).report.revision;
  EXPECT_GT(before, learnt().state->revision);
  EXPECT_TRUE(back_end.state());
  Beginning anew;
  anew.camera = guess();
  back_end.beginAgain(anew);
  EXPECT_FALSE(back_end.state());
  const CalibrationReport report = back_end.process(learnt().later[1], false).report;
  EXPECT_GT(report.revision, before);
  EXPECT_EQ(report.epoch, 0u);
  EXPECT_FALSE(report.handed_over);
  EXPECT_EQ(report.sentence.find("restored"), std::string::npos);
}

TEST(CheckedBackEnd, FrozenItLearnsNothing) {
  ASSERT_TRUE(learnt().state);
  Beginning known;
  known.camera = learnt().state->camera;
  known.state = learnt().state;
  CheckedBackEnd back_end(optionsFor(lens().model()), known);
  const BackEndOutput first = back_end.process(learnt().later[0], true);
  EXPECT_TRUE(first.report.frozen);
  EXPECT_NE(first.report.sentence.find("frozen"), std::string::npos);
  for (const KeyframeMessage& message : learnt().later) {
    const BackEndOutput output = back_end.process(message, true);
    EXPECT_EQ(output.report.camera.parameters(), first.report.camera.parameters());
    EXPECT_FALSE(output.update);
  }
}

// Each map is lost before its batch has grown. The queue, which the candidates of several maps
// fill, takes over all the same, and from then on the batch stays as short as it is.
TEST(CheckedBackEnd, ABatchThatStaysShortConfirmsTheRestored) {
  ASSERT_TRUE(learnt().state);
  TrackRunOptions another = shortRun();
  another.seed = 11;
  TrackRun run(lens(), optionsFor(lens().model()), another);
  run.calibrator().restore(learnt().state);
  run.seek(600);  // after what was learnt
  std::size_t in_map = 0, most = 0;
  run.record.on_keyframe = [&](const KeyframeMessage& message) {
    in_map = message.candidate.keyframes.size();
    most = std::max({most, in_map, message.history.keyframes.size()});
  };
  for (int i = 0; i < 200 && run.record.count(EventType::kHandover) == 0; ++i) {
    if (in_map == 7) run.calibrator().resetTracking();
    run.step();
  }
  EXPECT_LT(most, static_cast<std::size_t>(RecheckOptions().min_keyframes));
  ASSERT_EQ(run.record.count(EventType::kHandover), 1) << run.report().sentence;
  EXPECT_NE(run.record.events.back().sentence.find("is confirmed"), std::string::npos)
      << run.record.events.back().sentence;
  EXPECT_EQ(run.report().sentence.find("being checked"), std::string::npos);
}

}  // namespace
}  // namespace camera_self_calibration
