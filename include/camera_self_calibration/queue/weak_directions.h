#pragma once

#include <string>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// The directions of the intrinsics that an information matrix and the image both see as
/// independent, from the least known to the best known; n_c of them.
struct KnownDirections {
  /// Standard deviation along each [px rms over the image]; infinite where nothing is known.
  Intrinsics sigma_px;
  /// Columns: the change of the intrinsics along each that moves the image by 1 px rms.
  IntrinsicsMatrix axes;
  /// `coordinates * d` are the parts of a difference d along each [px rms].
  IntrinsicsMatrix coordinates;
};

/// At `camera`; empty where the information or the camera is not finite.
KnownDirections knownDirections(const Camera& camera, const IntrinsicsMatrix& information);

/// The rank-revealing update: `trusted`, moved to `estimate` along the directions that the
/// estimate's information knows better than `limit_px`; the others keep their trusted values.
/// `trusted` itself where nothing is known, or where the result were no valid camera.
Camera withWeakDirectionsHeld(const Camera& estimate, const IntrinsicsMatrix& information,
                              const Camera& trusted, double limit_px);

/// What is known least, for people, and a motion that would determine it.
struct WeakDirection {
  std::string name;  ///< Such as "the focal length (fx, fy)".
  std::string hint;
};

/// The parameters that dominate the least known direction; all of them, and motion that determines
/// them all, where the information is empty or not finite.
WeakDirection weakestDirection(const IntrinsicsMatrix& information, const Camera& camera);

}  // namespace camera_self_calibration
