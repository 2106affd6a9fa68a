#include "camera_self_calibration/ros/calibration_session.h"

#include <gtest/gtest.h>

#include <vector>

namespace camera_self_calibration {
namespace {

/// Images of noise: the first begins a map.
ImageView noise(int width, int height, std::int64_t stamp_ns) {
  const auto pixels = std::make_shared<std::vector<std::uint8_t>>();
  std::uint32_t state = 1;
  for (int i = 0; i < width * height; ++i) {
    state = state * 1664525u + 1013904223u;
    pixels->push_back(static_cast<std::uint8_t>(state >> 24));
  }
  return {pixels, pixels->data(), width, height, width, stamp_ns};
}

struct Recording {
  std::mutex mutex;
  std::vector<FrameResult> frames;

  Callbacks callbacks() {
    Callbacks result;
    result.frame = [this](const FrameResult& frame) {
      const std::lock_guard<std::mutex> lock(mutex);
      frames.push_back(frame);
    };
    return result;
  }
};

TEST(CalibrationSession, NumbersGoOnWhenItBeginsAnew) {
  Recording recording;
  CalibrationSession session(Options(), recording.callbacks());
  EXPECT_FALSE(session.running());
  std::int64_t stamp_ns = 1000000000;
  for (const int width : {160, 160, 80}) {
    ASSERT_EQ(session.start(std::nullopt), "");
    session.process(noise(width, 120, ++stamp_ns));
    session.calibrator()->flush();
  }
  session.stop();
  EXPECT_FALSE(session.running());
  ASSERT_EQ(recording.frames.size(), 3u);
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_GT(recording.frames[i].map_id, recording.frames[i - 1].map_id);
    EXPECT_GT(recording.frames[i].calibration_revision,
              recording.frames[i - 1].calibration_revision);
  }
}

TEST(CalibrationSession, SaysWhyItCannotBegin) {
  Options options;
  options.model = CameraModel::kFov;
  CalibrationSession session{options, Callbacks()};
  const Camera wrong_model = Camera::defaultGuess(CameraModel::kPinhole, 640, 480);
  EXPECT_NE(session.start(wrong_model).find("initial intrinsics"), std::string::npos);
  EXPECT_FALSE(session.running());
}

}  // namespace
}  // namespace camera_self_calibration
