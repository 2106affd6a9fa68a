#include "camera_self_calibration/tools/calibrate_rig.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <stdexcept>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/rig/rig_calibrator.h"
#include "camera_self_calibration/rig/rig_keyframes.h"
#include "camera_self_calibration/tools/synchronised_images.h"
#include "rig_trajectory.h"

namespace camera_self_calibration {
namespace {

/// A topic and its compressed form have one name.
std::vector<ImageSource> openTopics(SourceOptions source, const std::vector<std::string>& topics) {
  std::vector<ImageSource> sources;
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

/// One camera of the rig, followed with its intrinsics held.
class Follower {
 public:
  Follower(const Options& options, const Camera& camera) {
    Options held = options;
    held.model = camera.model();
    held.initial_camera = camera;
    held.fix_intrinsics = true;
    Callbacks callbacks;
    callbacks.frame = [this](const FrameResult& result) { result_ = result; };
    calibrator_ = std::make_unique<SelfCalibrator>(held, SelfCalibrator::Mode::kInline, callbacks);
  }

  /// Of an image that is refused: no tracks, no pose.
  const FrameResult& process(const ImageView& image) {
    result_ = FrameResult();
    result_.stamp_ns = image.stamp_ns;
    calibrator_->process(image);
    return result_;
  }

 private:
  FrameResult result_;
  std::unique_ptr<SelfCalibrator> calibrator_;
};

RigView viewOf(const FrameResult& result, const ImageView& image) {
  RigView view;
  view.tracks = result.tracks.tracks;
  view.map_id = result.map_id;
  if (result.state == TrackingState::kTracking) view.world_from_camera = result.world_from_camera;
  view.image = image;
  return view;
}

TimedPose poseOf(const FrameResult& result) {
  TimedPose pose;
  pose.stamp_ns = result.stamp_ns;
  pose.map_id = result.map_id;
  pose.world_from_camera = result.world_from_camera;
  return pose;
}

/// Follows all cameras through the images; the first camera's way goes into `way`.
void follow(const Options& options, const std::function<bool()>& stop, SynchronisedImages* images,
            RigRecording* recording, RigCalibrator* calibrator, std::vector<TimedPose>* way) {
  std::vector<std::unique_ptr<Follower>> followers;
  for (const Recording& camera : recording->cameras) {
    followers.push_back(std::make_unique<Follower>(options, camera.final_report.camera));
  }
  RigKeyframes keyframes;
  while (recording->complete) {
    const auto set = images->next();
    if (!set) break;
    RigFrame frame;
    std::vector<bool> calls;
    for (std::size_t c = 0; c < followers.size(); ++c) {
      const FrameResult& result = followers[c]->process((*set)[c]);
      calls.push_back(result.is_keyframe);
      frame.views.push_back(viewOf(result, (*set)[c]));
      if (c > 0) continue;
      frame.stamp_ns = result.stamp_ns;
      if (result.state == TrackingState::kTracking) way->push_back(poseOf(result));
    }
    calibrator->observe(frame);
    const bool keyframe = keyframes.add(calls);
    if (keyframe && !way->empty() && way->back().stamp_ns == frame.stamp_ns) {
      way->back().is_keyframe = true;
    }
    if (keyframe) calibrator->add(std::move(frame));
    recording->complete = !(stop && stop());
  }
}

/// The joint intrinsics in place of those that the camera found for itself.
void adopt(const RigEstimate& estimate, std::size_t c, double limit_px, CalibrationReport* report) {
  const double alone = report->uncertainty.rms;
  report->camera = estimate.rig.cameras[c];
  report->covariance = estimate.intrinsics_covariance[c];
  report->uncertainty = estimate.uncertainty[c];
  report->sentence = formatted(
      "Jointly with the other cameras of the rig the calibration is good to %.2g px rms "
      "over the image (alone: %.2g px)",
      report->uncertainty.rms, alone);
  if (report->uncertainty.rms > limit_px) report->state = CalibrationState::kConverging;
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

}  // namespace

bool RigRecording::converged() const {
  return estimate.usable && estimate.converged &&
         std::all_of(cameras.begin(), cameras.end(), [](const Recording& camera) {
           return camera.final_report.state == CalibrationState::kConverged;
         });
}

RigRecording calibrateRig(const SourceOptions& source, const std::vector<std::string>& topics,
                          const Options& options, std::optional<double> baseline_m,
                          const std::function<bool()>& stop) {
  RigRecording recording;
  CalibrateExtras extras;
  extras.stop = stop;
  std::vector<Camera> cameras;
  for (ImageSource& images : openTopics(source, topics)) {
    recording.topics.push_back(images.name);
    recording.cameras.push_back(calibrate(&images, options, extras));
    recording.complete = recording.complete && recording.cameras.back().complete;
    cameras.push_back(recording.cameras.back().final_report.camera);
  }
  recording.estimate.sentence = missing(recording);
  if (!recording.estimate.sentence.empty() || !recording.complete) return recording;

  RigOptions rig_options;
  rig_options.baseline_m = baseline_m;
  rig_options.solve.threads = options.solver_threads;
  RigCalibrator calibrator(rig_options, cameras, AcrossImages());
  SynchronisedImages images(openTopics(source, topics));
  std::vector<TimedPose> way;
  follow(options, stop, &images, &recording, &calibrator, &way);
  recording.estimate.sentence = images.problem();
  if (!recording.estimate.sentence.empty() || !recording.complete) return recording;
  recording.estimate = calibrator.estimate();
  if (!recording.estimate.usable) return recording;
  // What is not believed of the rig, as where clocks disagree, replaces nothing.
  for (std::size_t c = 0; recording.estimate.converged && c < cameras.size(); ++c) {
    adopt(recording.estimate, c, options.convergedRms(cameras[c].width()),
          &recording.cameras[c].final_report);
  }
  recording.poses = onRig(way, recording.estimate.poses);
  return recording;
}

}  // namespace camera_self_calibration
