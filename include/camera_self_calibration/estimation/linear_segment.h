#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/estimation/problem.h"

namespace camera_self_calibration {

/// A change of one segment's variables: 6 per free keyframe, then up to 3 per landmark (inverse
/// depth, then two of the bearing).
struct SegmentStep {
  Eigen::VectorXd poses;
  Eigen::VectorXd landmarks;
};

/// The normal equations of one segment, with residual r = z - W (eq. 2) whitened and weighted, and
/// J the derivative of W: `H = J^T J`, `b = J^T r`. Columns are x = (free poses, intrinsics) and,
/// kept apart because they are eliminated first, the landmarks.
class LinearSegment {
 public:
  /// Linearises at the block's present state. `huber` is the threshold on the whitened residual's
  /// norm above which it counts linearly.
  void linearize(const SegmentBlock& block, const Camera& camera, int intrinsics_count,
                 double huber);

  double cost() const { return cost_; }
  int poseColumns() const { return pose_columns_; }
  int intrinsicsCount() const { return intrinsics_count_; }
  int landmarkRows() const { return static_cast<int>(landmark_gradient_.size()); }

  /// b, of the poses and the intrinsics, and of the landmarks.
  const Eigen::VectorXd& gradient() const { return gradient_; }
  const Eigen::VectorXd& landmarkGradient() const { return landmark_gradient_; }
  /// diag(H): the squared column norms of J.
  Eigen::VectorXd diagonal() const { return hessian_.diagonal(); }
  Eigen::VectorXd landmarkDiagonal() const;

  /// v^T H v = |J v|^2 for a change of this segment's variables and the intrinsics.
  double curvature(const SegmentStep& step, const Intrinsics& intrinsics) const;

  /// Eliminates landmarks, then poses, with H's diagonal times (1 + damping): leaves the reduced
  /// system of the intrinsics.
  void eliminate(double damping);
  const IntrinsicsMatrix& reducedHessian() const { return reduced_hessian_; }
  const Intrinsics& reducedGradient() const { return reduced_gradient_; }

  /// After eliminate(0), at an optimum: `sum s s^T` over the landmarks' tracks, with s the track's
  /// share of the intrinsics' reduced gradient. Equal to reducedHessian() in expectation if all
  /// residuals are independent and the sigmas right; larger by what is correlated along a track.
  IntrinsicsMatrix trackScores() const;

  /// The Gauss-Newton change of poses and landmarks, given that of the intrinsics (n_c).
  SegmentStep backSubstitute(const Intrinsics& intrinsics_step) const;

  /// Eigenvalues of the poses' reduced system below this share of the largest, after scaling it to
  /// a unit diagonal, count as unobservable.
  static constexpr double kRankTolerance = 1e-12;

 private:
  struct LandmarkRows {
    int row = 0;    // first row in the landmark arrays
    int count = 0;  // 0 to 3
  };

  // Consecutive landmarks with one reference keyframe, and the pose columns that they touch.
  struct LandmarkGroup {
    int row = 0;
    int rows = 0;
    int begin_column = 0;
    int end_column = 0;
  };

  void resize(const SegmentBlock& block, int intrinsics_count);
  void addObservation(const SegmentBlock& block, const Camera& camera, double huber,
                      const Observation& observation);
  void eliminateLandmarks(double damping);
  void eliminatePoses();
  void groupLandmarks(const SegmentBlock& block);
  void subtractFromSchur(const LandmarkGroup& group);

  int pose_columns_ = 0;
  int intrinsics_count_ = 0;
  double cost_ = 0.0;
  std::vector<LandmarkRows> rows_;  // per landmark
  std::vector<LandmarkGroup> groups_;

  Eigen::MatrixXd hessian_;           // x by x, lower triangle
  Eigen::VectorXd gradient_;          // x
  Eigen::MatrixXd track_gradients_;   // x by landmarks: each one's share of gradient_
  Eigen::MatrixXd coupling_;          // landmark rows by x
  Eigen::MatrixXd landmark_hessian_;  // landmark rows by 3, lower triangles
  Eigen::VectorXd landmark_gradient_;

  // After eliminate(): Cholesky factors of the landmark blocks, rows whitened with them, and a
  // factor F of the inverse of the poses' system, S_pp^-1 = F F^T.
  Eigen::MatrixXd landmark_factor_;
  Eigen::MatrixXd whitened_coupling_;
  Eigen::VectorXd whitened_gradient_;
  Eigen::MatrixXd schur_;
  Eigen::VectorXd schur_gradient_;
  Eigen::MatrixXd pose_factor_;
  Eigen::MatrixXd pose_coupling_;    // F^T S_pc
  Eigen::VectorXd pose_projection_;  // F^T s_p
  IntrinsicsMatrix reduced_hessian_;
  Intrinsics reduced_gradient_;

  // Scratch of linearize(), one entry a keyframe or a landmark.
  std::vector<PoseMatrices> poses_;
  std::vector<Eigen::Vector3d> rays_;
  std::vector<RayIntrinsicsJacobian> ray_jacobians_;
  std::vector<char> ray_valid_;
};

/// 1 / sqrt(value), or 0 for what is not positive: scales a matrix to a unit diagonal.
inline double inverseRoot(double value) { return value > 0.0 ? 1.0 / std::sqrt(value) : 0.0; }

/// F with `F F^T` the pseudo-inverse of a symmetric positive semi-definite matrix (lower triangle
/// used): triangular where its Cholesky factorisation is sound, else from the eigenvectors above
/// `rank_tolerance` after scaling to a unit diagonal.
Eigen::MatrixXd inverseFactor(const Eigen::MatrixXd& matrix, double rank_tolerance);

/// The robust cost of one block at its present state, as LinearSegment::cost.
double robustCost(const SegmentBlock& block, const Camera& camera, double huber);

}  // namespace camera_self_calibration
