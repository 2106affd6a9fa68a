#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/reference/trajectory_comparison.h"
#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/renderer.h"
#include "camera_self_calibration/simulation/simulated_sequence.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {

/// A calibrator, inline, fed with images as a script wants them: rendered along segments of a
/// motion, forth or back, in one world or another, or dark. The truth is kept beside.
class ImageRun {
 public:
  ImageRun(const Options& options, double rate_hz)
      : rate_hz_(rate_hz),
        calibrator_(options, SelfCalibrator::Mode::kInline, record.callbacks()) {}

  using Edit = std::function<cv::Mat(const cv::Mat& image, double time_s)>;

  /// The motion from one of its times to another [s], at its own speed; back if `to_s` is less.
  /// `edit` may change each image; `world` tells worlds apart in the truth.
  void play(const Renderer& renderer, const Trajectory& motion, double from_s, double to_s,
            const Edit& edit = nullptr, std::uint64_t world = 0) {
    const int frames = static_cast<int>(std::lround(std::abs(to_s - from_s) * rate_hz_));
    for (int i = 0; i < frames; ++i) {
      const double time = from_s + (to_s - from_s) * i / frames;
      cv::Mat image = renderer.render(motion, time, static_cast<std::uint64_t>(frame_));
      truth.push_back({stampNs(), world, motion.worldFromCamera(time)});
      show(edit ? edit(image, now()) : image);
    }
  }

  /// As if the lens were covered: dark, with the noise of a sensor at high gain.
  void dark(double duration_s, int width, int height, double noise = 3.0) {
    Random random(static_cast<std::uint64_t>(frame_));
    const int frames = static_cast<int>(std::lround(duration_s * rate_hz_));
    for (int i = 0; i < frames; ++i) {
      cv::Mat image(height, width, CV_8UC1);
      for (int p = 0; p < width * height; ++p) {
        image.data[p] = cv::saturate_cast<std::uint8_t>(6.0 + noise * random.normal());
      }
      show(image);
    }
  }

  void show(const cv::Mat& image) {
    SimulatedFrame frame;
    frame.image = image;
    frame.stamp_ns = stampNs();
    ++frame_;
    calibrator_.process(frame.view());
  }

  double now() const { return frame_ / rate_hz_; }  ///< Since the start [s].
  CalibrationReport report() const { return calibrator_.calibration(); }
  SelfCalibrator& calibrator() { return calibrator_; }
  const FrameResult& last() const { return record.frames.back(); }

  /// How far the tracked poses of a map since a time are from the truth, after one similarity.
  std::optional<TrajectoryDifference> difference(double since_s, std::uint64_t map_id) const {
    std::vector<StampedCameraPose> poses;
    for (const FrameResult& frame : record.frames) {
      if (timeOf(frame.stamp_ns) < since_s || frame.state != TrackingState::kTracking) continue;
      if (frame.map_id == map_id) poses.push_back({frame.stamp_ns, 0, frame.world_from_camera});
    }
    return compareTrajectories(poses, truth);
  }

  /// When an event was raised last [s since the start]; not a number if it was not.
  double lastEvent(EventType type) const {
    double time = NAN;
    for (const Event& event : record.events) {
      if (event.type == type) time = timeOf(event.stamp_ns);
    }
    return time;
  }

  /// Seconds from a time until the camera is tracked for good.
  double blindAfter(double time_s) const {
    double blind = 0.0;
    for (const FrameResult& frame : record.frames) {
      if (frame.state == TrackingState::kTracking) continue;
      blind = std::max(blind, timeOf(frame.stamp_ns) - time_s);
    }
    return blind;
  }

  Record record;
  std::vector<StampedCameraPose> truth;

 private:
  static constexpr std::int64_t kStartNs = 1000000000;
  static double timeOf(std::int64_t stamp_ns) { return toSeconds(stamp_ns - kStartNs); }
  std::int64_t stampNs() const { return kStartNs + static_cast<std::int64_t>(1e9 * now()); }

  double rate_hz_;
  int frame_ = 0;
  SelfCalibrator calibrator_;
};

}  // namespace camera_self_calibration
