#pragma once

#include <cstdint>
#include <string>

#include "camera_self_calibration/ros/gray_image.h"

namespace camera_self_calibration {

/// What to do with an image.
enum class InputVerdict {
  kUse,
  kRestart,  ///< The clock jumped back: use it, but as the first of a new stretch.
  kReject
};

struct InputCounts {
  std::int64_t used = 0;
  std::int64_t rejected = 0;
  std::int64_t jumps = 0;  ///< Of the clock, backwards.
  std::string last_problem;
};

/// Lets through what the pipeline can take: readable images of one size with growing stamps.
class InputMonitor {
 public:
  /// After anything but kUse, counts().last_problem says in plain words what is the matter.
  InputVerdict check(const GrayImage& image);

  const InputCounts& counts() const { return counts_; }
  int width() const { return width_; }    ///< Of the first image [px]; 0 before.
  int height() const { return height_; }  ///< Of the first image [px]; 0 before.

 private:
  InputVerdict reject(std::string problem);

  InputCounts counts_;
  std::int64_t last_stamp_ns_ = 0;
  int width_ = 0;
  int height_ = 0;
};

}  // namespace camera_self_calibration
