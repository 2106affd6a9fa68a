// What may be asked of a running calibrator.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>

#include "estimation/sample_segments.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {
namespace {

const Camera kTruth = ordinaryCameras()[1];

class RequestsTest : public testing::Test {
 protected:
  RequestsTest() : run_(kTruth, optionsFor(kTruth.model()), TrackRunOptions()) {
    EXPECT_TRUE(run_.runUntilConverged(600));
  }
  const FrameResult& frame() const { return run_.record.frames.back(); }

  TrackRun run_;
};

TEST_F(RequestsTest, ResetForgetsAndLearnsAgain) {
  const CalibrationReport before = run_.report();
  const std::uint64_t map_id = frame().map_id;
  run_.calibrator().reset();
  run_.step();
  const CalibrationReport after = run_.report();
  EXPECT_NE(after.state, CalibrationState::kConverged);
  EXPECT_FALSE(after.handed_over);
  EXPECT_TRUE(after.queue.segments.empty());
  EXPECT_EQ(after.camera.parameters(), Camera::defaultGuess(kTruth.model(), 640, 480).parameters());
  EXPECT_FALSE(run_.calibrator().state());
  EXPECT_GT(frame().map_id, map_id);
  ASSERT_TRUE(run_.runUntilConverged(600)) << run_.report().sentence;
  EXPECT_LT(pixelDistance(kTruth, run_.report().camera).rms, 1.0);
  EXPECT_GT(run_.report().revision, before.revision);
  EXPECT_EQ(run_.report().starts_given_up, 0u) << "a guess is no start that was given";
}

TEST_F(RequestsTest, ResetTakesAStart) {
  run_.calibrator().reset(kTruth);
  run_.step();
  EXPECT_EQ(run_.report().camera.parameters(), kTruth.parameters());
  EXPECT_NE(run_.report().state, CalibrationState::kConverged);
  EXPECT_THROW(run_.calibrator().reset(Camera()), std::invalid_argument);
  EXPECT_THROW(run_.calibrator().reset(Camera::defaultGuess(CameraModel::kPinhole, 640, 480)),
               std::invalid_argument);
  Intrinsics millimetres = kTruth.parameters();
  millimetres.head<4>() << 4.2, 4.2, 3.2, 2.4;
  EXPECT_THROW(run_.calibrator().reset(withParameters(kTruth, millimetres)), std::invalid_argument);
}

// A focal length that is far off is learnt.
TEST(Requests, NoStartTrapsIt) {
  for (const double factor : {0.25, 0.5, 2.0, 8.0}) {
    Intrinsics start = kTruth.parameters();
    start.head<2>() *= factor;
    Options options = optionsFor(kTruth.model());
    options.initial_camera = withParameters(kTruth, start);
    TrackRun run(kTruth, options, TrackRunOptions());
    EXPECT_TRUE(run.runUntilConverged(900)) << factor << ": " << run.report().sentence;
    EXPECT_LT(pixelDistance(kTruth, run.report().camera).rms, 1.0) << factor;
  }
}

// Distortion that no track follows makes maps be lost one after the other.
TEST(Requests, AStartThatPosesContradictIsGivenUp) {
  const Camera truth = ordinaryCameras()[2];
  Intrinsics start = truth.parameters();
  start.tail<4>() << -2.0, 0.0, 0.0, 0.0;
  start.head<2>() *= 0.3;
  Options options = optionsFor(truth.model());
  options.initial_camera = withParameters(truth, start);
  TrackRun run(truth, options, TrackRunOptions());
  EXPECT_TRUE(run.runUntilConverged(900)) << run.report().sentence;
  EXPECT_LT(pixelDistance(truth, run.report().camera).rms, 1.0);
  const auto& events = run.record.events;
  EXPECT_TRUE(std::any_of(events.begin(), events.end(), [](const Event& event) {
    return event.sentence.find("start values are given up") != std::string::npos;
  }));
  EXPECT_EQ(run.record.reports.back().starts_given_up, 1u);
  ASSERT_TRUE(run.record.reports.back().start_given_up);
  EXPECT_EQ(run.record.reports.back().start_given_up->parameters(), start);
}

// The same where it follows a calibration that was learnt.
TEST(Requests, AfterAResetAStartThatPosesContradictIsGivenUpToo) {
  const Camera truth = ordinaryCameras()[2];
  Intrinsics start = truth.parameters();
  start.tail<4>() << -2.0, 0.0, 0.0, 0.0;
  start.head<2>() *= 0.3;
  TrackRun run(truth, optionsFor(truth.model()), TrackRunOptions());
  ASSERT_TRUE(run.runUntilConverged(600)) << run.report().sentence;
  run.calibrator().reset(withParameters(truth, start));
  run.step();
  EXPECT_TRUE(run.runUntilConverged(900)) << run.report().sentence;
  EXPECT_EQ(run.record.reports.back().starts_given_up, 1u);
  EXPECT_LT(pixelDistance(truth, run.report().camera).rms, 1.0);
}

TEST_F(RequestsTest, FrozenItKeepsTheCalibrationAndGoesOnTracking) {
  ASSERT_TRUE(run_.calibrator().freeze(true));
  run_.step();
  const CalibrationReport before = run_.report();
  const auto keyframes = run_.record.reports.size();
  run_.run(120);
  const CalibrationReport after = run_.report();
  EXPECT_GT(run_.record.reports.size(), keyframes + 5);
  EXPECT_EQ(after.camera.parameters(), before.camera.parameters());
  EXPECT_EQ(after.revision, before.revision);
  EXPECT_EQ(after.queue.swaps, before.queue.swaps);
  EXPECT_EQ(after.state, CalibrationState::kConverged);
  EXPECT_TRUE(after.frozen);
  EXPECT_NE(after.sentence.find("frozen"), std::string::npos);
  EXPECT_GT(after.keyframes, before.keyframes);
  EXPECT_EQ(frame().state, TrackingState::kTracking);
  ASSERT_TRUE(run_.calibrator().freeze(false));
  run_.run(120);
  EXPECT_FALSE(run_.report().frozen);
  EXPECT_GT(run_.report().queue.swaps, after.queue.swaps);
}

TEST(Requests, ThereIsNothingToFreezeAtTheStart) {
  TrackRun run(kTruth, optionsFor(kTruth.model()), TrackRunOptions());
  EXPECT_FALSE(run.calibrator().freeze(true));
  EXPECT_TRUE(run.calibrator().freeze(false));
  EXPECT_FALSE(run.calibrator().setScale(2.0)) << "nothing is tracked yet";
  EXPECT_FALSE(run.calibrator().state());
}

TEST_F(RequestsTest, SetScaleMultipliesLengthsInANewMapId) {
  const FrameResult before = frame();
  ASSERT_TRUE(run_.calibrator().setScale(2.5));
  run_.step();
  const FrameResult after = frame();
  EXPECT_EQ(after.map_id, before.map_id + 1);
  EXPECT_EQ(after.state, TrackingState::kTracking);
  // The camera went on by one frame only, little against its distance from the origin.
  const double ratio =
      after.world_from_camera.translation.norm() / before.world_from_camera.translation.norm();
  EXPECT_NEAR(ratio, 2.5, 0.1);
  const auto lost = run_.record.count(EventType::kLost);
  run_.run(60);
  EXPECT_EQ(run_.record.count(EventType::kLost), lost);
  EXPECT_EQ(frame().map_id, after.map_id);
  EXPECT_EQ(run_.report().state, CalibrationState::kConverged);
  for (const double wrong : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    EXPECT_FALSE(run_.calibrator().setScale(wrong)) << wrong;
  }
}

// Lengths of the same frames, once scaled and once not.
TEST(Requests, TheScaleLasts) {
  TrackRun plain(kTruth, optionsFor(kTruth.model()), TrackRunOptions());
  TrackRun scaled(kTruth, optionsFor(kTruth.model()), TrackRunOptions());
  plain.run(200);
  scaled.run(200);
  ASSERT_TRUE(scaled.calibrator().setScale(10.0));
  plain.run(60);
  scaled.run(60);
  const auto step = [](const TrackRun& run) {
    const auto& frames = run.record.frames;
    return (frames[frames.size() - 1].world_from_camera.translation -
            frames[frames.size() - 40].world_from_camera.translation)
        .norm();
  };
  EXPECT_NEAR(step(scaled) / step(plain), 10.0, 0.5);
}

ImageView blackImage(std::int64_t stamp_ns) {
  static const std::vector<std::uint8_t> pixels(64 * 48, 0);
  ImageView image;
  image.data = pixels.data();
  image.width = image.stride = 64;
  image.height = 48;
  image.stamp_ns = stamp_ns;
  return image;
}

// Whatever a callback throws, the process that hosts the threads lives, and the work goes on.
TEST(Requests, CallbacksThatThrowEndNothing) {
  std::atomic<int> frames{0};
  std::atomic<int> events{0};
  Callbacks callbacks;
  callbacks.frame = [&](const FrameResult&) {
    if (++frames % 2 == 0) throw 42;  // no std::exception
    throw std::runtime_error("frame");
  };
  callbacks.event = [&](const Event&) {
    ++events;
    throw std::runtime_error("event");
  };
  SelfCalibrator calibrator(Options(), SelfCalibrator::Mode::kThreaded, callbacks);
  for (int i = 1; i <= 4; ++i) {
    calibrator.process(blackImage(i * 100000000));
    calibrator.flush();
  }
  EXPECT_EQ(frames, 4);
  EXPECT_EQ(events, 4);
}

TEST(Requests, AThreadedCalibratorTakesImagesOrTracks) {
  SelfCalibrator calibrator(Options(), SelfCalibrator::Mode::kThreaded, Callbacks());
  calibrator.process(blackImage(1));
  TrackedFrame frame;
  EXPECT_THROW(calibrator.processTracks(frame, [] { return std::vector<Track>(); }),
               std::logic_error);
  calibrator.flush();
}

}  // namespace
}  // namespace camera_self_calibration
