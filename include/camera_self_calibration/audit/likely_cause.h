#pragma once

#include <functional>
#include <string>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/image_weights.h"

namespace camera_self_calibration {

/// What makes calibrations wrong, each a transformation of the calibration that would right it.
enum class LikelyCause {
  kNone,            ///< It is not wrong.
  kResolution,      ///< Made for images of another size or binning.
  kModel,           ///< The coefficients are another model's.
  kAxes,            ///< x and y are swapped.
  kFocalLength,     ///< Focus or zoom changed: one factor on fx and fy.
  kPrincipalPoint,  ///< It lies elsewhere.
  kBoth,            ///< Focal length and principal point differ, the distortion does not.
  kDistortion,      ///< The coefficients alone are wrong, or missing.
  kUnknown          ///< None of these.
};

/// "none", "resolution", "model", "axes", "focal_length", ...: the names used in files.
std::string toString(LikelyCause cause);

/// A cause in words, with figures.
struct CauseFound {
  LikelyCause cause = LikelyCause::kUnknown;
  std::string sentence;
};

/// The first of the list whose transformation makes a calibration that `fits`. Those with free
/// values (focal length, principal point, distortion) are fitted to `estimate` where the weights
/// say that it is known. The calibration may be for another image size than the estimate.
CauseFound likelyCause(const Camera& calibration, const Camera& estimate,
                       const ImageWeights& weights, const std::function<bool(const Camera&)>& fits);

}  // namespace camera_self_calibration
