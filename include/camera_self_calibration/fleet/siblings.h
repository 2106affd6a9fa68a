#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// A camera's present lens, for comparison with others.
struct Sibling {
  std::string name;
  Camera lens;
  IntrinsicsMatrix covariance;  ///< n_c x n_c.
};

/// How a camera compares with the others of its type.
struct SiblingVerdict {
  int siblings = 0;  ///< Others of its type; 0: nothing to compare with.
  bool outlier = false;
  double distance_px = 0.0;  ///< From the mean of the others [px rms].
  double spread_px = 0.0;    ///< tau of the others: how far cameras of this type differ.
  double p_value = 1.0;      ///< Before any correction for the number of cameras.
};

/// The type of a camera: what follows the last slash of its name, as in robot7/front, with model
/// and image size. Empty where the name has no slash.
std::string typeOf(const Sibling& camera);

/// Each camera against all others of its type: whether it differs from them by more than its
/// uncertainty, theirs, and the spread that lenses of the type have anyway. Of fleets without an
/// outlier the share `level` shows one (Holm 1979). Two of a kind cannot tell which is wrong: a
/// type needs three.
std::vector<SiblingVerdict> compareSiblings(const std::vector<Sibling>& cameras, double level);

}  // namespace camera_self_calibration
