#include "camera_self_calibration/pipeline/health.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera/sample_cameras.h"

namespace camera_self_calibration {
namespace {

const Camera kCamera = camera640(CameraModel::kFov, {320, 320, 319.5, 239.5, 1.0});

HealthEvidence evidence(int keyframes, bool handed_over, double rms) {
  HealthEvidence result;
  result.keyframes = keyframes;
  result.has_estimate = keyframes >= 4;
  result.handed_over = handed_over;
  result.information = IntrinsicsMatrix::Identity(5, 5);
  result.uncertainty = {rms, 2.0 * rms};
  result.threshold_px = 1.0;
  return result;
}

// fx and fy seen only as their difference.
IntrinsicsMatrix focalUnobserved() {
  IntrinsicsMatrix information = IntrinsicsMatrix::Identity(5, 5);
  information(0, 1) = information(1, 0) = -1.0 + 1e-12;
  return information;
}

TEST(Health, WaitsForMotion) {
  for (const int keyframes : {0, 1}) {
    const HealthVerdict verdict =
        judgeHealth(evidence(keyframes, false, INFINITY), kCamera, CalibrationState::kInitializing);
    EXPECT_EQ(verdict.state, CalibrationState::kWaitingForMotion);
    EXPECT_FALSE(verdict.sentence.empty());
    EXPECT_NE(verdict.hint.find("move"), std::string::npos);
  }
}

TEST(Health, InitializesUntilHandover) {
  HealthEvidence early = evidence(3, false, INFINITY);
  EXPECT_EQ(judgeHealth(early, kCamera, CalibrationState::kInitializing).state,
            CalibrationState::kInitializing);
  HealthEvidence good = evidence(20, false, 0.3);  // good, but not confirmed by the queue
  good.obstacle = "the segments disagree";
  const HealthVerdict verdict = judgeHealth(good, kCamera, CalibrationState::kInitializing);
  EXPECT_EQ(verdict.state, CalibrationState::kInitializing);
  EXPECT_NE(verdict.sentence.find("0.30 px"), std::string::npos) << verdict.sentence;
  EXPECT_NE(verdict.sentence.find("the segments disagree"), std::string::npos);
  EXPECT_FALSE(verdict.hint.empty());
}

// They say enough; that they contradict each other is no matter of axes.
TEST(Health, WhereSegmentsDisagreeNoTurnIsAskedFor) {
  HealthEvidence disagreeing = evidence(20, false, 0.3);
  disagreeing.obstacle = "the segments disagree";
  const auto hint = [&] {
    return judgeHealth(disagreeing, kCamera, CalibrationState::kInitializing).hint;
  };
  const std::string before = hint();
  disagreeing.segments_disagree = true;
  EXPECT_NE(hint(), before);
  EXPECT_NE(hint().find("slowly"), std::string::npos) << hint();
  EXPECT_EQ(hint().find("auto"), std::string::npos) << hint();
  disagreeing.model_was_given = true;
  EXPECT_NE(hint().find("use auto"), std::string::npos) << hint();
}

// As good as it looks, but a single stretch of the video says so: an error of it would not show.
TEST(Health, AnEstimateThatNothingChecksIsNotConverged) {
  HealthEvidence alone = evidence(20, true, 0.8);
  for (const double blind : {30.0, static_cast<double>(INFINITY)}) {
    alone.blind_below_px = blind;
    const HealthVerdict verdict = judgeHealth(alone, kCamera, CalibrationState::kInitializing);
    EXPECT_EQ(verdict.state, CalibrationState::kConverging);
    EXPECT_NE(verdict.sentence.find("only one part of the video supports it"), std::string::npos);
    EXPECT_FALSE(verdict.hint.empty());
  }
  alone.blind_below_px = 1.6;  // of halves that are as good as each other
  EXPECT_EQ(judgeHealth(alone, kCamera, CalibrationState::kInitializing).state,
            CalibrationState::kConverged);
  // No flicker.
  alone.blind_below_px = 5.0;
  EXPECT_EQ(judgeHealth(alone, kCamera, CalibrationState::kConverged).state,
            CalibrationState::kConverged);
  EXPECT_EQ(judgeHealth(alone, kCamera, CalibrationState::kInitializing).state,
            CalibrationState::kConverging);
}

TEST(Health, ConvergesBelowTheThreshold) {
  EXPECT_EQ(judgeHealth(evidence(20, true, 1.2), kCamera, CalibrationState::kInitializing).state,
            CalibrationState::kConverging);
  const HealthVerdict verdict =
      judgeHealth(evidence(20, true, 1.0), kCamera, CalibrationState::kInitializing);
  EXPECT_EQ(verdict.state, CalibrationState::kConverged);
  EXPECT_TRUE(verdict.hint.empty());
  EXPECT_NE(verdict.sentence.find("1.00 px"), std::string::npos) << verdict.sentence;
}

TEST(Health, LeavesConvergedWhenItIsClearlyNoLongerGood) {
  const HealthVerdict kept =
      judgeHealth(evidence(20, true, 1.4), kCamera, CalibrationState::kConverged);
  EXPECT_EQ(kept.state, CalibrationState::kConverged);
  EXPECT_NE(kept.sentence.find("above 1.50 px"), std::string::npos) << kept.sentence;
  EXPECT_EQ(judgeHealth(evidence(20, true, 1.4), kCamera, CalibrationState::kInitializing).state,
            CalibrationState::kConverging);
  const HealthVerdict worse =
      judgeHealth(evidence(20, true, 1.6), kCamera, CalibrationState::kConverged);
  EXPECT_EQ(worse.state, CalibrationState::kConverging);
  EXPECT_NE(worse.sentence.find("1.60 px"), std::string::npos) << worse.sentence;
  EXPECT_FALSE(worse.hint.empty());
}

TEST(Health, IsNotConvergedUnderAModelThatDoesNotFit) {
  HealthEvidence misfit = evidence(20, true, 1.6);
  misfit.model_misses = true;
  misfit.better_model = "radtan";
  for (const CalibrationState before :
       {CalibrationState::kInitializing, CalibrationState::kConverged}) {
    const HealthVerdict verdict = judgeHealth(misfit, kCamera, before);
    EXPECT_EQ(verdict.state, CalibrationState::kConverging);
    EXPECT_NE(verdict.sentence.find("does not fit the lens"), std::string::npos);
    EXPECT_NE(verdict.hint.find("radtan"), std::string::npos) << verdict.hint;
  }
  misfit.better_model = "radtan with k3";
  EXPECT_NE(judgeHealth(misfit, kCamera, CalibrationState::kInitializing).hint.find("auto"),
            std::string::npos);
  misfit.uncertainty = {0.9, 1.8};  // the misfit matters no more than the limit allows
  EXPECT_EQ(judgeHealth(misfit, kCamera, CalibrationState::kInitializing).state,
            CalibrationState::kConverged);
}

TEST(Health, SaysThatNoModelFitsTheLens) {
  HealthEvidence misfit = evidence(20, true, 1.6);
  misfit.model_misses = true;
  const HealthVerdict verdict = judgeHealth(misfit, kCamera, CalibrationState::kInitializing);
  EXPECT_EQ(verdict.state, CalibrationState::kConverging);
  EXPECT_NE(verdict.sentence.find("no lens model was found to fit"), std::string::npos);
  EXPECT_NE(verdict.hint.find("converged_pixel_rms"), std::string::npos) << verdict.hint;
}

TEST(Health, NamesWhatMotionDoesNotTell) {
  HealthEvidence weak = evidence(15, false, 5.0);
  weak.information = focalUnobserved();
  HealthVerdict verdict = judgeHealth(weak, kCamera, CalibrationState::kInitializing);
  EXPECT_EQ(verdict.state, CalibrationState::kDegenerate);
  EXPECT_NE(verdict.sentence.find("fx, fy"), std::string::npos) << verdict.sentence;
  EXPECT_FALSE(verdict.hint.empty());
  // Early on there is nothing to judge yet.
  weak.keyframes = 6;
  EXPECT_EQ(judgeHealth(weak, kCamera, CalibrationState::kInitializing).state,
            CalibrationState::kInitializing);
  // Observable in numbers only: errors of a large part of the image.
  HealthEvidence useless = evidence(15, false, 0.2 * 640);
  EXPECT_EQ(judgeHealth(useless, kCamera, CalibrationState::kInitializing).state,
            CalibrationState::kDegenerate);
  useless.uncertainty = {INFINITY, INFINITY};
  EXPECT_EQ(judgeHealth(useless, kCamera, CalibrationState::kInitializing).state,
            CalibrationState::kDegenerate);
}

TEST(Health, KeepsDegenerateAtItsLimit) {
  const auto at = [](double share, CalibrationState before) {
    return judgeHealth(evidence(15, false, share * 640), kCamera, before).state;
  };
  EXPECT_EQ(at(0.016, CalibrationState::kInitializing), CalibrationState::kInitializing);
  EXPECT_EQ(at(0.016, CalibrationState::kDegenerate), CalibrationState::kDegenerate);
  EXPECT_EQ(at(0.012, CalibrationState::kDegenerate), CalibrationState::kInitializing);
}

// What helps then is that tracking lasts.
TEST(Health, AsksForNoMotionWhereTrackingIsLostAgainAndAgain) {
  HealthEvidence lost = evidence(60, false, 0.2 * 640);
  lost.needed_keyframes = 20;
  const auto blamesTracking = [&](int maps, int longest) {
    lost.maps = maps;
    lost.longest_map = longest;
    const std::string hint = judgeHealth(lost, kCamera, CalibrationState::kInitializing).hint;
    return hint.find("tracking never lasts for more than 19 keyframes, of which 20 are needed") !=
           std::string::npos;
  };
  EXPECT_TRUE(blamesTracking(3, 19));
  EXPECT_FALSE(blamesTracking(2, 19));
  EXPECT_FALSE(blamesTracking(3, 20));
  lost.uncertainty = {3.0, 6.0};
  EXPECT_TRUE(blamesTracking(3, 19));
}

// Where no motion can help, none is asked for.
TEST(Health, BlamesAWrongModelRatherThanTheMotion) {
  HealthEvidence wrong = evidence(15, false, 0.2 * 640);
  wrong.model_was_given = true;
  const HealthVerdict unknown = judgeHealth(wrong, kCamera, CalibrationState::kInitializing);
  EXPECT_EQ(unknown.state, CalibrationState::kDegenerate);
  EXPECT_NE(unknown.hint.find("auto"), std::string::npos) << unknown.hint;
  wrong.model_misses = true;
  wrong.better_model = "equidistant";
  const HealthVerdict verdict = judgeHealth(wrong, kCamera, CalibrationState::kDegenerate);
  EXPECT_EQ(verdict.state, CalibrationState::kInitializing);
  EXPECT_NE(verdict.sentence.find("does not fit the lens"), std::string::npos) << verdict.sentence;
  EXPECT_EQ(verdict.sentence.find("motion"), std::string::npos) << verdict.sentence;
  EXPECT_EQ(verdict.hint, "use the lens model equidistant, or auto, which finds one");
}

// Not only once it has given up: every verdict before CONVERGED says what is missing.
TEST(Health, NamesTheLeastKnownWhileLearning) {
  for (const bool handed_over : {false, true}) {
    HealthEvidence learning = evidence(8, handed_over, 5.0);
    learning.information = focalUnobserved();
    const HealthVerdict verdict = judgeHealth(learning, kCamera, CalibrationState::kInitializing);
    EXPECT_NE(verdict.sentence.find("least known: the focal length"), std::string::npos)
        << verdict.sentence;
    EXPECT_NE(verdict.hint.find("several axes"), std::string::npos) << verdict.hint;
  }
}

TEST(Health, NamesOfStates) {
  EXPECT_EQ(toString(CalibrationState::kWaitingForMotion), "WAITING_FOR_MOTION");
  EXPECT_EQ(toString(CalibrationState::kInitializing), "INITIALIZING");
  EXPECT_EQ(toString(CalibrationState::kConverging), "CONVERGING");
  EXPECT_EQ(toString(CalibrationState::kConverged), "CONVERGED");
  EXPECT_EQ(toString(CalibrationState::kDegenerate), "DEGENERATE");
}

}  // namespace
}  // namespace camera_self_calibration
