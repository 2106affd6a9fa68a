#include "camera_self_calibration/tools/calibrate_rig.h"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/rig/rig_self_calibrator.h"
#include "camera_self_calibration/ros/input_monitor.h"
#include "rig_trajectory.h"

namespace camera_self_calibration {
namespace {

/// A topic and its compressed form have one name.
std::vector<ImageSource> openTopics(SourceOptions source, const std::vector<std::string>& topics) {
  std::vector<ImageSource> sources;
  source.together = topics;
  for (const std::string& topic : topics) {
    source.topic = topic;
    sources.push_back(openImages(source));
    const auto same = [&](const ImageSource& other) { return other.name == sources.back().name; };
    if (!std::any_of(sources.begin(), sources.end() - 1, same)) continue;
    throw std::runtime_error("--topics names " + sources.back().name +
                             " twice; give one topic of each camera");
  }
  return sources;
}

TimedPose poseOf(const FrameResult& result) {
  TimedPose pose;
  pose.stamp_ns = result.stamp_ns;
  pose.map_id = result.map_id;
  pose.world_from_camera = result.world_from_camera;
  return pose;
}

/// The images of all cameras, as they came.
class ImagesInOrder {
 public:
  explicit ImagesInOrder(std::vector<ImageSource> sources)
      : sources_(std::move(sources)), monitors_(sources_.size()), waiting_(sources_.size()) {
    for (InputMonitor& monitor : monitors_) monitor.takeZeroAsTime();
  }

  /// The next one and its camera. Images that cannot be read, those of another size or from before
  /// the last one are left out.
  std::optional<std::pair<int, ImageView>> next() {
    int earliest = -1;
    for (std::size_t c = 0; c < sources_.size(); ++c) {
      if (!load(c)) continue;
      if (earliest < 0 || waiting_[c]->stamp_ns < waiting_[earliest]->stamp_ns) {
        earliest = static_cast<int>(c);
      }
    }
    if (earliest < 0) return std::nullopt;
    return std::make_pair(earliest, *std::exchange(waiting_[earliest], std::nullopt));
  }

 private:
  bool load(std::size_t camera) {
    while (!waiting_[camera]) {
      const std::optional<GrayImage> image = sources_[camera].next();
      if (!image) return false;
      if (monitors_[camera].check(*image) == InputVerdict::kUse) waiting_[camera] = image->view;
    }
    return true;
  }

  std::vector<ImageSource> sources_;
  std::vector<InputMonitor> monitors_;  // one for each source
  std::vector<std::optional<ImageView>> waiting_;
};

/// Follows all cameras through the images with their intrinsics held, and solves for the rig; the
/// first camera's way goes into `way`.
RigReport follow(const RigOptions& rig, const Options& options, const std::function<bool()>& stop,
                 std::vector<ImageSource> sources, RigRecording* recording,
                 std::vector<TimedPose>* way) {
  std::vector<Options> held;
  for (const Recording& camera : recording->cameras) {
    held.push_back(options.withHeld(camera.final_report.camera));
  }
  RigCallbacks callbacks;
  callbacks.frame = [way](int camera, const FrameResult& result) {
    if (camera == 0 && result.state == TrackingState::kTracking) way->push_back(poseOf(result));
  };
  RigSelfCalibrator calibrator(rig, held, SelfCalibrator::Mode::kInline, callbacks);
  ImagesInOrder images(std::move(sources));
  while (recording->complete) {
    const auto next = images.next();
    if (!next) break;
    calibrator.process(next->first, next->second);
    recording->complete = !(stop && stop());
  }
  return recording->complete ? calibrator.solve() : calibrator.report();
}

/// Why nothing can be said of the rig; empty where it can.
std::string missing(const RigRecording& recording) {
  for (std::size_t c = 0; c < recording.cameras.size(); ++c) {
    const CalibrationReport& report = recording.cameras[c].final_report;
    if (recording.cameras[c].frames == 0) {
      return formatted("camera %zu (%s) has no images", c, recording.topics[c].c_str());
    }
    if (!report.handed_over) {
      return formatted("camera %zu (%s) does not know its lens: %s", c, recording.topics[c].c_str(),
                       report.sentence.c_str());
    }
  }
  return {};
}

/// Each camera by itself.
RigRecording eachCamera(const SourceOptions& source, const std::vector<std::string>& topics,
                        const Options& options, const RigExtras& extras) {
  RigRecording recording;
  CalibrateExtras own;
  own.stop = extras.stop;
  own.example = extras.example;
  own.audit = extras.audit;
  for (ImageSource& images : openTopics(source, topics)) {
    if (extras.audited) own.audited = extras.audited->cameras[recording.topics.size()];
    recording.topics.push_back(images.name);
    recording.cameras.push_back(calibrate(&images, options, own));
    recording.complete = recording.complete && recording.cameras.back().complete;
  }
  return recording;
}

/// All of them, with the intrinsics that each has found.
void together(const SourceOptions& source, const std::vector<std::string>& topics,
              const Options& options, const RigExtras& extras, RigRecording* recording) {
  RigOptions rig_options;
  rig_options.baseline_m = extras.baseline_m;
  rig_options.false_alarms_per_hour = options.false_alarms_per_hour;
  rig_options.converged_pixel_rms = options.converged_pixel_rms;
  rig_options.solve.threads = options.solver_threads;
  std::vector<TimedPose> way;
  const RigReport report =
      follow(rig_options, options, extras.stop, openTopics(source, topics), recording, &way);
  if (!recording->complete) return;
  recording->estimate = withVerdict(report);
  recording->mount_changes = report.mount_changes;
  if (!recording->estimate.usable) return;
  // What is not believed of the rig, as where clocks disagree, replaces nothing. A lens that was
  // good enough once may be so again jointly, hence not atTheEnd() of its own video.
  for (std::size_t c = 0; recording->estimate.converged && c < recording->cameras.size(); ++c) {
    const CalibrationReport& own = recording->cameras[c].reports.back();
    recording->cameras[c].final_report = withJointIntrinsics(
        own, recording->estimate, static_cast<int>(c), options.convergedRms(own.camera));
  }
  recording->poses = onRig(way, recording->estimate.poses);
}

void auditInto(const RigExtras& extras, RigRecording* recording) {
  std::vector<AuditReport> lenses;
  for (std::size_t c = 0; c < recording->cameras.size(); ++c) {
    const Recording& camera = recording->cameras[c];
    lenses.push_back(camera.audit.value_or(
        audit(extras.audited->cameras[c], camera.final_report, extras.audit)));
  }
  recording->audited = extras.audited;
  recording->audit =
      auditRig(std::move(lenses), recording->estimate, *extras.audited, extras.audit);
}

}  // namespace

bool RigRecording::converged() const {
  return estimate.usable && estimate.converged &&
         std::all_of(cameras.begin(), cameras.end(), [](const Recording& camera) {
           return camera.final_report.state == CalibrationState::kConverged;
         });
}

CalibrationState RigRecording::state() const {
  return converged()       ? CalibrationState::kConverged
         : estimate.usable ? CalibrationState::kConverging
                           : CalibrationState::kInitializing;
}

RigRecording calibrateRig(const SourceOptions& source, const std::vector<std::string>& topics,
                          const Options& options, const RigExtras& extras) {
  RigRecording recording = eachCamera(source, topics, options, extras);
  recording.estimate.sentence = missing(recording);
  if (recording.estimate.sentence.empty() && recording.complete) {
    together(source, topics, options, extras, &recording);
  }
  if (extras.audited) auditInto(extras, &recording);
  return recording;
}

}  // namespace camera_self_calibration
