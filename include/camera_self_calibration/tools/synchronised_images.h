#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/ros/input_monitor.h"
#include "camera_self_calibration/tools/image_source.h"

namespace camera_self_calibration {

/// The images of several cameras that were taken at once, by their stamps.
class SynchronisedImages {
 public:
  /// Stamps that differ by more are not of one time: a feature that moves by 400 px/s is off by
  /// 0.4 px then.
  static constexpr std::int64_t kToleranceNs = 1'000'000;

  explicit SynchronisedImages(std::vector<ImageSource> sources);

  /// The next images that all cameras took at once, one for each; nothing at the end. Images that
  /// cannot be read, those of another size or from before the last one, and those without partners
  /// are left out.
  std::optional<std::vector<ImageView>> next();

  std::int64_t sets() const { return sets_; }            ///< Handed out.
  std::int64_t unmatched() const { return unmatched_; }  ///< Images left out.
  /// In words why hardly any images match, with the time between them; empty where most do.
  std::string problem() const;

 private:
  static constexpr std::int64_t kNoGap = std::numeric_limits<std::int64_t>::max();

  bool load(std::size_t camera);

  std::vector<ImageSource> sources_;
  std::vector<InputMonitor> monitors_;  // one for each source
  std::vector<std::optional<ImageView>> waiting_;
  std::int64_t sets_ = 0;
  std::int64_t unmatched_ = 0;
  std::int64_t last_gap_ = kNoGap;  // [ns] Of the image left out before; none since a match.
  std::vector<double> nearest_s_;   // from an image left out to the nearest of another camera
};

}  // namespace camera_self_calibration
