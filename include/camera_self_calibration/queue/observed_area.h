#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/image_field.h"
#include "camera_self_calibration/camera/image_weights.h"
#include "camera_self_calibration/queue/candidate_window.h"

namespace camera_self_calibration {

/// The part of `seeing` that features of these segments covered: grid points with an observation at
/// most one and a half grid spacings away. Elsewhere the lens model alone says where rays go.
ImageField observedArea(const std::vector<Candidate>& queue, const Camera& camera,
                        const ImageField& seeing);

/// How many observations of these segments lie in each part of the image.
ImageWeights featureWeights(const std::vector<Candidate>& queue, const Camera& camera);

/// Corners that see and that are not `observed`, in words; empty if there is none. Of the segments
/// that the calibration rests on: what earlier images showed there no longer makes it better.
std::string unseenCorners(const ImageField& observed, const ImageField& seeing);

}  // namespace camera_self_calibration
