#include "camera_self_calibration/rig/rig_self_calibrator.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <string>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/simulated_sequence.h"
#include "rig/simulated_rig.h"

namespace camera_self_calibration {
namespace {

const Camera kCamera(CameraModel::kFov, 320, 240, intrinsics({150, 151, 159, 121, 0.95}));
const Rigid3 kLeftFromRight(expSo3({0.02, -0.03, 0.01}), {0.2, 0.0, 0.0});

using Pairs = std::vector<std::array<ImageView, 2>>;

// Rendered pairs; from a time on the right camera is turned in its own frame.
Pairs rendered(double duration_s, double turned_s, const Rigid3& turn) {
  SyntheticMotionOptions motion;
  motion.duration_s = duration_s;
  const Trajectory way = syntheticMotion(motion);
  SequenceOptions options;
  options.lens.camera = kCamera;
  options.room.texture_detail = 0.3;
  options.rate_hz = 12.0;
  options.duration_s = motion.duration_s;
  options.trajectory = way;
  const SimulatedSequence left(options);
  options.noise_seed = 2;
  options.trajectory = Trajectory(
      [=](double time_s) {
        const Rigid3 right = way.worldFromCamera(time_s) * kLeftFromRight;
        return time_s < turned_s ? right : right * turn;
      },
      way.duration());
  const SimulatedSequence right(options);
  Pairs list;
  for (int i = 0; i < left.size(); ++i) {
    list.push_back({left.frame(i).view(), right.frame(i).view()});
  }
  return list;
}

// A few seconds, made once.
const Pairs& pairs() {
  static const Pairs views = rendered(4.0, 1e9, Rigid3());
  return views;
}

std::vector<Options> held() { return std::vector<Options>(2, Options().withHeld(kCamera)); }

TEST(RigSelfCalibrator, FindsTheRightCameraInRenderedImages) {
  int keyframe_reports = 0;
  RigCallbacks callbacks;
  callbacks.rig = [&](const RigReport&) { ++keyframe_reports; };
  RigOptions options;
  options.solve.hold_intrinsics = {true, true};
  RigSelfCalibrator rig(options, held(), SelfCalibrator::Mode::kInline, callbacks);
  for (const auto& pair : pairs()) {
    for (int c = 0; c < 2; ++c) EXPECT_TRUE(rig.process(c, pair[c]));
  }
  EXPECT_GT(keyframe_reports, 4);
  const RigReport report = rig.solve();
  ASSERT_TRUE(report.estimate.usable) << report.sentence;
  EXPECT_GT(report.estimate.places[1].shared_landmarks, 20);
  const Rigid3& found = report.estimate.rig.rig_from_camera[1];
  EXPECT_LT(angleBetween(found.rotation, kLeftFromRight.rotation), 2e-3);
  EXPECT_LT(angleBetween(found.translation, kLeftFromRight.translation), 2e-2);
}

TEST(RigSelfCalibrator, ACameraThatIsTurnedRaisesAnEvent) {
  constexpr double kTurnedS = 3.0;
  const Rigid3 turn(expSo3({0.0, 0.0, 0.02}), Eigen::Vector3d::Zero());
  std::vector<Options> cameras = held();
  for (Options& options : cameras) options.keyframe.min_parallax = 0.002;  // many keyframes
  std::vector<Event> events;
  RigCallbacks callbacks;
  callbacks.event = [&](int camera, const Event& event) {
    if (event.type != EventType::kMountChanged) return;
    EXPECT_EQ(camera, 1);
    events.push_back(event);
  };
  RigSelfCalibrator rig({}, cameras, SelfCalibrator::Mode::kInline, callbacks);
  const Pairs turned = rendered(6.0, kTurnedS, turn);
  for (const auto& pair : turned) {
    for (int c = 0; c < 2; ++c) rig.process(c, pair[c]);
  }
  const RigReport report = rig.solve();
  ASSERT_EQ(events.size(), 1u) << report.sentence;
  const double begin_s = toSeconds(turned.front().front().stamp_ns);
  EXPECT_NEAR(toSeconds(events[0].onset_stamp_ns) - begin_s, kTurnedS, 1.0);
  EXPECT_NEAR(events[0].rotation, 0.02, 3.0 * events[0].rotation_sigma + 5e-4);
  EXPECT_GT(events[0].stamp_ns, events[0].onset_stamp_ns);
  EXPECT_EQ(events[0].epoch, report.epoch);
  EXPECT_LT(angleBetween(report.estimate.rig.rig_from_camera[1].rotation,
                         (kLeftFromRight * turn).rotation),
            5e-3);
}

// What a threaded run told so far; callbacks come from five threads.
struct Told {
  std::mutex mutex;
  std::condition_variable news;
  std::array<std::size_t, 2> frames{};
  int solutions = 0;

  RigCallbacks callbacks() {
    RigCallbacks result;
    result.frame = [this](int camera, const FrameResult& frame) {
      const std::lock_guard<std::mutex> lock(mutex);
      EXPECT_NE(frame.image.data, nullptr);
      ++frames[camera];
      news.notify_all();
    };
    result.rig = [this](const RigReport& report) {
      const std::lock_guard<std::mutex> lock(mutex);
      solutions = report.solutions;
      news.notify_all();
    };
    return result;
  }
};

TEST(RigSelfCalibrator, SolvesBesideTheImages) {
  std::vector<Options> cameras = held();
  for (Options& options : cameras) {
    options.max_queued_images = 1000;
    options.keyframe.min_parallax = 0.002;  // many keyframes
  }
  Told told;
  RigSelfCalibrator rig({}, cameras, SelfCalibrator::Mode::kThreaded, told.callbacks());
  for (const auto& pair : pairs()) {
    for (int c = 0; c < 2; ++c) rig.process(c, pair[c]);
  }
  const std::size_t all = pairs().size();
  std::unique_lock<std::mutex> lock(told.mutex);
  EXPECT_TRUE(told.news.wait_for(
      lock, std::chrono::seconds(120),
      [&] { return told.frames[0] == all && told.frames[1] == all && told.solutions > 0; }))
      << told.frames[0] << " and " << told.frames[1] << " images, " << told.solutions
      << " solutions";
}

TEST(RigSelfCalibrator, ACallbackThatThrowsEndsNoProcess) {
  std::vector<Options> cameras = held();
  for (Options& options : cameras) {
    options.max_queued_images = 1000;
    options.keyframe.min_parallax = 0.002;  // many keyframes
  }
  std::mutex mutex;
  std::condition_variable news;
  std::string told;
  std::int64_t told_ns = 0;
  RigCallbacks callbacks;
  callbacks.rig = [](const RigReport& report) {
    if (report.solutions > 0) throw std::runtime_error("no room on the disk");
  };
  callbacks.event = [&](int, const Event& event) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (event.sentence.find("solved together") == std::string::npos) return;
    told = event.sentence;
    told_ns = event.stamp_ns;
    news.notify_all();
  };
  RigSelfCalibrator rig({}, cameras, SelfCalibrator::Mode::kThreaded, callbacks);
  for (const auto& pair : pairs()) {
    for (int c = 0; c < 2; ++c) rig.process(c, pair[c]);
  }
  std::unique_lock<std::mutex> lock(mutex);
  ASSERT_TRUE(news.wait_for(lock, std::chrono::seconds(120), [&] { return !told.empty(); }));
  EXPECT_EQ(told, "the cameras could not be solved together: no room on the disk");
  EXPECT_GE(told_ns, pairs().front()[0].stamp_ns);
}

TEST(RigSelfCalibrator, MayBeDestroyedInTheMiddleOfWork) {
  for (const std::size_t images : {0u, 3u, 30u}) {
    RigSelfCalibrator rig({}, held(), SelfCalibrator::Mode::kThreaded, {});
    for (std::size_t i = 0; i < images; ++i) {
      for (int c = 0; c < 2; ++c) rig.process(c, pairs()[i][c]);
    }
  }
}

TEST(RigSelfCalibrator, OptionsAreChecked) {
  std::vector<Options> cameras(2);
  cameras[1].alpha = 2.0;
  EXPECT_THROW(RigSelfCalibrator({}, cameras, SelfCalibrator::Mode::kInline, {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace camera_self_calibration
