#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <iostream>

#include "camera_self_calibration/tracking/image_motion.h"
#include "estimation/sample_segments.h"
#include "pipeline/track_run.h"
#include "sanitized.h"

namespace camera_self_calibration {
namespace {

double worstSigmas(const CalibrationReport& report, const Camera& truth) {
  double worst = 0.0;
  for (int i = 0; i < truth.estimatedCount(); ++i) {
    const double error = report.camera.parameters()(i) - truth.parameters()(i);
    worst = std::max(worst, std::abs(error) / std::sqrt(report.covariance(i, i)));
  }
  return worst;
}

TEST(Convergence, FromTheDefaultGuessForEachModel) {
  for (const Camera& truth : ordinaryCameras()) {
    for (std::uint64_t seed = 1; seed <= (kSanitized ? 1 : 3); ++seed) {
      TrackRunOptions run;
      run.seed = seed;
      TrackRun calibration(truth, optionsFor(truth.model()), run);
      const bool converged = calibration.runUntilConverged(600);
      const CalibrationReport report = calibration.report();
      ASSERT_TRUE(converged) << toString(truth.model()) << " seed " << seed << ": "
                             << report.sentence;
      const double at_convergence = worstSigmas(report, truth);
      calibration.run(100);
      const CalibrationReport later = calibration.report();
      const double distance = pixelDistance(truth, later.camera).rms;
      std::cout << toString(truth.model()) << " seed " << seed << ": converged at keyframe "
                << report.keyframes << ", worst error " << at_convergence << " sigma, later "
                << worstSigmas(later, truth) << " sigma, " << distance << " px of "
                << later.uncertainty.rms << " expected\n";
      EXPECT_LT(at_convergence, 3.5);
      EXPECT_LT(worstSigmas(later, truth), 3.5);
      EXPECT_LT(distance, 1.0);
      EXPECT_EQ(later.state, CalibrationState::kConverged);
      EXPECT_EQ(calibration.record.count(EventType::kHandover), 1);
      EXPECT_EQ(calibration.record.count(EventType::kConverged), 1);
      EXPECT_EQ(calibration.record.count(EventType::kLost), 0);
    }
  }
}

// Windows of slow motion overlap, and there are no two separate ones for long.
TEST(Convergence, ShortOrSlowVideoConvergesWithTheHalvesOfTheBatch) {
  const Camera truth = ordinaryCameras()[1];
  TrackRunOptions stand;
  stand.motion = MotionKind::kRotationOnly;
  stand.motion_speed = 0.3;
  TrackRun turning(truth, optionsFor(truth.model()), stand);
  const bool converged = turning.runUntilConverged(600);
  std::cout << "rotation: keyframe " << turning.report().keyframes << ", frame "
            << turning.record.frames.size() << "\n";
  ASSERT_TRUE(converged) << turning.report().sentence;
  EXPECT_LT(worstSigmas(turning.report(), truth), 4.0);
  EXPECT_LT(pixelDistance(truth, turning.report().camera).rms, 1.0);
}

TEST(Convergence, WithOutliers) {
  const Camera truth = ordinaryCameras()[1];
  TrackRunOptions run;
  run.outlier_share = 0.03;
  TrackRun calibration(truth, optionsFor(truth.model()), run);
  ASSERT_TRUE(calibration.runUntilConverged(600)) << calibration.report().sentence;
  EXPECT_LT(worstSigmas(calibration.report(), truth), 3.5);
}

// As rectified images often keep some distortion.
TEST(Convergence, NotUnderAModelThatMissesTheLens) {
  const Camera truth = camera640(CameraModel::kRadtan, {420, 415, 325, 236, -0.03, 0.01, 0, 0});
  TrackRun calibration(truth, optionsFor(CameraModel::kPinhole), TrackRunOptions());
  calibration.run(400);
  const CalibrationReport report = calibration.report();
  ASSERT_TRUE(report.handed_over) << report.sentence;
  EXPECT_EQ(report.state, CalibrationState::kConverging) << report.sentence;
  EXPECT_FALSE(report.lens_fit.better.empty());
  EXPECT_NE(report.sentence.find(report.lens_fit.sentence()), std::string::npos);
  // No parameter asks for k3: auto finds it.
  const bool settable = cameraModelFromString(report.lens_fit.better).has_value();
  EXPECT_NE(report.hint.find(settable ? report.lens_fit.better : "auto"), std::string::npos)
      << report.hint;
  EXPECT_LT(pixelDistance(report.camera, truth).rms, 3.0 * report.uncertainty.rms);
}

// Too little of it for the startup batch to demand.
TEST(Convergence, RadtanGainsK3FromTheQueue) {
  const Camera truth =
      camera640(CameraModel::kRadtan, {420, 422, 318, 243, -0.25, 0.07, 1e-3, -5e-4, -0.02});
  for (const std::uint64_t seed : {1, 2}) {
    TrackRunOptions options;
    options.seed = seed;
    TrackRun run(truth, optionsFor(truth.model()), options);
    for (int i = 0; i < 300 && !run.report().handed_over; ++i) {
      EXPECT_LE(run.report().camera.estimatedCount(), 8);
      run.step();
    }
    run.run(200);
    const CalibrationReport report = run.report();
    EXPECT_EQ(report.camera.estimatedCount(), 9);
    EXPECT_EQ(report.state, CalibrationState::kConverged) << report.sentence;
    EXPECT_LT(pixelDistance(truth, report.camera).rms, 3.0 * report.uncertainty.rms);
    EXPECT_LT(pixelDistance(truth, report.camera).rms, 0.5);
  }
}

// Before hand-over, which it never reaches: no motion would help, another model would. A batch in a
// wrong minimum cannot say so, as a pinhole often is under so wide a lens.
TEST(Convergence, SaysWhileStartingThatTheModelIsWrong) {
  const Camera truth = camera640(CameraModel::kFov, {311.2, 309.8, 327.4, 233.1, 0.93});
  int named = 0;
  for (const std::uint64_t seed : {6, 7, 8, 9, 10}) {
    TrackRunOptions options;
    options.seed = seed;
    TrackRun run(truth, optionsFor(CameraModel::kPinhole), options);
    run.run(200);
    const CalibrationReport report = run.report();
    EXPECT_FALSE(report.handed_over) << report.sentence;
    if (!report.lens_fit.refuted) continue;
    ++named;
    EXPECT_EQ(report.state, CalibrationState::kInitializing);
    EXPECT_NE(report.sentence.find("the lens model does not fit the lens"), std::string::npos)
        << report.sentence;
    EXPECT_NE(report.hint.find("auto"), std::string::npos) << report.hint;
  }
  EXPECT_GE(named, 2);
}

TEST(Convergence, AMapLostBeforeHandOverTakesNothingWithIt) {
  const Camera truth = ordinaryCameras()[1];
  Options options = optionsFor(truth.model());
  options.converged_pixel_rms = 1e-3;  // never reached: it stays before hand-over
  TrackRun calibration(truth, options, TrackRunOptions());
  calibration.run(250);
  const CalibrationReport before = calibration.report();
  ASSERT_FALSE(before.handed_over);
  ASSERT_LT(before.uncertainty.rms, 1.0);
  calibration.runBlind(20);
  calibration.record.reports.clear();
  calibration.run(60);
  ASSERT_EQ(calibration.record.count(EventType::kLost), 1);
  ASSERT_GT(calibration.record.reports.size(), 8u);
  for (const CalibrationReport& report : calibration.record.reports) {
    EXPECT_EQ(report.state, CalibrationState::kInitializing) << report.sentence;
    EXPECT_LT(report.uncertainty.rms, 3.0 * before.uncertainty.rms) << report.sentence;
    EXPECT_LT(pixelDistance(truth, report.camera).rms, 1.0);
  }
}

TEST(Convergence, GivenIntrinsicsAreHeldIfAskedFor) {
  const Camera truth = ordinaryCameras()[1];
  Options options = optionsFor(truth.model());
  options.initial_camera = truth;
  options.fix_intrinsics = true;
  TrackRun held(truth, options, TrackRunOptions());
  held.run(150);
  EXPECT_TRUE(held.report().camera.parameters() == truth.parameters());
  EXPECT_EQ(held.report().state, CalibrationState::kConverged);
  EXPECT_EQ(held.report().uncertainty.rms, 0.0);
  EXPECT_TRUE(held.record.events.empty());
  std::size_t tracked = 0;
  for (const FrameResult& frame : held.record.frames) {
    tracked += frame.state == TrackingState::kTracking;
  }
  EXPECT_GE(tracked, 148u);
}

TEST(Convergence, PosesFollowTheTruth) {
  const Camera truth = ordinaryCameras()[1];
  TrackRun calibration(truth, optionsFor(truth.model()), TrackRunOptions());
  ASSERT_TRUE(calibration.runUntilConverged(600));
  const std::size_t first = calibration.record.frames.size();
  calibration.run(40);
  const auto& frames = calibration.record.frames;
  const auto truthOf = [&](const FrameResult& f) {
    return calibration.tracks().worldFromCamera(f.stamp_ns);
  };
  // Up to the scale, relative to the frame in which it converged.
  double dot = 0.0, square = 0.0;
  std::vector<Eigen::Vector3d> found, right;
  for (std::size_t i = first; i < frames.size(); ++i) {
    ASSERT_EQ(frames[i].state, TrackingState::kTracking);
    const auto relative = [&](const Rigid3& a, const Rigid3& b) { return a.inverse() * b; };
    const Rigid3 estimate = relative(frames[first].world_from_camera, frames[i].world_from_camera);
    const Rigid3 exact = relative(truthOf(frames[first]), truthOf(frames[i]));
    EXPECT_LT(estimate.rotation.angularDistance(exact.rotation), 0.01);
    found.push_back(estimate.translation);
    right.push_back(exact.translation);
    dot += exact.translation.dot(estimate.translation);
    square += estimate.translation.squaredNorm();
    EXPECT_GT(frames[i].pose_covariance.diagonal().minCoeff(), 0.0);
  }
  double worst = 0.0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    worst = std::max(worst, (dot / square * found[i] - right[i]).norm());
  }
  EXPECT_LT(worst, 0.03) << "metres";
}

TEST(Convergence, IsTheSameForAnyNumberOfThreads) {
  const Camera truth = ordinaryCameras()[1];
  std::vector<Record> records;
  for (const int threads : {1, 3}) {
    Options options = optionsFor(truth.model());
    options.solver_threads = threads;
    TrackRun calibration(truth, options, TrackRunOptions());
    calibration.run(250);
    records.push_back(calibration.record);
  }
  ASSERT_EQ(records[0].frames.size(), records[1].frames.size());
  ASSERT_EQ(records[0].reports.size(), records[1].reports.size());
  EXPECT_TRUE(records[0].reports.back().handed_over);
  for (std::size_t i = 0; i < records[0].frames.size(); ++i) {
    const Rigid3& a = records[0].frames[i].world_from_camera;
    const Rigid3& b = records[1].frames[i].world_from_camera;
    ASSERT_EQ(a.translation, b.translation) << i;
    ASSERT_EQ(a.rotation.coeffs(), b.rotation.coeffs()) << i;
  }
  for (std::size_t i = 0; i < records[0].reports.size(); ++i) {
    const CalibrationReport& a = records[0].reports[i];
    const CalibrationReport& b = records[1].reports[i];
    ASSERT_EQ(a.camera.parameters(), b.camera.parameters()) << i;
    ASSERT_EQ(a.covariance, b.covariance) << i;
    ASSERT_EQ(a.sentence, b.sentence) << i;
    ASSERT_EQ(a.queue.last_decision, b.queue.last_decision) << i;
  }
}

TEST(Convergence, ReportsAreConsistent) {
  const Camera truth = ordinaryCameras()[1];
  Options options = optionsFor(truth.model());
  options.queue_segments = 4;
  TrackRun calibration(truth, options, TrackRunOptions());
  calibration.run(300);
  std::int64_t keyframes = 0;
  std::uint64_t revision = 0;
  bool handed_over = false;
  for (const CalibrationReport& report : calibration.record.reports) {
    EXPECT_EQ(report.keyframes, ++keyframes);
    EXPECT_GE(report.revision, revision);
    revision = report.revision;
    EXPECT_TRUE(report.handed_over || !handed_over);
    handed_over = report.handed_over;
    EXPECT_FALSE(report.sentence.empty());
    EXPECT_LE(report.queue.segments.size(), 4u);
    EXPECT_TRUE(segmentsAreDisjoint(report.queue));
  }
  EXPECT_TRUE(handed_over);
  std::int64_t id = 0;
  for (const FrameResult& frame : calibration.record.frames) {
    EXPECT_EQ(frame.keyframe_id, frame.is_keyframe ? id : -1);
    id += frame.is_keyframe;
  }
  // Those of the last images are not handed on yet.
  const auto& frames = calibration.record.frames;
  for (std::size_t i = frames.size() - MotionHistory::kReach; i < frames.size(); ++i) {
    id -= frames[i].is_keyframe;
  }
  EXPECT_EQ(id, keyframes);
}

}  // namespace
}  // namespace camera_self_calibration
