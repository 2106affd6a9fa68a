#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/simulation/feature_tracks.h"
#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/room.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"

namespace camera_self_calibration {

/// Everything that a calibrator said, in order.
struct Record {
  std::vector<FrameResult> frames;
  std::vector<CalibrationReport> reports;
  std::vector<Event> events;
  std::function<void(const KeyframeMessage&)> on_keyframe;  ///< If given, sees them too.

  int count(EventType type) const {
    int found = 0;
    for (const Event& event : events) found += event.type == type;
    return found;
  }
  bool everIn(CalibrationState state) const {
    for (const CalibrationReport& report : reports) {
      if (report.state == state) return true;
    }
    return false;
  }
  Callbacks callbacks() {
    Callbacks result;
    result.frame = [this](const FrameResult& frame) { frames.push_back(frame); };
    result.calibration = [this](const CalibrationReport& r) { reports.push_back(r); };
    result.event = [this](const Event& event) { events.push_back(event); };
    result.keyframe = [this](const KeyframeMessage& message) {
      if (on_keyframe) on_keyframe(message);
    };
    return result;
  }
};

struct TrackRunOptions {
  MotionKind motion = MotionKind::kHandheld;
  double motion_speed = 0.6;
  std::optional<Trajectory> trajectory;  ///< If given, in place of the motion.
  double pixel_sigma = 0.25;
  double outlier_share = 0.0;
  std::uint64_t seed = 1;
  int max_features = 80;
  double rate_hz = 15.0;
  double readout_s = 0.0;       ///< Of a rolling shutter.
  double stamp_jitter_s = 0.0;  ///< Images are stamped so much too early or late, evenly spread.
  double duration_s = 120.0;
  /// If given, where what the lens images at a pixel is seen: a lens outside the models.
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> warp = nullptr;
  /// If given, the camera at a time since the start [s].
  std::function<Camera(double)> lens = nullptr;
  SelfCalibrator::Mode mode = SelfCalibrator::Mode::kInline;
  /// If given, what hears the calibrator, given what records it.
  std::function<Callbacks(const Callbacks& record)> listen = nullptr;
};

/// A calibrator fed with simulated feature tracks: the whole system but the images.
class TrackRun {
 public:
  TrackRun(const Camera& truth, const Options& options, const TrackRunOptions& run)
      : rate_hz_(run.rate_hz),
        stamp_jitter_s_(run.stamp_jitter_s),
        warp_(run.warp),
        jitter_(mixSeed(run.seed, 77)),
        tracks_(makeRoom(RoomOptions()), Lens{truth, std::nullopt, 1.0, run.lens}, motionOf(run),
                tracksOf(run, truth)),
        calibrator_(options, run.mode,
                    run.listen ? run.listen(record.callbacks()) : record.callbacks()) {}

  /// Advances by so many frames.
  void run(int frames) {
    for (int i = 0; i < frames; ++i) step();
  }
  /// Until the calibration is converged; false if it is not after so many frames.
  bool runUntilConverged(int max_frames) {
    for (int i = 0; i < max_frames; ++i) {
      if (calibrator_.calibration().state == CalibrationState::kConverged) return true;
      step();
    }
    return calibrator_.calibration().state == CalibrationState::kConverged;
  }
  void step() {
    const std::int64_t stamp = kStartNs + static_cast<std::int64_t>(1e9 * frame_++ / rate_hz_);
    TrackedFrame frame = tracks_.track(stamp);  // a copy: detect() may be called inside
    frame.stamp_ns += static_cast<std::int64_t>(
        1e9 * (jitter_.uniform(-1.0, 1.0) * stamp_jitter_s_ - clock_back_s_));
    warp(&frame.tracks);
    calibrator_.processTracks(frame, [this] {
      std::vector<Track> detected = tracks_.detect();
      warp(&detected);
      return detected;
    });
  }
  /// As if the lens were covered: frames without tracks.
  void runBlind(int frames) {
    tracks_.reset();
    for (int i = 0; i < frames; ++i) {
      TrackedFrame frame =
          tracks_.track(kStartNs + static_cast<std::int64_t>(1e9 * frame_++ / rate_hz_));
      frame.tracks.clear();
      calibrator_.processTracks(frame, [] { return std::vector<Track>(); });
    }
  }
  /// Camera and clock jump, as where a recording is played again.
  void seek(int frame) { frame_ = frame; }
  /// The clock jumps, the camera goes on.
  void setClockBack(double seconds) { clock_back_s_ += seconds; }

  SelfCalibrator& calibrator() { return calibrator_; }
  CalibrationReport report() const { return calibrator_.calibration(); }
  const FeatureTracks& tracks() const { return tracks_; }

  Record record;

 private:
  static constexpr std::int64_t kStartNs = 1000000000;

  static Trajectory motionOf(const TrackRunOptions& run) {
    if (run.trajectory) return *run.trajectory;
    SyntheticMotionOptions options;
    options.kind = run.motion;
    options.speed = run.motion_speed;
    options.seed = run.seed;
    options.box = makeRoom(RoomOptions()).free_space;
    options.duration_s = run.duration_s;
    return syntheticMotion(options);
  }
  static FeatureTracksOptions tracksOf(const TrackRunOptions& run, const Camera& truth) {
    FeatureTracksOptions options;
    options.seed = run.seed;
    options.max_features = run.max_features;
    options.pixel_sigma = run.pixel_sigma;
    options.outlier_share = run.outlier_share;
    options.start_stamp_ns = kStartNs;
    options.line_delay_s = run.readout_s / (truth.height() - 1);
    return options;
  }

  void warp(std::vector<Track>* tracks) const {
    if (!warp_) return;
    for (Track& track : *tracks) {
      track.pixel = warp_(track.pixel);
      track.reference_pixel = warp_(track.reference_pixel);
    }
  }

  double rate_hz_;
  double stamp_jitter_s_;
  double clock_back_s_ = 0.0;
  std::function<Eigen::Vector2d(const Eigen::Vector2d&)> warp_;
  Random jitter_;
  int frame_ = 0;
  FeatureTracks tracks_;
  SelfCalibrator calibrator_;
};

inline bool segmentsAreDisjoint(const QueueReport& queue) {
  for (const SegmentReport& a : queue.segments) {
    for (const SegmentReport& b : queue.segments) {
      if (&a != &b && a.begin_ns <= b.end_ns && b.begin_ns <= a.end_ns) return false;
    }
  }
  return true;
}

inline Options optionsFor(CameraModel model) {
  Options options;
  options.model = model;
  return options;
}

}  // namespace camera_self_calibration
