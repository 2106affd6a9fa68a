#include "camera_self_calibration/ros/input_monitor.h"

#include <utility>

#include "camera_self_calibration/ros/stamps.h"

namespace camera_self_calibration {
namespace {

// Images that overtake each other are closer than this; a bag that starts again is not.
constexpr std::int64_t kJumpNs = 500000000;

std::string sizeText(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace

InputVerdict InputMonitor::reject(std::string problem) {
  ++counts_.rejected;
  counts_.last_problem = std::move(problem);
  return InputVerdict::kReject;
}

InputVerdict InputMonitor::check(const GrayImage& image) {
  if (!image.view) return reject(image.error);
  const ImageView& view = *image.view;
  if (counts_.used == 0) {
    width_ = view.width;
    height_ = view.height;
  } else if (view.width != width_ || view.height != height_) {
    return reject("the image size changed from " + sizeText(width_, height_) + " to " +
                  sizeText(view.width, view.height) +
                  "; set the camera back, or start anew to calibrate the new size");
  }
  const std::int64_t step_ns = view.stamp_ns - last_stamp_ns_;
  const bool first = counts_.used == 0;
  if (!first && step_ns <= 0 && step_ns > -kJumpNs) {
    return reject("an image is not later than the one before it");
  }
  last_stamp_ns_ = view.stamp_ns;
  ++counts_.used;
  if (first || step_ns > 0) return InputVerdict::kUse;
  ++counts_.jumps;
  counts_.last_problem = "the clock jumped back by " + std::to_string(-toSeconds(step_ns)) +
                         " s; tracking begins anew, the calibration is kept";
  return InputVerdict::kRestart;
}

}  // namespace camera_self_calibration
