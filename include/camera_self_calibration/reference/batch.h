#pragma once

#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// A segment of the joint problem. Segments share nothing but the camera; a whole trajectory is one
/// segment with all its keyframes.
struct BatchSegment {
  Segment* segment = nullptr;  ///< Changed by solveBatch; must outlive the call.
  int fixed_keyframes = 1;     ///< Gauge: so many leading keyframes keep their pose.
  int fixed_landmark = -1;     ///< Gauge: this landmark keeps its inverse depth; -1: none does.
  double sigma_scale = 1.0;    ///< Multiplies the sigma of every observation of the segment.
};

struct BatchOptions {
  double huber = 0.0;  ///< Threshold on the norm of the whitened residual; 0: plain least squares.
  int max_iterations = 200;
  /// Ends when a step lowers the cost by less than this share of it: an oracle goes down to
  /// rounding.
  double tolerance = 1e-15;
  int threads = 1;
  bool estimate_intrinsics = true;  ///< False: the camera stays as it is.
  /// For some dozen keyframes a dense Schur complement is the faster one; for long trajectories a
  /// sparse one is.
  bool small = false;
};

struct BatchSummary {
  bool converged = false;
  double initial_cost = 0.0;  ///< Half the (robust) sum of squares of the whitened residuals.
  double final_cost = 0.0;
  int iterations = 0;
  std::string message;  ///< Why it ended, or what is wrong with the input.
};

/// Minimises eq. (3) over poses, landmarks and the estimated intrinsics of all segments jointly,
/// with Ceres and down to rounding: the whole-trajectory batch solution that the paper compares
/// with (section III). A point that cannot be projected has residual zero. Malformed input (an
/// index out of range, an observation of an anchored landmark in its reference keyframe, a sigma
/// that is not positive, a camera that is not valid) changes nothing and is named in the message.
BatchSummary solveBatch(const std::vector<BatchSegment>& segments, Camera* camera,
                        const BatchOptions& options);

/// Marginal covariance of the estimated intrinsics at the present state (eqs. 4 and 5), n_c x n_c,
/// with the gauge of `segments`; `options.estimate_intrinsics` is taken as true. It is that of
/// J^T W J, W the weights of iteratively reweighted least squares under `options.huber`: Ceres
/// corrects J by the loss's second derivative (Triggs et al. 2000) only where that is positive,
/// which Huber's nowhere is. Nothing where the problem is rank deficient or malformed.
std::optional<IntrinsicsMatrix> batchCovariance(const std::vector<BatchSegment>& segments,
                                                const Camera& camera, const BatchOptions& options);

/// The same marginal with the scores of the tracks, for a covariance that allows for errors that
/// are correlated along a track (Marginal::robustCovariance). With `H = J^T J`, the columns Y of
/// `H^-1` that belong to the intrinsics and r the residuals, a track's share of the intrinsics'
/// error is `psi = sum Y^T J^T r` over its observations, and the scores are `I (sum psi psi^T) I`,
/// I the information. Sparse, so that it serves thousands of keyframes. Landmarks of different
/// segments count as different tracks. Nothing where the problem is rank deficient or malformed.
std::optional<Marginal> batchMarginal(const std::vector<BatchSegment>& segments,
                                      const Camera& camera, const BatchOptions& options);

}  // namespace camera_self_calibration
