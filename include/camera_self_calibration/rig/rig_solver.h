#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/rig/rig.h"
#include "camera_self_calibration/rig/rig_segment.h"

namespace camera_self_calibration {

/// How Ceres minimises eq. (3) for a rig.
struct RigSolveOptions {
  /// Threshold on the norm of the whitened residual; 0: plain least squares.
  double huber = kHuberThreshold;
  int max_iterations = 50;
  double tolerance = 1e-7;  ///< Ends when a step lowers the cost by less than this share of it.
  int threads = 1;
  /// Asked at each iteration; where it says true the solution is given up. May be empty.
  std::function<bool()> stop;
  /// Cameras whose intrinsics stay as they are; empty: none do.
  std::vector<bool> hold_intrinsics;
};

/// Whether a camera keeps its intrinsics.
inline bool held(const RigSolveOptions& options, int camera) {
  const auto index = static_cast<std::size_t>(camera);
  return index < options.hold_intrinsics.size() && options.hold_intrinsics[index];
}

/// Minimises eq. (3) jointly over the poses of the rig, all landmarks, the intrinsics of each
/// camera and the poses of all cameras but the first in the rig: eq. (2) with `world_from_camera =
/// world_from_rig * rig_from_camera`. Each segment keeps its first pose, and the first segment the
/// distance between its first frame and the one farthest from it (of those that see enough): the
/// gauge of an unknown scale, which the cameras' distances carry over to all other segments. A
/// camera alone is the case of one. False, and nothing changed, where there are no observations or
/// Ceres gives up.
bool solveRig(const RigSolveOptions& options, std::vector<RigSegment>* segments, Rig* rig);

/// Where the variables of a rig stand in a covariance: of each camera but the first the rotation
/// vector (in the rig's frame [rad]) and the position in the rig; then the estimated intrinsics of
/// each camera that does not hold them.
struct RigLayout {
  std::vector<int> pose_at;        ///< Of each camera; -1 for the first.
  std::vector<int> intrinsics_at;  ///< Of each camera; -1 where they are held.
  int size = 0;

  RigLayout(const Rig& rig, const RigSolveOptions& options);
};

/// Covariance of the variables of RigLayout at a solution (eqs. 4 and 5) with errors that are
/// correlated along tracks allowed for, and scaled by what the residuals say beyond the sigmas; in
/// no direction smaller than without. Of positions it holds in the gauge of solveRig: directions
/// and ratios of positions do not depend on it. Nothing where not all of them are observed.
std::optional<Eigen::MatrixXd> rigCovariance(const RigSolveOptions& options,
                                             std::vector<RigSegment>* segments, Rig* rig);

/// What a segment of the rig's way says of the rig: the log-likelihood as a quadratic at `rig`, the
/// way and all landmarks at their best for it. Layout and gauge are those of rigCovariance with
/// intrinsics that are estimated for all cameras; what the segment does not tell has no
/// information.
struct RigLikelihood {
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
  Rig rig;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
};

/// At the segments' present state, which solves them, intrinsics held or not. Errors along tracks
/// are allowed for, and residuals that are larger than the sigmas. Nothing where a camera sees
/// nothing.
std::optional<RigLikelihood> rigLikelihood(const RigSolveOptions& options,
                                           std::vector<RigSegment>* segments, const Rig& rig);

}  // namespace camera_self_calibration
