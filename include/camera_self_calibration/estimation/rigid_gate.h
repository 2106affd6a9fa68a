#pragma once

#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// The tracks that a rigid scene does not explain from the segment's poses as they are, whatever
/// its depths: what moves by itself, and what the camera carries along. First each landmark takes
/// the depth that fits it best (poses and intrinsics held), which `segment` keeps; those that are
/// grossMisfits then, with sigmas scaled to what the median residual is, are returned: indices into
/// its landmarks. Sound while more than half of the observations are of the scene.
std::vector<int> nonRigidTracks(Segment* segment, const Camera& camera);

}  // namespace camera_self_calibration
