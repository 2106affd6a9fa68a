#include "camera_self_calibration/pipeline/options.h"

#include <cmath>
#include <cstdlib>

namespace camera_self_calibration {
namespace {

constexpr double kLongestReadout = 0.1;  // [s]

}  // namespace

double Options::convergedRms(int width) const {
  constexpr double kPixelsPerWidth = 1.0 / 640.0;
  return converged_pixel_rms > 0.0 ? converged_pixel_rms : kPixelsPerWidth * width;
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
  for (const std::string& problem : keyframe.problems()) list.push_back(problem);
  const auto atLeast = [&list](const char* name, int value, int low) {
    if (value >= low) return;
    list.push_back(std::string(name) + " is " + std::to_string(value) + ", it must be at least " +
                   std::to_string(low));
  };
  atLeast("sliding_window_keyframes", sliding_window_keyframes, 3);
  atLeast("segment_keyframes", segment_keyframes, 5);
  atLeast("queue_segments", queue_segments, 2);
  atLeast("startup_keyframes", startup_keyframes, segment_keyframes);
  atLeast("relocalization_keyframes", relocalization_keyframes, 0);
  atLeast("solver_threads", solver_threads, 1);
  atLeast("max_queued_images", max_queued_images, 1);
  if (!(alpha > 0.0 && alpha < 1.0)) {
    list.push_back("alpha is " + std::to_string(alpha) + ", it must lie between 0 and 1");
  }
  if (!(converged_pixel_rms >= 0.0) || std::isinf(converged_pixel_rms)) {
    list.push_back("converged_pixel_rms is " + std::to_string(converged_pixel_rms) +
                   ", it must be positive, or 0 for 1 px per 640 px of width");
  }
  if (!(false_alarms_per_hour >= 0.0 && false_alarms_per_hour <= 60.0)) {
    list.push_back("false_alarms_per_hour is " + std::to_string(false_alarms_per_hour) +
                   ", it must lie between 0 (the lens is never said to have changed) and 60");
  }
  if (!(std::abs(readout_s) <= kLongestReadout)) {
    list.push_back("readout_s is " + std::to_string(readout_s) +
                   ", it must lie between -0.1 and 0.1 seconds for the whole image");
  }
  if (std::isnan(handover_entropy)) {
    list.push_back("handover_entropy is not a number; -infinity turns it off");
  }
  if (initial_camera && (!initial_camera->valid() || initial_camera->model() != model ||
                         initial_camera->width() <= 0 || initial_camera->height() <= 0)) {
    list.push_back("initial_camera must be a valid camera of the model " + toString(model) +
                   " with its image size");
  }
  if (fix_intrinsics && !initial_camera) {
    list.push_back("fix_intrinsics needs initial_camera, the intrinsics to hold");
  }
  return list;
}

}  // namespace camera_self_calibration
