#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/image_field.h"
#include "camera_self_calibration/queue/segment_queue.h"

namespace camera_self_calibration {

/// What was known of the lens in an epoch that ended.
struct Setting {
  std::uint64_t epoch = 0;
  SegmentQueue queue;
};

/// The latest settings of a lens that is zoomed or refocused now and then, so that one that returns
/// is recognised. Bounded.
class SettingArchive {
 public:
  /// Settings without a usable solution are not kept.
  void store(Setting setting);

  /// Takes out the setting that agrees with an estimate of this information: neither statistically
  /// different nor, over the part of the image that sees, by more than `max_distance_px` rms. The
  /// nearest, if several.
  std::optional<Setting> recall(const Camera& camera, const IntrinsicsMatrix& information,
                                const ImageField& field, double max_distance_px);

 private:
  std::deque<Setting> settings_;
};

}  // namespace camera_self_calibration
