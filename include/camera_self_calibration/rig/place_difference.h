#pragma once

#include <Eigen/Core>
#include <vector>

#include "camera_self_calibration/camera/image_weights.h"
#include "camera_self_calibration/rig/rig.h"
#include "camera_self_calibration/rig/rig_segment.h"
#include "camera_self_calibration/rig/rig_solver.h"

namespace camera_self_calibration {

/// A turn of a camera against the first one (rotation vector in the rig's frame [rad]), then a
/// shift of its position, in distances between the first two cameras; of the second camera only
/// its direction can shift.
using PlaceVector = Eigen::Matrix<double, 6, 1>;
using PlaceMatrix = Eigen::Matrix<double, 6, 6>;

/// How often each camera's own features lie in each part of its image.
std::vector<ImageWeights> featuresOf(const Rig& rig, const std::vector<RigSegment>& segments);

/// The position of a camera in distances between the first two; zero where these are in one place.
Eigen::Vector3d relativePosition(const Rig& rig, int camera);

/// Its derivative by the variables of `layout` (3 x layout.size): what is common to all positions,
/// the scale, drops out.
Eigen::Matrix<double, 3, Eigen::Dynamic> relativePositionJacobian(const Rig& rig,
                                                                  const RigLayout& layout,
                                                                  int camera);

/// Where a camera sits in `rig`, against where it sits in `other`. Lenses that put the principal
/// point elsewhere turn all rays, and the poses that go with them: what the difference of the
/// lenses does where `features` are (featuresOf(rig)) like a rotation of the camera is left out, as
/// it is for lenses (pixelDistance). `other` has the same image sizes and may have other models.
PlaceVector placeDifference(const Rig& rig, const Rig& other, int camera,
                            const std::vector<ImageWeights>& features);

/// The same to first order, for small changes of the variables of `layout` (6 x layout.size): with
/// a covariance of these as rigCovariance gives it, that of what is left once lenses and poses are
/// taken together.
Eigen::Matrix<double, 6, Eigen::Dynamic> placeJacobian(const Rig& rig, const RigLayout& layout,
                                                       int camera,
                                                       const std::vector<ImageWeights>& features);

}  // namespace camera_self_calibration
