#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/map/segment.h"
#include "camera_self_calibration/simulation/feature_tracks.h"
#include "camera_self_calibration/simulation/room.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"
#include "camera_self_calibration/simulation/trajectory.h"

namespace camera_self_calibration {

/// Which landmarks a simulated segment has (see Landmark::anchored).
enum class LandmarkOrigin {
  kAnchored,   ///< Born in the segment only.
  kInherited,  ///< Detected before its first keyframe only.
  kMixed       ///< Both, as in a running system.
};

struct SegmentOptions {
  Camera camera = Camera::defaultGuess(CameraModel::kFov, 640, 480);
  LandmarkOrigin origin = LandmarkOrigin::kMixed;
  int keyframes = 10;
  double keyframe_interval_s = 0.25;   ///< At most, between neighbours [s].
  double keyframe_rotation_deg = 6.0;  ///< A turn by this much makes the next keyframe at once.
  double start_s = 1.0;  ///< Of the first keyframe, on the trajectory; at least two intervals.
  MotionKind motion = MotionKind::kHandheld;
  double motion_speed = 0.6;             ///< See SyntheticMotionOptions::speed.
  std::optional<Trajectory> trajectory;  ///< If given, in place of the synthetic motion.
  RoomOptions room;
  FeatureTracksOptions tracks;  ///< Noise, outliers, count; the seed is that of makeSegment.
  int min_views = 3;            ///< Keyframes that see a landmark, its reference included.

  /// Every violated bound in one sentence each; empty if all is well.
  std::vector<std::string> problems() const;
};

/// A segment whose poses, inverse depths and bearings are true; its pixels carry the noise.
struct SimulatedSegment {
  Segment segment;
  Camera camera;                        ///< The true one.
  std::vector<Eigen::Vector3d> points;  ///< Of each landmark, world frame [m].
  std::vector<bool> outliers;           ///< Of each observation: a gross error.
};

/// Keyframes along a trajectory through a room, and the tracks between them. The seed decides on
/// motion, points and noise. Inverse depths are per unit ray: 1 / distance. Throws
/// std::invalid_argument that lists options.problems().
SimulatedSegment makeSegment(const SegmentOptions& options, std::uint64_t seed);

struct SegmentPerturbation {
  double translation_m = 0.02;  ///< Of each keyframe but the first, per axis [m].
  double rotation_rad = 0.01;   ///< Of each keyframe but the first, per axis [rad].
  double inverse_depth = 0.1;   ///< Relative.
  double bearing_rad = 0.003;   ///< Of inherited landmarks, per axis [rad].
};

/// Start values for a solver: gaussian errors on poses, inverse depths and inherited bearings.
Segment perturbed(const Segment& segment, const SegmentPerturbation& sigma, std::uint64_t seed);

}  // namespace camera_self_calibration
