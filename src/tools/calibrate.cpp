#include "camera_self_calibration/tools/calibrate.h"

#include <iostream>
#include <stdexcept>

#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/ros/input_monitor.h"
#include "camera_self_calibration/tools/progress.h"

namespace camera_self_calibration {
namespace {

std::string sizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

/// Says the first few problems with images only.
void warn(const InputCounts& counts) {
  constexpr std::int64_t kMessages = 5;
  const std::int64_t number = counts.rejected + counts.jumps;
  if (number <= kMessages) std::cerr << "warning: " << counts.last_problem << '\n';
  if (number == kMessages) std::cerr << "warning: no further images will be named\n";
}

void conclude(const InputCounts& counts) {
  if (counts.used == 0 && counts.rejected > 0) {
    throw std::runtime_error("none of the " + std::to_string(counts.rejected) +
                             " images can be used: " + counts.last_problem);
  }
  if (counts.rejected > 0) std::cerr << "warning: " << counts.rejected << " images left out\n";
}

Callbacks recordInto(Recording* recording) {
  Callbacks callbacks;
  callbacks.frame = [recording](const FrameResult& result) {
    ++recording->frames;
    if (result.is_keyframe) ++recording->keyframes;
    if (result.state != TrackingState::kTracking) return;
    recording->poses.push_back(
        {result.stamp_ns, result.map_id, result.is_keyframe, result.world_from_camera});
  };
  callbacks.calibration = [recording](const CalibrationReport& report) {
    recording->reports.push_back(report);
  };
  callbacks.event = [recording](const Event& event) { recording->events.push_back(event); };
  return callbacks;
}

void checkInitialSize(const Options& options, const ImageView& first) {
  if (!options.initial_camera) return;
  const Camera& initial = *options.initial_camera;
  if (initial.width() == first.width && initial.height() == first.height) return;
  throw std::runtime_error("the start values are for images of " +
                           sizeText(initial.width(), initial.height()) + ", these have " +
                           sizeText(first.width, first.height));
}

}  // namespace

Recording calibrate(ImageSource* source, const Options& options) {
  Recording recording;
  SelfCalibrator calibrator(options, SelfCalibrator::Mode::kInline, recordInto(&recording));
  Progress progress(source->count);
  InputMonitor monitor;
  while (const std::optional<GrayImage> image = source->next()) {
    progress.advance();
    const InputVerdict verdict = monitor.check(*image);
    if (verdict != InputVerdict::kUse) warn(monitor.counts());
    if (verdict == InputVerdict::kReject) continue;
    if (recording.frames == 0) checkInitialSize(options, *image->view);
    calibrator.process(*image->view);
    if (!recording.reports.empty()) progress.show(recording.reports.back());
  }
  calibrator.flush();
  conclude(monitor.counts());
  recording.processing_seconds = progress.elapsedSeconds();
  recording.final_report = calibrator.calibration();
  if (recording.frames > 0) progress.show(recording.final_report, true);
  progress.finish();
  return recording;
}

}  // namespace camera_self_calibration
