#include "camera_self_calibration/ros/input_monitor.h"

#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/ros/mask_file.h"
#include "camera_self_calibration/ros/stamps.h"

namespace camera_self_calibration {
namespace {

// Images that overtake each other are closer than this; a bag that starts again is not.
constexpr std::int64_t kJumpNs = 500000000;

std::string secondsText(std::int64_t nanoseconds) {
  return formatted("%.1f s", toSeconds(nanoseconds));
}

}  // namespace

InputVerdict InputMonitor::reject(std::string problem) {
  ++counts_.rejected;
  counts_.last_problem = std::move(problem);
  return InputVerdict::kReject;
}

std::string InputMonitor::takeNotice() { return std::exchange(notice_, {}); }

InputVerdict InputMonitor::check(const GrayImage& image) {
  if (!image.view) return reject(image.error);
  if (image.view->stamp_ns < first_time_ns_) {
    return reject("the images carry no time (header.stamp is 0); the driver has to stamp them");
  }
  const std::string misfit = mask_ ? maskMisfit(*mask_, image.view->width, image.view->height) : "";
  if (!misfit.empty()) return reject(misfit);
  // First, since a new size is told with one image, which must not be left out.
  const std::string late = lateness(image.view->stamp_ns);
  if (!late.empty()) return reject(late);
  const InputVerdict size = checkSize(*image.view);
  if (size == InputVerdict::kReject) return size;
  const InputVerdict time = takeTime(image.view->stamp_ns);
  ++counts_.used;
  return size == InputVerdict::kNewSize ? size : time;
}

InputVerdict InputMonitor::checkSize(const ImageView& view) {
  const bool first = width_ == 0;
  if (first || (view.width == width_ && view.height == height_)) {
    width_ = view.width;
    height_ = view.height;
    new_size_images_ = 0;
    return InputVerdict::kUse;
  }
  const bool again = view.width == new_width_ && view.height == new_height_;
  new_size_images_ = again ? new_size_images_ + 1 : 1;
  new_width_ = view.width;
  new_height_ = view.height;
  const std::string change = "the image size changed from " + sizeText(width_, height_) + " to " +
                             sizeText(view.width, view.height);
  if (keeps_size_) return refuseNewSize(change);
  if (new_size_images_ < kSizePatience) {
    return reject(change + "; if it stays so, the calibration goes over to the new size");
  }
  counts_.last_problem = change;
  ++counts_.size_changes;
  width_ = view.width;
  height_ = view.height;
  new_size_images_ = 0;
  return InputVerdict::kNewSize;
}

InputVerdict InputMonitor::refuseNewSize(const std::string& change) {
  const std::string refusal =
      change + "; such images are left out: restart the node to calibrate the new size";
  if (new_size_images_ == kSizePatience) notice_ = refusal;
  return reject(refusal);
}

std::string InputMonitor::lateness(std::int64_t stamp_ns) const {
  const std::int64_t step_ns = stamp_ns - last_stamp_ns_;
  if (counts_.used == 0 || step_ns > 0 || step_ns <= -kJumpNs) return "";
  return "an image is not later than the one before it (the stamps differ by " +
         std::to_string(step_ns / 1000000) + " ms)";
}

InputVerdict InputMonitor::takeTime(std::int64_t stamp_ns) {
  const bool first = counts_.used == 0;
  const std::int64_t step_ns = stamp_ns - last_stamp_ns_;
  last_stamp_ns_ = stamp_ns;
  if (first) return InputVerdict::kUse;
  if (step_ns < 0) {
    ++counts_.jumps;
    clock_.clear();
    counts_.last_problem = "the clock jumped back by " + secondsText(-step_ns) +
                           "; a new map begins, and the calibration is kept";
    return InputVerdict::kRestart;
  }
  const FrameClock::Step step = clock_.add(step_ns);
  counts_.missed += step.missed;
  counts_.rate_hz = clock_.rate();
  if (step.gap) {
    ++counts_.gaps;
    notice_ = "no image came for " + secondsText(step_ns) + "; tracking goes on if it can";
  }
  return InputVerdict::kUse;
}

}  // namespace camera_self_calibration
