#pragma once

#include <cmath>
#include <limits>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/image_field.h"

namespace camera_self_calibration {

/// An error over the image, in pixels: root mean square and largest value over a 40 x 30 grid of
/// the pixels that have a ray, the image's border included, and that see the scene (ImageField).
struct PixelError {
  double rms = 0.0;
  double max = 0.0;

  /// Of what nothing is known of: infinite.
  static constexpr PixelError unknown() {
    return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }

  PixelError scaled(double factor) const { return {factor * rms, factor * max}; }
  /// The sum of two independent errors.
  PixelError inQuadrature(const PixelError& other) const {
    return {std::hypot(rms, other.rms), std::hypot(max, other.max)};
  }
};

/// pixelUncertainty() over the image's longer side, rms, above which an estimate tells nothing of
/// the lens: its segment is not offered to the queue, the startup batch keeps to what was known
/// before, and a lens model is not chosen for it. Without any information (a still camera,
/// translation alone) noise in the estimated motion of a window simulates 0.035 to 0.2, whatever
/// its size.
inline constexpr double kUselessUncertaintyShare = 0.03;

/// Expected error of projections with intrinsics of covariance `covariance` (n_c x n_c), rays
/// fixed, after removing what a rotation B omega of the camera absorbs:
/// `A' = A - B (sum B^T B)^-1 sum B^T A`, per grid point `A' C A'^T`, rms = sqrt(mean trace),
/// max = sqrt(max trace). unknown() where the covariance is empty or not finite.
PixelError pixelUncertainty(const Camera& camera, const IntrinsicsMatrix& covariance,
                            const ImageField& field = {});

/// A pixel and the expected error (1 sigma, both axes together) of a projection there [px].
struct UncertainPixel {
  Eigen::Vector2d pixel;
  double sigma = 0.0;
};

/// What pixelUncertainty() sums up, point by point of its grid; empty where that is infinite.
std::vector<UncertainPixel> uncertaintyOverImage(const Camera& camera,
                                                 const IntrinsicsMatrix& covariance,
                                                 const ImageField& field = {});

/// n_c x n_c matrix G such that a small change d of the intrinsics moves projections by
/// `sqrt(d^T G d)` px rms over the image, rotation compensated: pixelUncertainty() is the root of
/// trace(G C). Zero where no pixel has a ray.
IntrinsicsMatrix pixelMetric(const Camera& camera, const ImageField& field = {});

/// Distance between two calibrations of one image size, whatever their models: the pixels of `a`'s
/// grid, their rays, projected by `b` after the camera rotation that fits best. Infinite where no
/// pixel of `a` projects in `b`. Grid points further than `max_radius_px` from a's principal point
/// are left out.
PixelError pixelDistance(const Camera& a, const Camera& b, double max_radius_px = 1e9);

/// As above, over the part of the image that sees the scene.
PixelError pixelDistance(const Camera& a, const Camera& b, const ImageField& field);

}  // namespace camera_self_calibration
