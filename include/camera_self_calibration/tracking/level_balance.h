#pragma once

#include <array>
#include <cstddef>

#include "camera_self_calibration/tracking/reference_patch.h"

namespace camera_self_calibration {

/// Shares features out between the levels of the pyramid from which their patches are cut. What
/// suits a video is found by trying: fine patches are more precise where images are sharp, and keep
/// clear of the edges of what is near; coarse ones hold where images are blurred or noisy. What
/// decides is the information that one track of a level has given so far, the sum of 1 / sigma^2
/// over its life: the better level gets most features, and none is ever given up.
class LevelBalance {
 public:
  using Counts = std::array<std::size_t, ReferencePatch::kLevels>;  ///< Of features, by level.

  /// A new image: what was seen long ago counts less.
  void forget();
  /// A feature of that level was measured with this standard deviation [px].
  void measured(int level, double sigma);
  /// A feature of that level ended.
  void ended(int level);

  /// The level that has fewest features against its share.
  int next(const Counts& features) const;

 private:
  struct Account {
    double information = 0.0;  // [1/px^2] Of all measurements.
    double ends = 0.0;
  };

  std::array<Account, ReferencePatch::kLevels> accounts_ = {};
};

}  // namespace camera_self_calibration
