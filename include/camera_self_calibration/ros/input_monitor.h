#pragma once

#include <cstdint>
#include <string>

#include "camera_self_calibration/base/frame_clock.h"
#include "camera_self_calibration/ros/gray_image.h"

namespace camera_self_calibration {

/// What to do with an image.
enum class InputVerdict {
  kUse,
  kRestart,  ///< The clock jumped back: use it, but as the first of a new sequence.
  kNewSize,  ///< The images have another size, for good: use it, with a calibration for that size.
  kReject
};

struct InputCounts {
  std::int64_t used = 0;
  std::int64_t rejected = 0;
  std::int64_t jumps = 0;   ///< Of the clock, backwards.
  std::int64_t missed = 0;  ///< Images that did not arrive, by the time between those that did.
  std::int64_t gaps = 0;    ///< Times that no image came for more than a second.
  std::int64_t size_changes = 0;
  double rate_hz = 0.0;  ///< Of the images that arrive; 0 until it is known.
  std::string last_problem;
};

/// Lets through what the pipeline can take: readable images of one size with growing stamps.
class InputMonitor {
 public:
  /// Images of a new size in a row after which it is believed: two cameras on one topic, or a
  /// single damaged image, do not end a calibration.
  static constexpr int kSizePatience = 5;

  /// In ROS a stamp of 0 is none, but the time of a video begins there.
  void takeZeroAsTime() { first_time_ns_ = 0; }

  /// What the images feed cannot take another size: only images of the first one are let through,
  /// and kNewSize does not come.
  void keepSize() { keeps_size_ = true; }

  /// Images that the mask does not fit are rejected.
  void setMask(const ImageView& mask) { mask_ = mask; }

  /// After anything but kUse, counts().last_problem says in plain words what is the matter.
  InputVerdict check(const GrayImage& image);

  /// What happened to the input since the last call, worth an event; empty if nothing did.
  std::string takeNotice();

  const InputCounts& counts() const { return counts_; }
  int width() const { return width_; }    ///< Of the images let through [px]; 0 before.
  int height() const { return height_; }  ///< Of the images let through [px]; 0 before.

 private:
  InputVerdict reject(std::string problem);
  InputVerdict checkSize(const ImageView& view);
  InputVerdict refuseNewSize(const std::string& change);
  std::string lateness(std::int64_t stamp_ns) const;
  InputVerdict takeTime(std::int64_t stamp_ns);

  InputCounts counts_;
  std::optional<ImageView> mask_;
  FrameClock clock_;
  std::string notice_;
  bool keeps_size_ = false;
  std::int64_t first_time_ns_ = 1;  // Stamps before this one are none.
  std::int64_t last_stamp_ns_ = 0;
  int width_ = 0;
  int height_ = 0;
  int new_width_ = 0;
  int new_height_ = 0;
  int new_size_images_ = 0;  // In a row.
};

}  // namespace camera_self_calibration
