#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "camera_self_calibration/geometry/rigid3.h"

namespace camera_self_calibration {

/// Where the camera was at a time.
struct StampedCameraPose {
  std::int64_t stamp_ns = 0;
  std::uint64_t map_id = 0;  ///< Poses of different maps differ in frame and scale.
  Rigid3 world_from_camera;
};

/// How far two trajectories are apart, after the similarity that fits best. Lengths are in units of
/// the reference.
struct TrajectoryDifference {
  int poses = 0;           ///< Compared.
  double travelled = 0.0;  ///< Length of the reference's way along these poses.
  double scale = 1.0;      ///< Reference units per unit of the other, of the map with most poses.
  double mean = 0.0;       ///< Of the distance between positions.
  double rms = 0.0;        ///< The absolute trajectory error (ATE).
  double max = 0.0;
  /// Relative pose error over `interval_s`: rms of the motion's difference (RPE); not a number
  /// where no two poses are so far apart, to half an image interval of at most 0.25 s.
  double relative_translation = std::numeric_limits<double>::quiet_NaN();
  double relative_rotation_deg = std::numeric_limits<double>::quiet_NaN();
  double interval_s = 1.0;

  /// Mean distance over the way travelled, as the paper's 1.76 %.
  double share() const { return travelled > 0.0 ? mean / travelled : 0.0; }
};

/// Aligns `estimate` with `reference` (Umeyama 1991), each pair of maps by itself, and compares
/// positions at the estimate's stamps; the reference is interpolated between poses of one map that
/// are at most 0.25 s apart. Both in the order of time. Nothing if fewer than three poses of a map
/// can be compared.
std::optional<TrajectoryDifference> compareTrajectories(
    const std::vector<StampedCameraPose>& estimate,
    const std::vector<StampedCameraPose>& reference);

/// The poses with stamps in [begin_ns, end_ns).
std::vector<StampedCameraPose> between(const std::vector<StampedCameraPose>& poses,
                                       std::int64_t begin_ns, std::int64_t end_ns);

/// The poses of `estimate` that have a partner in the reference, moved and scaled onto it.
std::vector<StampedCameraPose> alignedTo(const std::vector<StampedCameraPose>& reference,
                                         const std::vector<StampedCameraPose>& estimate);

}  // namespace camera_self_calibration
