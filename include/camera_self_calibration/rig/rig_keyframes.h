#pragma once

#include <algorithm>
#include <vector>

namespace camera_self_calibration {

/// Which images become keyframes of the rig: those at which more than half of its cameras have
/// called for one of their own since the last. One camera that looks at much motion alone, or has
/// lost its way, tells nothing of the rig.
class RigKeyframes {
 public:
  /// `calls`: for each camera whether this image is a keyframe of its own.
  bool add(const std::vector<bool>& calls) {
    called_.resize(calls.size(), false);
    for (std::size_t c = 0; c < calls.size(); ++c) called_[c] = called_[c] || calls[c];
    const auto count = std::count(called_.begin(), called_.end(), true);
    if (2 * count <= static_cast<std::ptrdiff_t>(calls.size())) return false;
    called_.assign(calls.size(), false);
    return true;
  }

 private:
  std::vector<bool> called_;
};

}  // namespace camera_self_calibration
