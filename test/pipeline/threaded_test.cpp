#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <iostream>
#include <memory>
#include <mutex>
#include <thread>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/simulation/simulated_sequence.h"
#include "camera_self_calibration/tracking/image_motion.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {
namespace {

const Camera kTruth(CameraModel::kFov, 320, 240, intrinsics({150, 151, 159, 121, 0.95}));

// A few seconds of rendered images, made once.
const std::vector<ImageView>& images() {
  static const std::vector<ImageView> views = [] {
    SequenceOptions options;
    options.lens.camera = kTruth;
    options.room.texture_detail = 0.3;
    options.rate_hz = 12.0;
    options.duration_s = 3.0;
    options.motion.speed = 0.6;
    const SimulatedSequence sequence(options);
    std::vector<ImageView> list;
    for (int i = 0; i < sequence.size(); ++i) list.push_back(sequence.frame(i).view());
    return list;
  }();
  return views;
}

// Callbacks come from two threads, until they are told to end.
struct LockedRecord {
  std::mutex mutex;
  std::condition_variable came;  // a frame
  Record record;
  bool ended = false;

  void waitForFrames(std::size_t count) {
    std::unique_lock<std::mutex> lock(mutex);
    came.wait(lock, [&] { return ended || record.frames.size() >= count; });
  }

  void end() {
    const std::lock_guard<std::mutex> lock(mutex);
    ended = true;
    came.notify_all();
  }

  Callbacks callbacks() {
    Callbacks inner = record.callbacks();
    Callbacks result;
    result.frame = [this, inner](const FrameResult& frame) {
      const std::lock_guard<std::mutex> lock(mutex);
      EXPECT_FALSE(ended);
      inner.frame(frame);
      came.notify_all();
    };
    result.calibration = [this, inner](const CalibrationReport& report) {
      const std::lock_guard<std::mutex> lock(mutex);
      inner.calibration(report);
    };
    result.event = [this, inner](const Event& event) {
      const std::lock_guard<std::mutex> lock(mutex);
      inner.event(event);
    };
    return result;
  }
};

Options smallOptions() {
  Options options;
  options.model = CameraModel::kFov;
  options.tracker.max_features = 80;
  return options;
}

TEST(Threaded, ProcessesEveryImageThatIsWaitedFor) {
  LockedRecord locked;
  SelfCalibrator calibrator(smallOptions(), SelfCalibrator::Mode::kThreaded, locked.callbacks());
  for (const ImageView& image : images()) {
    EXPECT_TRUE(calibrator.process(image));
    calibrator.flush();
  }
  const Record& record = locked.record;
  ASSERT_EQ(record.frames.size(), images().size());
  EXPECT_EQ(calibrator.droppedImages(), 0);
  std::size_t keyframes = 0;
  for (std::size_t i = 0; i < images().size(); ++i) {
    EXPECT_EQ(record.frames[i].stamp_ns, images()[i].stamp_ns);
    // Those of the last two images are not handed on yet.
    if (i + MotionHistory::kReach < images().size()) keyframes += record.frames[i].is_keyframe;
  }
  EXPECT_GE(keyframes, 5u);
  EXPECT_EQ(record.reports.size(), keyframes);
  EXPECT_EQ(calibrator.calibration().keyframes, static_cast<std::int64_t>(keyframes));
  EXPECT_EQ(record.count(EventType::kLost), 0);
  EXPECT_EQ(record.frames.back().state, TrackingState::kTracking);
}

// Waiting after each image leaves nothing to chance: the same as inline.
TEST(Threaded, WaitedForItIsTheSameAsInline) {
  LockedRecord threaded, single;
  SelfCalibrator a(smallOptions(), SelfCalibrator::Mode::kThreaded, threaded.callbacks());
  SelfCalibrator b(smallOptions(), SelfCalibrator::Mode::kInline, single.callbacks());
  for (std::size_t i = 0; i < 18; ++i) {
    a.process(images()[i]);
    a.flush();
    b.process(images()[i]);
  }
  ASSERT_EQ(threaded.record.reports.size(), single.record.reports.size());
  EXPECT_EQ(a.calibration().camera.parameters(), b.calibration().camera.parameters());
  EXPECT_EQ(threaded.record.frames.back().world_from_camera.translation,
            single.record.frames.back().world_from_camera.translation);
}

TEST(Threaded, DropsTheOldestWhenItCannotFollow) {
  LockedRecord locked;
  std::atomic<int> kept{0};
  {
    SelfCalibrator calibrator(smallOptions(), SelfCalibrator::Mode::kThreaded, locked.callbacks());
    for (const ImageView& image : images()) kept += calibrator.process(image);
    calibrator.flush();
    const auto frames = static_cast<std::int64_t>(locked.record.frames.size());
    EXPECT_EQ(frames + calibrator.droppedImages(), static_cast<std::int64_t>(images().size()));
    EXPECT_EQ(kept + calibrator.droppedImages(), static_cast<std::int64_t>(images().size()));
  }
  // The newest is never the one that goes.
  EXPECT_EQ(locked.record.frames.back().stamp_ns, images().back().stamp_ns);
  std::int64_t last = 0;
  for (const FrameResult& frame : locked.record.frames) {
    EXPECT_GT(frame.stamp_ns, last);
    last = frame.stamp_ns;
  }
}

TEST(Threaded, MayBeDestroyedInTheMiddleOfWork) {
  for (int round = 0; round < 8; ++round) {
    LockedRecord locked;
    auto calibrator = std::make_unique<SelfCalibrator>(
        smallOptions(), SelfCalibrator::Mode::kThreaded, locked.callbacks());
    for (int i = 0; i < 4 * round; ++i) {
      calibrator->process(images()[i]);
      // Some that are behind, and at last some that nobody waits for.
      if (i % 2 == 0 && i < 3 * round) locked.waitForFrames(static_cast<std::size_t>(i) / 4);
    }
    calibrator.reset();
    locked.end();  // from now on a frame fails the test
    EXPECT_LE(locked.record.frames.size(), static_cast<std::size_t>(4 * round));
  }
}

TEST(Threaded, TakesCallsFromOtherThreads) {
  LockedRecord locked;
  SelfCalibrator calibrator(smallOptions(), SelfCalibrator::Mode::kThreaded, locked.callbacks());
  std::atomic<bool> stop{false};
  std::atomic<int> reads{0};
  std::thread reader([&] {
    while (!stop) {
      const CalibrationReport report = calibrator.calibration();
      EXPECT_TRUE(report.camera.width() == 0 || report.camera.width() == 320);
      EXPECT_GE(calibrator.droppedImages(), 0);
      ++reads;
      std::this_thread::yield();
    }
  });
  for (std::size_t i = 0; i < 30; ++i) {
    const int before = reads;
    calibrator.process(images()[i]);
    if (i == 15) {
      locked.waitForFrames(1);  // where nothing was tracked, there is nothing to reset
      calibrator.resetTracking();
    }
    while (reads == before) std::this_thread::yield();  // one read at least beside each image
  }
  calibrator.flush();
  stop = true;
  reader.join();
  EXPECT_GE(locked.record.frames.back().map_id, 1u);
}

TEST(Threaded, BadImagesHarmNothing) {
  LockedRecord locked;
  SelfCalibrator calibrator(smallOptions(), SelfCalibrator::Mode::kThreaded, locked.callbacks());
  calibrator.process(ImageView());
  calibrator.flush();
  for (int i = 0; i < 5; ++i) {
    calibrator.process(images()[i]);
    calibrator.flush();
  }
  ImageView other = images()[5];
  other.width = 160;
  calibrator.process(other);
  calibrator.flush();
  EXPECT_EQ(locked.record.count(EventType::kInput), 2);
  EXPECT_EQ(locked.record.frames.size(), 5u);
  EXPECT_EQ(calibrator.calibration().camera.width(), 320);
}

// The back end may lag behind by any number of keyframes: its solutions arrive late, and some
// keyframes never reach it.
TEST(Threaded, BearsABackEndThatLags) {
  constexpr std::size_t kFrames = 300;
  const Camera truth = camera640(CameraModel::kFov, {300, 302, 318, 242, 0.95});
  SyntheticMotionOptions motion;
  motion.speed = 0.6;
  FeatureTracksOptions track_options;
  track_options.max_features = 80;
  FeatureTracks tracks(makeRoom(RoomOptions()), Lens{truth, std::nullopt, 1.0},
                       syntheticMotion(motion), track_options);
  LockedRecord locked;
  Callbacks callbacks = locked.callbacks();
  const auto calibration = callbacks.calibration;
  // Each report holds the back end up until so many images more have come.
  constexpr std::size_t kLag = 20;
  std::atomic<std::size_t> released{0};
  callbacks.calibration = [&](const CalibrationReport& report) {
    calibration(report);
    released += kLag;
    locked.waitForFrames(std::min<std::size_t>(released, kFrames));
  };
  SelfCalibrator calibrator(smallOptions(), SelfCalibrator::Mode::kThreaded, callbacks);
  for (std::size_t i = 0; i < kFrames; ++i) {
    const TrackedFrame frame = tracks.track(static_cast<std::int64_t>(1e9 * i / 15.0));
    calibrator.processTracks(frame, [&tracks] { return tracks.detect(); });
    locked.waitForFrames(i + 1);
  }
  calibrator.flush();
  const CalibrationReport report = calibrator.calibration();
  std::cout << locked.record.reports.size() << " of " << report.keyframes
            << " keyframes reached the back end: " << report.sentence << "\n";
  EXPECT_EQ(locked.record.frames.size(), kFrames);
  EXPECT_EQ(locked.record.frames.back().state, TrackingState::kTracking);
  EXPECT_EQ(locked.record.count(EventType::kLost), 0);
  EXPECT_LT(locked.record.reports.size(), static_cast<std::size_t>(report.keyframes));
}

}  // namespace
}  // namespace camera_self_calibration
