#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "benchmark/trial_scene.h"
#include "estimation/sample_segments.h"
#include "pipeline/track_run.h"
#include "sanitized.h"

namespace camera_self_calibration {
namespace {

constexpr double kIdleS = kSanitized ? 8.0 : 16.0;

// Nothing to learn from at first, and then plenty.
class Late {
 public:
  Late(Idle idle, const Camera& truth, std::uint64_t seed)
      : idle_(idle), calibration_(truth, optionsFor(truth.model()), runOf(idle, seed)) {}

  void wait() {
    const int frames = static_cast<int>(kIdleS * TrackRunOptions().rate_hz);
    if (idle_ == Idle::kNoTexture) {
      calibration_.runBlind(frames);
    } else {
      calibration_.run(frames);
    }
  }
  TrackRun& calibration() { return calibration_; }

 private:
  static TrackRunOptions runOf(Idle idle, std::uint64_t seed) {
    TrackRunOptions run;
    run.seed = seed;
    run.trajectory = makeScene(Scene::kHandheld, 40.0, idle, kIdleS, 1).trajectory;
    return run;
  }

  Idle idle_;
  TrackRun calibration_;
};

TEST(Late, ConvergesWhenThereIsSomethingToLearnAtLast) {
  for (const Idle idle : {Idle::kStanding, Idle::kDriving, Idle::kNoTexture}) {
    const int c = static_cast<int>(idle);
    const Camera truth = ordinaryCameras()[c];
    Late late(idle, truth, 20 + c);
    TrackRun& calibration = late.calibration();
    late.wait();
    const std::string name = toString(idle) + ", " + toString(truth.model());
    const CalibrationReport waiting = calibration.report();
    EXPECT_FALSE(waiting.handed_over) << name;
    EXPECT_FALSE(calibration.record.everIn(CalibrationState::kConverging)) << name;
    EXPECT_FALSE(calibration.record.everIn(CalibrationState::kConverged)) << name;
    const std::string& advice =
        waiting.keyframes > 0 ? waiting.hint : calibration.record.frames.back().sentence;
    EXPECT_FALSE(advice.empty()) << name;
    ASSERT_TRUE(calibration.runUntilConverged(300))
        << name << ": " << calibration.report().sentence;
    const CalibrationReport report = calibration.report();
    EXPECT_LT(pixelDistance(truth, report.camera).rms, 4.0 * report.uncertainty.rms) << name;
    EXPECT_EQ(calibration.record.count(EventType::kLost), 0) << name;
    std::cout << name << ": waited " << waiting.keyframes << " keyframes, converged after "
              << report.keyframes - waiting.keyframes << " more\n";
  }
}

// What nothing observes stays near the first guess, instead of wandering off until tracking fails.
TEST(Late, TheLensDoesNotRunAwayMeanwhile) {
  const Camera truth = ordinaryCameras()[0];
  Late late(Idle::kDriving, truth, 5);
  late.wait();
  const CalibrationReport waiting = late.calibration().report();
  EXPECT_GE(waiting.keyframes, kSanitized ? 15 : 30);  // as many as the batch holds
  EXPECT_EQ(late.calibration().record.count(EventType::kLost), 0);
  for (const CalibrationReport& report : late.calibration().record.reports) {
    EXPECT_GT(report.camera.parameters()(0), 80.0);
    EXPECT_LT(report.camera.parameters()(0), 1600.0);
  }
}

}  // namespace
}  // namespace camera_self_calibration
