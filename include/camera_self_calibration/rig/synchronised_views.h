#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/rig/rig_segment.h"

namespace camera_self_calibration {

/// What one camera of a rig made of an image.
struct TimedView {
  std::int64_t stamp_ns = 0;
  RigView view;
  bool is_keyframe = false;  ///< Of this camera.
};

/// Puts together what the cameras of a rig saw at once, by the stamps of the images. Memory is
/// bounded.
class SynchronisedViews {
 public:
  /// Stamps that differ by more are not of one time: a feature that moves by 400 px/s is off by
  /// 0.4 px then.
  static constexpr std::int64_t kToleranceNs = 1'000'000;

  explicit SynchronisedViews(int cameras) : waiting_(static_cast<std::size_t>(cameras)) {}

  /// The set of views, one for each camera, that this one completes. Those of one camera come in
  /// the order of time, the cameras in any. Views without partners are left out. Where time jumps
  /// back, what waits is forgotten.
  std::optional<std::vector<TimedView>> add(int camera, TimedView view);

  /// In words why hardly any views match, with the time between them; empty where most do. What is
  /// newer counts more.
  std::string problem() const;

 private:
  static constexpr std::int64_t kNoGap = std::numeric_limits<std::int64_t>::max();

  bool complete() const;
  std::optional<std::vector<TimedView>> take();
  void leaveOut(std::deque<TimedView>* views, std::int64_t gap);
  void fade();

  std::vector<std::deque<TimedView>> waiting_;
  std::int64_t sets_ = 0;
  std::int64_t unmatched_ = 0;      // views left out
  std::int64_t last_gap_ = kNoGap;  // [ns] Of the view left out before; none since a match.
  std::deque<double> nearest_s_;    // from a view left out to the nearest of another camera
};

}  // namespace camera_self_calibration
