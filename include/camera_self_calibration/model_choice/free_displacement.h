#pragma once

#include <Eigen/Core>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/image_field.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/model_choice/lens_trial.h"

namespace camera_self_calibration {

/// What observations say of a lens beyond its model: the smooth displacement of its pixels
/// (DisplacementBasis) under which they fit best, to first order. Its coefficients are taken for
/// normal with one variance, which the observations tell (empirical Bayes): what they do not
/// determine stays small.
struct FreeDisplacement {
  /// Probability that the lens is of its model and chance alone puts so much into the displacement.
  double p_value = 1.0;
  Camera camera;               ///< The lens that is displaced.
  Eigen::VectorXd change;      ///< Of n_c intrinsics, then of the displacement's coefficients [px].
  Eigen::MatrixXd covariance;  ///< Of the change.

  /// Distance between the lens as it is and as the observations want it, a rotation removed.
  PixelError distance(const ImageField& field) const;
  /// How well the latter is known.
  PixelError uncertainty(const ImageField& field) const;
};

/// `trial` is a lens that was fitted to the observations. p_value stays 1, and the rest empty,
/// where they do not determine its intrinsics.
FreeDisplacement freeDisplacement(const LensObservations& observations, const LensTrial& trial,
                                  int threads);

}  // namespace camera_self_calibration
