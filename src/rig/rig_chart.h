#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "camera_self_calibration/rig/rig_solver.h"

namespace camera_self_calibration {

// Coordinates of a rig near a reference, in which segments of video compare whatever their scales:
// of each camera but the first the rotation vector in the rig's frame [rad], then the positions in
// distances between the first two cameras (two across the second camera's direction, three of each
// further one), then the intrinsics of all cameras, focal lengths and centres in focal lengths.
class RigChart {
 public:
  using Quadratic = std::pair<Eigen::MatrixXd, Eigen::VectorXd>;

  explicit RigChart(const Rig& reference);

  int size() const { return intrinsics_at_.back(); }

  // Information and gradient of a segment's log-likelihood at the reference. Positions that it does
  // not tell, by sigmas as large as themselves, are left open.
  Quadratic of(const RigLikelihood& segment) const;

  // How the coordinates change when one camera moves: rotation vector in the rig's frame [rad] and
  // shift, in the reference's unit. Of two cameras that of the second alone; of more the first is
  // that of the first camera, which moves all others the other way.
  std::vector<Eigen::MatrixXd> mountBases() const;
  // When the poses of all cameras change.
  Eigen::MatrixXd allPoses() const;
  // When the intrinsics of one camera change; one for each camera.
  std::vector<Eigen::MatrixXd> lensBases() const;

 private:
  Quadratic ordered(const RigLikelihood& segment) const;
  std::optional<double> scaleOf(const RigLikelihood& segment,
                                const Eigen::MatrixXd& information) const;
  int rotationAt(int camera) const { return 3 * (camera - 1); }
  int positionsAt() const { return 3 * (reference_.size() - 1); }
  // Of the coordinates of positions by the positions themselves, 3 a camera but the first.
  Eigen::MatrixXd positionsFromShifts() const;
  // Of the positions in a segment by the coordinates and, last, the logarithm of its scale.
  Eigen::MatrixXd shiftsFromPositions(double scale) const;
  Eigen::VectorXd positions(const Rig& rig) const;

  Rig reference_;
  double unit_;                     // distance between the first two cameras
  std::vector<int> intrinsics_at_;  // of each camera, and the end
};

}  // namespace camera_self_calibration
