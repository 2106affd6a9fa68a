#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

/// A feature of one image whose motion was measured.
struct MovingPoint {
  Eigen::Vector3d point;       ///< In the camera, divided by the reference's distance (eq. 1).
  double inverse_depth = 0.0;  ///< By which the point was multiplied [1/map unit].
  ImageMotion measured;        ///< In time [px/s, px/s^2].
  double weight = 1.0;         ///< One over the measurement's variance, but for a common factor.
};

/// How the camera moves: twist and its derivative, in the camera frame, translation first.
struct CameraMotion {
  Vector6d velocity = Vector6d::Zero();      ///< [map unit/s, rad/s]
  Vector6d acceleration = Vector6d::Zero();  ///< [map unit/s^2, rad/s^2]
  /// By how much the velocities of features differ from those that follow: the median over
  /// features, each multiplied by the root of its weight [px/s].
  double typical_residual = 0.0;
};

/// The motion of the camera before a rigid scene that explains the features' motions best, robust
/// against those that do not belong to it. The differences of noisy tracks, of which there are two
/// numbers for each feature, become six for all of them. It goes by the features that were measured
/// in most images (ImageMotion::images), if they are enough. Nothing where there are too few.
std::optional<CameraMotion> fitCameraMotion(const std::vector<MovingPoint>& points,
                                            const Camera& camera);

/// The motion of a feature in the image that follows; nothing where the camera cannot project.
std::optional<ImageMotion> imageMotion(const MovingPoint& point, const CameraMotion& motion,
                                       const Camera& camera);

/// Whether a feature was seen to move as `scene` says, which follows from the camera's motion
/// (imageMotion), whose `typical_residual` is the scale. One that was not has a motion of its own
/// or a depth that is wrong: one that seems to be at the camera would move without bounds.
bool movesWithScene(const MovingPoint& point, const ImageMotion& scene, double typical_residual);

}  // namespace camera_self_calibration
