#pragma once

#include <optional>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/camera/rational_polynomial.h"

namespace camera_self_calibration {

struct RationalFit {
  RationalPolynomial camera;
  PixelError error;  ///< Direct distance to the source over the image [px]; infinite where the fit
                     ///< cannot project a ray of the source.
};

/// The rational polynomial that projects most like `source` over its image: exact for pinhole and
/// radtan. Nothing where no fit is possible (too few pixels have rays in front of the camera).
std::optional<RationalFit> fitRationalPolynomial(const Camera& source);

/// fitCamera() for a lens that others describe by a rational polynomial, over an image of this size
/// [px]. k3 of a radtan fit is fitted, but not among the parameters to estimate.
std::optional<CameraFit> fitCamera(const RationalPolynomial& source, int width, int height,
                                   CameraModel target);

}  // namespace camera_self_calibration
