#pragma once

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {

/// Expected standard deviations that normalise a covariance before its entropy is taken (the
/// paper's sigma_i are their squares), n_c entries for this camera. fx, fy, cx, cy per pixel of
/// the image's longer side, so that one table serves all sizes.
Intrinsics normalizationSigmas(const Camera& camera);

/// Normalised differential entropy `h = 1/2 ln |2 pi e Sigma'|` [nats] with
/// `Sigma'_ij = Sigma_ij / (s_i s_j)`; +infinity where the covariance is empty or not positive
/// definite.
double entropy(const Camera& camera, const IntrinsicsMatrix& covariance);

}  // namespace camera_self_calibration
