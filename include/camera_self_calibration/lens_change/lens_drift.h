#pragma once

#include <cstdint>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/queue/agreement.h"

namespace camera_self_calibration {

/// How the intrinsics at `point` change per relative change of the focal length: (fx, fy, 0, ..).
Intrinsics alongFocalLength(const Intrinsics& point);

/// The focal length's slow drift: segment i shows the intrinsics `x_i = x + (fx, fy, 0, ..) s_i`
/// with s a random walk that is 0 now (`var(s_i - s_j) = rate^2 |t_i - t_j|`), and all other
/// intrinsics constant. The rate is that of the largest restricted likelihood, on a grid, where it
/// is a clearly better explanation than segments that disagree by the same factor in everything,
/// also without any one of them, and leaves them disagreeing by no more than is believed at
/// hand-over (kMaxInflation). x follows from all segments, each weighted by how long ago it was.
///
/// `queue` and `others` (which shares no moment with it) are of the intrinsics of `camera`, the
/// queue's estimate; `now_ns` is not before any of them.
LensDrift estimateDrift(const std::vector<QuadraticLikelihood>& queue,
                        const std::vector<QuadraticLikelihood>& others, const Camera& camera,
                        std::int64_t now_ns);

/// Twice the logarithm of the likelihood ratio of such a walk, of the likeliest rate, to a constant
/// lens.
double driftEvidence(const std::vector<QuadraticLikelihood>& segments, const Camera& camera,
                     std::int64_t now_ns);

}  // namespace camera_self_calibration
