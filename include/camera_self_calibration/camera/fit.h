#pragma once

#include <optional>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {

struct CameraFit {
  Camera camera;
  /// Direct distance (no rotation removed) to the source over the image; infinite where the fit
  /// cannot project a ray of the source.
  PixelError error;
};

/// The camera of another model that projects most like `source` over its image (least squares in
/// pixels over a grid; fov to equidistant starts from the closed form
/// `s = 2 tan(w/2)/w, f_e = s f`). A radtan fit has five coefficients. Nothing where no fit is
/// possible (too few pixels have rays).
std::optional<CameraFit> fitCamera(const Camera& source, CameraModel target);

/// Where an estimate can start: the derivative by fov's w vanishes at w = 0, which it would never
/// leave. Focal lengths follow, so that the image's centre stays as it is. Other models as they
/// are.
Camera withLeastFovW(const Camera& camera);

}  // namespace camera_self_calibration
