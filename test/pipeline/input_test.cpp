#include <gtest/gtest.h>

#include <stdexcept>

#include "estimation/sample_segments.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {
namespace {

const Camera kTruth = ordinaryCameras()[1];

// Converged, to see what an accident takes away.
class InputTest : public testing::Test {
 protected:
  InputTest() : run_(kTruth, optionsFor(kTruth.model()), TrackRunOptions()) {
    EXPECT_TRUE(run_.runUntilConverged(600));
    before_ = run_.report();
  }

  void expectCalibrationKept() const {
    const CalibrationReport after = run_.report();
    EXPECT_EQ(after.state, CalibrationState::kConverged);
    EXPECT_TRUE(after.handed_over);
    EXPECT_LT(pixelDistance(after.camera, before_.camera).rms, 1.0);
    EXPECT_GE(after.queue.segments.size(), 2u);
  }
  std::uint64_t mapId() const { return run_.record.frames.back().map_id; }

  TrackRun run_;
  CalibrationReport before_;
};

TEST_F(InputTest, LossKeepsTheCalibration) {
  const std::uint64_t map_id = mapId();
  run_.runBlind(30);
  EXPECT_EQ(run_.record.count(EventType::kLost), 1);
  EXPECT_EQ(run_.record.frames.back().state, TrackingState::kLost);
  EXPECT_FALSE(run_.record.frames.back().sentence.empty());
  expectCalibrationKept();
  run_.run(30);
  EXPECT_EQ(run_.record.count(EventType::kLost), 1);
  EXPECT_EQ(run_.record.frames.back().state, TrackingState::kTracking);
  EXPECT_NE(mapId(), map_id);
  EXPECT_EQ(run_.record.count(EventType::kRelocalized), 0);  // no map is known again
  run_.run(60);
  expectCalibrationKept();
  // Another loss is another event.
  run_.runBlind(30);
  EXPECT_EQ(run_.record.count(EventType::kLost), 2);
}

TEST_F(InputTest, AShortGapLosesNothing) {
  const std::uint64_t map_id = mapId();
  const auto count = run_.record.frames.size();
  TrackedFrame frame = run_.record.frames.back().tracks;
  for (int i = 0; i < 3; ++i) {
    TrackedFrame empty = frame;
    empty.stamp_ns += 1000 * (i + 1);
    empty.tracks.clear();
    run_.calibrator().processTracks(empty, [] { return std::vector<Track>(); });
  }
  run_.run(10);
  EXPECT_EQ(run_.record.frames.size(), count + 13);
  // A pose that is not known is not published as known.
  for (std::size_t i = count; i < run_.record.frames.size(); ++i) {
    const FrameResult& result = run_.record.frames[i];
    const bool tracking = result.state == TrackingState::kTracking;
    EXPECT_EQ(tracking, i >= count + 3) << "image " << i - count;
    EXPECT_EQ(result.pose_covariance.trace() > 0.0, tracking) << "image " << i - count;
  }
  EXPECT_EQ(run_.record.count(EventType::kLost), 0);
  EXPECT_EQ(run_.record.count(EventType::kRelocalized), 0);
  EXPECT_EQ(mapId(), map_id);
  EXPECT_EQ(run_.record.frames.back().state, TrackingState::kTracking);
}

TEST_F(InputTest, TimeThatJumpsBackBeginsANewMap) {
  const std::uint64_t map_id = mapId();
  const auto segments = run_.report().queue.segments.size();
  run_.seek(5);
  run_.run(5);
  ASSERT_EQ(run_.record.count(EventType::kInput), 1);
  EXPECT_FALSE(run_.record.events.back().sentence.empty());
  EXPECT_NE(mapId(), map_id);
  run_.run(60);
  EXPECT_EQ(run_.record.count(EventType::kInput), 1);
  EXPECT_EQ(run_.record.frames.back().state, TrackingState::kTracking);
  expectCalibrationKept();
  // The same segments a second time are no second witnesses.
  const QueueReport queue = run_.report().queue;
  EXPECT_LE(queue.segments.size(), segments + 1);
  EXPECT_TRUE(segmentsAreDisjoint(queue));
}

TEST_F(InputTest, ImagesOfAnotherSizeAreLeftOutAndSaidOnce) {
  const auto frames = run_.record.frames.size();
  TrackedFrame other = run_.record.frames.back().tracks;
  other.width = 320;
  other.height = 240;
  for (int i = 1; i <= 5; ++i) {
    other.stamp_ns += i;
    run_.calibrator().processTracks(other, [] { return std::vector<Track>(); });
  }
  ASSERT_EQ(run_.record.count(EventType::kInput), 1);
  EXPECT_NE(run_.record.events.back().sentence.find("320 x 240"), std::string::npos);
  EXPECT_EQ(run_.record.frames.size(), frames);
  run_.run(20);
  EXPECT_EQ(run_.record.frames.size(), frames + 20);
  EXPECT_EQ(run_.record.count(EventType::kLost), 0);
  expectCalibrationKept();
}

TEST_F(InputTest, EmptyImagesAreLeftOutAndSaidOnce) {
  const auto frames = run_.record.frames.size();
  for (int i = 0; i < 5; ++i) run_.calibrator().process(ImageView());
  ASSERT_EQ(run_.record.count(EventType::kInput), 1);
  EXPECT_FALSE(run_.record.events.back().sentence.empty());
  run_.run(5);
  EXPECT_EQ(run_.record.frames.size(), frames + 5);
  run_.calibrator().process(ImageView());
  EXPECT_EQ(run_.record.count(EventType::kInput), 2);
  expectCalibrationKept();
}

TEST_F(InputTest, ResetTrackingBeginsANewMap) {
  const std::uint64_t map_id = mapId();
  run_.calibrator().resetTracking();
  run_.run(20);
  EXPECT_NE(mapId(), map_id);
  EXPECT_EQ(run_.record.frames.back().state, TrackingState::kTracking);
  EXPECT_EQ(run_.record.count(EventType::kLost), 0);
  expectCalibrationKept();
}

TEST(Input, AnEmptyFirstImageDoesNotFixTheSize) {
  Record record;
  SelfCalibrator calibrator(optionsFor(CameraModel::kFov), SelfCalibrator::Mode::kInline,
                            record.callbacks());
  calibrator.process(ImageView());
  calibrator.processTracks(TrackedFrame(), [] { return std::vector<Track>(); });
  EXPECT_EQ(record.count(EventType::kInput), 1);
  TrackedFrame frame;
  frame.width = 640;
  frame.height = 480;
  calibrator.processTracks(frame, [] { return std::vector<Track>(); });
  EXPECT_EQ(record.frames.size(), 1u);
  EXPECT_EQ(calibrator.calibration().camera.width(), 640);
}

// An initial calibration is one for its own image size.
TEST(Input, InitialCameraFixesTheSize) {
  Options options = optionsFor(kTruth.model());
  options.initial_camera = kTruth;
  Record record;
  SelfCalibrator calibrator(options, SelfCalibrator::Mode::kInline, record.callbacks());
  TrackedFrame frame;
  frame.width = 320;
  frame.height = 240;
  calibrator.processTracks(frame, [] { return std::vector<Track>(); });
  EXPECT_EQ(record.count(EventType::kInput), 1);
  EXPECT_TRUE(record.frames.empty());
  frame.width = 640;
  frame.height = 480;
  calibrator.processTracks(frame, [] { return std::vector<Track>(); });
  EXPECT_EQ(record.frames.size(), 1u);
  EXPECT_EQ(calibrator.calibration().camera.parameters(), kTruth.parameters());
}

TEST(Input, BeforeTheFirstImageThereIsAReport) {
  SelfCalibrator calibrator(Options(), SelfCalibrator::Mode::kInline, Callbacks());
  const CalibrationReport report = calibrator.calibration();
  EXPECT_EQ(report.state, CalibrationState::kWaitingForMotion);
  EXPECT_FALSE(report.handed_over);
  calibrator.flush();
  EXPECT_EQ(calibrator.droppedImages(), 0);
}

}  // namespace
}  // namespace camera_self_calibration
