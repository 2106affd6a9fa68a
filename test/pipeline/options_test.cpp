#include "camera_self_calibration/pipeline/options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"

namespace camera_self_calibration {
namespace {

int problemsNaming(const Options& options, const std::string& name) {
  int found = 0;
  for (const std::string& problem : options.problems()) {
    found += problem.find(name) != std::string::npos;
  }
  return found;
}

TEST(Options, DefaultsAreValid) { EXPECT_TRUE(Options().problems().empty()); }

TEST(Options, EachViolationIsNamed) {
  const auto expectNamed = [](const std::string& name, const auto& spoil) {
    Options options;
    spoil(&options);
    EXPECT_EQ(options.problems().size(), 1u) << name;
    EXPECT_EQ(problemsNaming(options, name), 1) << name;
  };
  expectNamed("max_features", [](Options* o) { o->tracker.max_features = 0; });
  expectNamed("keyframe_min_parallax", [](Options* o) { o->keyframe.min_parallax = -1.0; });
  expectNamed("keyframe_min_parallax", [](Options* o) { o->keyframe.min_parallax = 1.0; });
  expectNamed("keyframe_min_rotation_deg",
              [](Options* o) { o->keyframe.min_rotation_deg = 180.0; });
  expectNamed("keyframe_min_tracked_share",
              [](Options* o) { o->keyframe.min_tracked_share = 1.1; });
  expectNamed("min_distance_px", [](Options* o) { o->tracker.min_distance_px = INFINITY; });
  expectNamed("false_alarms_per_hour", [](Options* o) { o->false_alarms_per_hour = 61.0; });
  expectNamed("sliding_window_keyframes", [](Options* o) { o->sliding_window_keyframes = 1; });
  expectNamed("segment_keyframes", [](Options* o) { o->segment_keyframes = 2; });
  expectNamed("queue_segments", [](Options* o) { o->queue_segments = 0; });
  expectNamed("startup_keyframes", [](Options* o) { o->startup_keyframes = 5; });
  expectNamed("alpha", [](Options* o) { o->alpha = 1.0; });
  expectNamed("alpha", [](Options* o) { o->alpha = 0.0; });
  expectNamed("alpha", [](Options* o) { o->alpha = NAN; });
  expectNamed("converged_pixel_rms", [](Options* o) { o->converged_pixel_rms = -1.0; });
  expectNamed("converged_pixel_rms", [](Options* o) { o->converged_pixel_rms = INFINITY; });
  expectNamed("handover_entropy", [](Options* o) { o->handover_entropy = NAN; });
  expectNamed("solver_threads", [](Options* o) { o->solver_threads = 0; });
  expectNamed("relocalization_keyframes", [](Options* o) { o->relocalization_keyframes = -1; });
  expectNamed("max_queued_images", [](Options* o) { o->max_queued_images = 0; });
  expectNamed("rolling_shutter", [](Options* o) { o->readout_s = 5.0; });
  expectNamed("fix_intrinsics", [](Options* o) { o->fix_intrinsics = true; });  // which?
  const Camera pinhole = camera640(CameraModel::kPinhole, {300, 300, 320, 240});
  expectNamed("initial intrinsics", [&](Options* o) {
    o->model = CameraModel::kFov;
    o->initial_camera = pinhole;
  });
  expectNamed("initial intrinsics", [](Options* o) {
    o->initial_camera = Camera(CameraModel::kFov, 0, 0, intrinsics({300, 300, 320, 240, 1}));
  });
  expectNamed("initial intrinsics", [](Options* o) {
    o->initial_camera = camera640(CameraModel::kFov, {-300, 300, 320, 240, 1});
  });
}

// What a mistyped parameter would otherwise reserve.
TEST(Options, EveryCountHasAnUpperLimit) {
  const auto expectLimit = [](const std::string& name, int most, const auto& count) {
    Options options;
    if (name == "segment_keyframes") options.startup_keyframes = most;
    count(&options) = most;
    EXPECT_TRUE(options.problems().empty()) << name;
    count(&options) = most + 1;
    EXPECT_GE(problemsNaming(options, name + " "), 1) << name;
  };
  expectLimit("max_features", 10000, [](Options* o) -> int& { return o->tracker.max_features; });
  expectLimit("sliding_window_keyframes", 1000,
              [](Options* o) -> int& { return o->sliding_window_keyframes; });
  expectLimit("segment_keyframes", 1000, [](Options* o) -> int& { return o->segment_keyframes; });
  expectLimit("queue_segments", 1000, [](Options* o) -> int& { return o->queue_segments; });
  expectLimit("startup_keyframes", 1000, [](Options* o) -> int& { return o->startup_keyframes; });
  expectLimit("relocalization_keyframes", 100000,
              [](Options* o) -> int& { return o->relocalization_keyframes; });
  expectLimit("solver_threads", 256, [](Options* o) -> int& { return o->solver_threads; });
  expectLimit("max_queued_images", 1000, [](Options* o) -> int& { return o->max_queued_images; });
}

TEST(Options, AllViolationsAreListedTogether) {
  Options options;
  options.alpha = 2.0;
  options.queue_segments = -3;
  options.solver_threads = 0;
  options.tracker.max_features = -1;
  options.keyframe.min_tracked_share = 7.0;
  EXPECT_EQ(options.problems().size(), 5u);
  try {
    SelfCalibrator calibrator(options, SelfCalibrator::Mode::kThreaded, Callbacks());
    FAIL() << "the options were taken";
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    for (const std::string& problem : options.problems()) {
      EXPECT_NE(text.find(problem), std::string::npos) << problem;
    }
  }
}

TEST(Options, ThresholdFollowsTheLongerSide) {
  Options options;
  const auto imagesOf = [](int width, int height) {
    return Camera::defaultGuess(CameraModel::kPinhole, width, height);
  };
  EXPECT_DOUBLE_EQ(options.convergedRms(imagesOf(640, 480)), 1.0);
  EXPECT_DOUBLE_EQ(options.convergedRms(imagesOf(480, 640)), 1.0) << "held upright";
  EXPECT_DOUBLE_EQ(options.convergedRms(imagesOf(320, 240)), 0.5);
  options.converged_pixel_rms = 0.3;
  EXPECT_DOUBLE_EQ(options.convergedRms(imagesOf(1920, 1080)), 0.3);
}

TEST(Results, NamesOfStatesAndEvents) {
  EXPECT_EQ(toString(TrackingState::kInitializing), "INITIALIZING");
  EXPECT_EQ(toString(TrackingState::kTracking), "TRACKING");
  EXPECT_EQ(toString(TrackingState::kLost), "LOST");
  EXPECT_EQ(toString(EventType::kCalibrationChange), "CALIBRATION_CHANGE");
  EXPECT_EQ(toString(EventType::kHandover), "HANDOVER");
  EXPECT_EQ(toString(EventType::kConverged), "CONVERGED");
  EXPECT_EQ(toString(EventType::kLost), "LOST");
  EXPECT_EQ(toString(EventType::kRelocalized), "RELOCALIZED");
  EXPECT_EQ(toString(EventType::kInput), "INPUT");
  EXPECT_EQ(toString(EventType::kMountChanged), "MOUNT_CHANGED");
  EXPECT_EQ(toString(EventType::kNoLongerConverged), "NO_LONGER_CONVERGED");
}

}  // namespace
}  // namespace camera_self_calibration
