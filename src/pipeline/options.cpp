#include "camera_self_calibration/pipeline/options.h"

#include <cmath>
#include <cstdlib>

#include "camera_self_calibration/camera/plausibility.h"

namespace camera_self_calibration {
namespace {

constexpr double kLongestReadout = 0.1;  // [s]
// Far beyond what is of use, and within what memory and system stand.
constexpr int kMostKeyframes = 1000;
constexpr int kMostSegments = 1000;
constexpr int kMostPlaces = 100000;
constexpr int kMostThreads = 256;
constexpr int kMostQueuedImages = 1000;

}  // namespace

CameraModel Options::firstModel() const {
  return model.value_or(initial_camera ? initial_camera->model() : CameraModel::kPinhole);
}

Options Options::withHeld(const Camera& camera) const {
  Options held = *this;
  held.model = camera.model();
  held.initial_camera = camera;
  held.fix_intrinsics = true;
  return held;
}

double convergedRms(double asked_px, const Camera& camera) {
  constexpr double kPixelsPerSide = 1.0 / 640.0;
  return asked_px > 0.0 ? asked_px : kPixelsPerSide * camera.longerSide();
}

double Options::convergedRms(const Camera& camera) const {
  return camera_self_calibration::convergedRms(converged_pixel_rms, camera);
}

bool setRollingShutter(const std::string& text, Options* options) {
  double readout_s = 0.0;
  const bool estimated = text == "auto";
  if (!estimated && text != "off") {
    const char* begin = text.c_str();
    char* end = nullptr;
    readout_s = std::strtod(begin, &end);
    if (end == begin || *end != '\0') return false;
  }
  options->estimate_readout = estimated;
  options->readout_s = readout_s;
  return true;
}

std::vector<std::string> Options::problems() const {
  std::vector<std::string> list = tracker.problems();
  for (const std::string& problem : keyframe.problems()) list.push_back("keyframe_" + problem);
  const auto within = [&list](const char* name, int value, int low, int high) {
    if (value >= low && value <= high) return;
    list.push_back(std::string(name) + " is " + std::to_string(value) + ", it must lie between " +
                   std::to_string(low) + " and " + std::to_string(high));
  };
  within("sliding_window_keyframes", sliding_window_keyframes, 3, kMostKeyframes);
  within("segment_keyframes", segment_keyframes, 5, kMostKeyframes);
  within("queue_segments", queue_segments, 2, kMostSegments);
  within("startup_keyframes", startup_keyframes, segment_keyframes, kMostKeyframes);
  within("relocalization_keyframes", relocalization_keyframes, 0, kMostPlaces);
  within("solver_threads", solver_threads, 1, kMostThreads);
  within("max_queued_images", max_queued_images, 1, kMostQueuedImages);
  if (!(alpha > 0.0 && alpha < 1.0)) {
    list.push_back("alpha is " + std::to_string(alpha) + ", it must lie between 0 and 1");
  }
  if (!(converged_pixel_rms >= 0.0) || std::isinf(converged_pixel_rms)) {
    list.push_back("converged_pixel_rms is " + std::to_string(converged_pixel_rms) +
                   ", it must be positive, or 0 for 1 px per 640 px of the longer side");
  }
  if (!(false_alarms_per_hour >= 0.0 && false_alarms_per_hour <= 60.0)) {
    list.push_back("false_alarms_per_hour is " + std::to_string(false_alarms_per_hour) +
                   ", it must lie between 0 (the lens is never said to have changed) and 60");
  }
  if (!(std::abs(readout_s) <= kLongestReadout)) {
    list.push_back("rolling_shutter is " + std::to_string(readout_s) +
                   ", it must lie between -0.1 and 0.1 seconds for the whole image");
  }
  if (std::isnan(handover_entropy)) {
    list.push_back("handover_entropy is not a number; -infinity turns it off");
  }
  if (initial_camera && (!initial_camera->valid() || initial_camera->model() != firstModel() ||
                         initial_camera->width() <= 0 || initial_camera->height() <= 0)) {
    list.push_back("the initial intrinsics are no valid ones of the model " +
                   toString(firstModel()) + ", or lack their image size");
  } else if (initial_camera) {
    const std::string problem = implausibility(*initial_camera);
    if (!problem.empty()) list.push_back("the initial intrinsics cannot be right: " + problem);
  }
  if (fix_intrinsics && !initial_camera) {
    list.push_back("fix_intrinsics needs initial intrinsics, those to hold");
  }
  return list;
}

}  // namespace camera_self_calibration
