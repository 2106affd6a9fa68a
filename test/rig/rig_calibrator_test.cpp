#include "camera_self_calibration/rig/rig_calibrator.h"

#include <gtest/gtest.h>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/geometry/so3.h"
#include "rig/simulated_rig.h"

namespace camera_self_calibration {
namespace {

// The intrinsics that each camera finds for itself are a little off.
std::vector<Camera> nearly(std::vector<Camera> cameras) {
  for (Camera& camera : cameras) {
    Intrinsics p = camera.parameters();
    p.head<2>() *= 1.003;
    p(2) += 1.0;
    camera.setParameters(p);
  }
  return cameras;
}

SimulatedRigOptions stereo() {
  SimulatedRigOptions options;
  options.rig = stereoRig();
  return options;
}

SimulatedRigOptions backToBack() {
  SimulatedRigOptions options = stereo();
  options.rig.rig_from_camera[1] = Rigid3(expSo3({0.1, 2.9, 0.2}), {0.05, -0.1, -0.3});
  return options;
}

RigEstimate calibrated(const SimulatedRig& rig, const RigOptions& options = {}) {
  RigCalibrator calibrator(options, rig.truth.size(), rig.across);
  for (const RigFrame& frame : rig.frames) calibrator.add(frame);
  return calibrator.estimate(nearly(rig.truth.cameras));
}

void expectRotation(const RigEstimate& estimate, const SimulatedRig& rig, int camera,
                    double max_error) {
  const double error = angleBetween(estimate.rig.rig_from_camera[camera].rotation,
                                    rig.truth.rig_from_camera[camera].rotation);
  EXPECT_LT(error, 4.0 * estimate.places[camera].rotationSigma());
  EXPECT_LT(error, max_error);
}

void expectDirection(const RigEstimate& estimate, const SimulatedRig& rig, int camera,
                     double max_error) {
  const Eigen::Vector3d& position = estimate.rig.rig_from_camera[camera].translation;
  const double error = angleBetween(position, rig.truth.rig_from_camera[camera].translation);
  EXPECT_LT(error, 4.0 * estimate.places[camera].directionSigma(position));
  EXPECT_LT(error, max_error);
}

TEST(RigCalibrator, StereoPair) {
  const SimulatedRig rig = simulateRig(stereo());
  const RigEstimate estimate = calibrated(rig);
  ASSERT_TRUE(estimate.usable) << estimate.sentence;
  EXPECT_TRUE(estimate.converged);
  EXPECT_GT(estimate.places[1].shared_landmarks, 100);
  expectRotation(estimate, rig, 1, 0.05 * kDegree);
  expectDirection(estimate, rig, 1, 0.5 * kDegree);
  for (int c = 0; c < 2; ++c) {
    EXPECT_NEAR(estimate.rig.cameras[c].parameters()(0) / rig.truth.cameras[c].parameters()(0), 1.0,
                0.002);
  }
}

TEST(RigCalibrator, BackToBackByMotionAlone) {
  const SimulatedRig rig = simulateRig(backToBack());
  const RigEstimate estimate = calibrated(rig);
  ASSERT_TRUE(estimate.usable) << estimate.sentence;
  EXPECT_EQ(estimate.places[1].shared_landmarks, 0);
  expectRotation(estimate, rig, 1, 0.15 * kDegree);
  ASSERT_TRUE(estimate.places[1].position_known);
  expectDirection(estimate, rig, 1, 3.0 * kDegree);
}

TEST(RigCalibrator, ThreeCamerasAndABaseline) {
  SimulatedRigOptions options = stereo();
  options.rig.cameras.push_back(rigLens(380.0, 0.0));
  options.rig.rig_from_camera.emplace_back(expSo3({0.0, 1.6, 0.0}),
                                           Eigen::Vector3d(0.1, 0.0, -0.2));
  const SimulatedRig rig = simulateRig(options);
  RigOptions metric;
  metric.baseline_m = options.rig.rig_from_camera[1].translation.norm();
  const RigEstimate estimate = calibrated(rig, metric);
  ASSERT_TRUE(estimate.usable) << estimate.sentence;
  EXPECT_TRUE(estimate.metric);
  for (int c = 1; c < 3; ++c) {
    expectRotation(estimate, rig, c, 0.15 * kDegree);
    const Eigen::Vector3d error =
        estimate.rig.rig_from_camera[c].translation - options.rig.rig_from_camera[c].translation;
    EXPECT_LT(error.norm(), 0.01);
  }
  EXPECT_NEAR(estimate.rig.rig_from_camera[1].translation.norm(), *metric.baseline_m, 1e-12);
}

TEST(RigCalibrator, OutliersAreLeftOut) {
  SimulatedRigOptions options = stereo();
  options.outlier_share = 0.03;
  const SimulatedRig rig = simulateRig(options);
  const RigEstimate estimate = calibrated(rig);
  ASSERT_TRUE(estimate.usable) << estimate.sentence;
  expectRotation(estimate, rig, 1, 0.1 * kDegree);
}

TEST(RigCalibrator, HeldIntrinsicsStay) {
  const SimulatedRig rig = simulateRig(stereo());
  RigOptions options;
  options.solve.hold_intrinsics = {true, true};
  RigCalibrator calibrator(options, rig.truth.size(), rig.across);
  for (const RigFrame& frame : rig.frames) calibrator.add(frame);
  const RigEstimate estimate = calibrator.estimate(rig.truth.cameras);
  ASSERT_TRUE(estimate.usable) << estimate.sentence;
  for (int c = 0; c < 2; ++c) {
    EXPECT_EQ(estimate.rig.cameras[c].parameters(), rig.truth.cameras[c].parameters());
    EXPECT_EQ(estimate.intrinsics_covariance[c].size(), 0);
  }
  expectRotation(estimate, rig, 1, 0.03 * kDegree);
}

TEST(RigCalibrator, MotionWithoutRotationIsRefusedInWords) {
  SimulatedRigOptions options = backToBack();
  options.motion = MotionKind::kSidewaysOnly;
  const RigEstimate estimate = calibrated(simulateRig(options));
  EXPECT_FALSE(estimate.usable);
  EXPECT_NE(estimate.sentence.find("turn the rig about two axes"), std::string::npos)
      << estimate.sentence;
}

// What turns on the spot alone says of a camera that shares no view: nothing of where it sits.
TEST(RigCalibrator, RotationOnTheSpotDoesNotTellThePosition) {
  SimulatedRigOptions options = backToBack();
  options.motion = MotionKind::kRotationOnly;
  options.rig.rig_from_camera[1].translation.setZero();
  options.frames = 25;
  const SimulatedRig rig = simulateRig(options);
  const RigEstimate estimate = calibrated(rig);
  ASSERT_TRUE(estimate.usable) << estimate.sentence;
  EXPECT_FALSE(estimate.converged);
  EXPECT_FALSE(estimate.places[1].position_known);
  EXPECT_NE(estimate.sentence.find("where it sits"), std::string::npos) << estimate.sentence;
  expectRotation(estimate, rig, 1, 0.5 * kDegree);
}

TEST(RigCalibrator, KeepsTheSegmentsThatTurn) {
  RigOptions options;
  options.segment_frames = 10;
  options.max_frames = 20;
  RigCalibrator calibrator(options, 2, nullptr);
  for (int f = 0; f < 1000; ++f) {
    RigFrame frame;
    frame.stamp_ns = f;
    frame.views.resize(2);
    frame.views[0].world_from_camera = Rigid3();
    calibrator.add(frame);
    EXPECT_LE(calibrator.frames(), 20);
  }
  EXPECT_GT(calibrator.frames(), 10);
}

TEST(RigCalibrator, SeveralSegmentsAgree) {
  const SimulatedRig rig = simulateRig(stereo());
  RigOptions options;
  options.segment_frames = 14;
  const RigEstimate estimate = calibrated(rig, options);
  ASSERT_TRUE(estimate.usable) << estimate.sentence;
  EXPECT_EQ(estimate.poses.back().segment, 2);
  expectRotation(estimate, rig, 1, 0.1 * kDegree);
  expectDirection(estimate, rig, 1, 1.0 * kDegree);
}

// As when the first camera loses its way and begins anew.
TEST(RigCalibrator, MapsOfDifferentScaleAgree) {
  SimulatedRig rig = simulateRig(stereo());
  for (std::size_t f = 25; f < rig.frames.size(); ++f) {
    RigView& first = rig.frames[f].views.front();
    first.map_id = 1;
    first.world_from_camera->translation *= 4.0;
  }
  const RigEstimate estimate = calibrated(rig);
  ASSERT_TRUE(estimate.usable) << estimate.sentence;
  EXPECT_EQ(estimate.poses.back().segment, 1);
  expectRotation(estimate, rig, 1, 0.1 * kDegree);
  expectDirection(estimate, rig, 1, 1.0 * kDegree);
}

TEST(RigCalibrator, NothingWithoutFrames) {
  RigCalibrator calibrator({}, 2, nullptr);
  const RigEstimate estimate = calibrator.estimate({rigLens(400.0, 0.0), rigLens(400.0, 0.0)});
  EXPECT_FALSE(estimate.usable);
  EXPECT_FALSE(estimate.sentence.empty());
}

}  // namespace
}  // namespace camera_self_calibration
