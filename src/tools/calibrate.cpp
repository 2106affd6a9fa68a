#include "camera_self_calibration/tools/calibrate.h"

#include <iostream>
#include <memory>
#include <stdexcept>

#include "camera_self_calibration/audit/audit_history.h"
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

void addPose(const FrameResult& result, std::vector<TimedPose>* poses) {
  if (result.state != TrackingState::kTracking) return;
  TimedPose pose;
  pose.stamp_ns = result.stamp_ns;
  pose.map_id = result.map_id;
  pose.world_from_camera = result.world_from_camera;
  pose.is_keyframe = result.is_keyframe;
  poses->push_back(pose);
}

std::optional<GrayImage> nextImage(ImageSource* source, const CalibrateExtras& extras,
                                   Recording* recording) {
  recording->complete = !(extras.stop && extras.stop());
  return recording->complete ? source->next() : std::nullopt;
}

/// A run calibrates one size: the image, or why it is left out. `width` of 0: it is the first.
GrayImage ofSize(const GrayImage& image, int width, int height) {
  if (!image.view || width == 0 || (image.view->width == width && image.view->height == height)) {
    return image;
  }
  return {std::nullopt, "images of " + sizeText(image.view->width, image.view->height) +
                            " are left out, since those before have " + sizeText(width, height) +
                            "; to calibrate them, begin with them (--start)"};
}

Callbacks recordInto(Recording* recording) {
  Callbacks callbacks;
  callbacks.frame = [recording](const FrameResult& result) {
    if (recording->frames++ == 0) recording->begin_ns = result.stamp_ns;
    recording->end_ns = result.stamp_ns;
    if (result.is_keyframe) ++recording->keyframes;
    recording->carried += static_cast<std::int64_t>(result.tracks.carried.size());
    addPose(result, &recording->poses);
  };
  callbacks.calibration = [recording](const CalibrationReport& report) {
    recording->reports.push_back(report);
  };
  callbacks.event = [recording](const Event& event) { recording->events.push_back(event); };
  return callbacks;
}

/// Lets `finder` see every image with its tracks.
void findExample(ExampleFinder* finder, const ImageView** image, const Recording& recording,
                 Callbacks* callbacks) {
  const auto record = callbacks->frame;
  callbacks->frame = [=, &recording](const FrameResult& result) {
    record(result);
    const bool any = !recording.reports.empty();
    finder->add(**image, result, any ? recording.reports.back().epoch : 0);
  };
}

/// Audits at each new estimate, so that a calibration that ceases to be right is dated.
void auditInto(const AuditOptions& options, AuditHistory* history, Recording* recording,
               Callbacks* callbacks) {
  const auto record = callbacks->calibration;
  callbacks->calibration = [=](const CalibrationReport& report) {
    const bool news =
        recording->reports.empty() || report.revision != recording->reports.back().revision;
    record(report);
    if (recording->audit && !news) return;
    recording->audit = audit(*recording->audited, report, options);
    history->date(report, &*recording->audit);
  };
}

/// Lets a batch watch what the recording hears.
void watch(const Options& options, BatchComparer* batch, const ImageView** image,
           Callbacks* callbacks) {
  callbacks->keyframe = [options, batch, image](const KeyframeMessage& message) {
    const Camera first =
        options.initial_camera
            ? *options.initial_camera
            : Camera::defaultGuess(options.firstModel(), (*image)->width, (*image)->height);
    batch->add(message, first);
  };
  const auto record = callbacks->calibration;
  callbacks->calibration = [record, batch](const CalibrationReport& report) {
    record(report);
    batch->add(report);
  };
}

/// The second run, with the intrinsics held.
std::unique_ptr<SelfCalibrator> heldRun(const Options& options, const Camera& reference,
                                        Recording* recording) {
  Callbacks callbacks;
  callbacks.frame = [recording](const FrameResult& result) {
    addPose(result, &recording->reference_poses);
  };
  return std::make_unique<SelfCalibrator>(options.withHeld(reference),
                                          SelfCalibrator::Mode::kPipelined, callbacks);
}

void checkSize(const std::optional<Camera>& camera, const char* what, const ImageView& first) {
  if (!camera || (camera->width() == first.width && camera->height() == first.height)) return;
  throw std::runtime_error(std::string(what) + " for images of " +
                           sizeText(camera->width(), camera->height()) + ", these have " +
                           sizeText(first.width, first.height));
}

}  // namespace

CalibrationReport atTheEnd(CalibrationReport report) {
  if (!report.afresh) return report;
  report.state = report.afresh->state;
  report.sentence = report.afresh->sentence;
  report.hint = report.afresh->hint;
  report.afresh.reset();
  return report;
}

Recording calibrate(ImageSource* source, const Options& options, const CalibrateExtras& extras) {
  Recording recording;
  recording.reference = extras.reference;
  recording.audited = extras.audited;
  BatchComparer batch(options);
  const ImageView* view = nullptr;
  AuditHistory history;
  Callbacks callbacks = recordInto(&recording);
  if (extras.audited) auditInto(extras.audit, &history, &recording, &callbacks);
  if (extras.batch) watch(options, &batch, &view, &callbacks);
  ExampleFinder example;
  if (extras.example) findExample(&example, &view, recording, &callbacks);
  SelfCalibrator calibrator(options, SelfCalibrator::Mode::kPipelined, callbacks);
  std::unique_ptr<SelfCalibrator> held;
  if (extras.reference) held = heldRun(options, *extras.reference, &recording);
  Progress progress(source->count);
  InputMonitor monitor;
  monitor.takeZeroAsTime();
  if (options.tracker.mask) monitor.setMask(*options.tracker.mask);
  while (const std::optional<GrayImage> image = nextImage(source, extras, &recording)) {
    progress.advance();
    const InputVerdict verdict = monitor.check(ofSize(*image, monitor.width(), monitor.height()));
    if (verdict != InputVerdict::kUse) warn(monitor.counts());
    if (verdict == InputVerdict::kReject) continue;
    if (recording.frames == 0) {
      checkSize(options.initial_camera, "the start values are", *image->view);
      checkSize(extras.reference, "the reference calibration is", *image->view);
    }
    view = &*image->view;
    calibrator.process(*image->view);
    if (held) held->process(*image->view);
    if (!recording.reports.empty()) progress.show(recording.reports.back());
  }
  calibrator.flush();
  conclude(monitor.counts());
  recording.processing_seconds = progress.elapsedSeconds();
  recording.final_report = atTheEnd(calibrator.calibration());
  recording.learnt = calibrator.state();
  if (extras.audited && recording.frames > 0 && !recording.audit) {  // there was no keyframe
    recording.audit = audit(*extras.audited, recording.final_report, extras.audit);
  }
  if (!example.found().gray.empty()) recording.example = example.found();
  if (extras.batch && recording.complete) recording.batch = batch.finish();
  if (recording.frames > 0) progress.show(recording.final_report, true);
  progress.finish();
  return recording;
}

}  // namespace camera_self_calibration
