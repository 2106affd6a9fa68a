#pragma once

#include <Eigen/Core>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/estimation/panel.h"
#include "camera_self_calibration/estimation/problem.h"
#include "camera_self_calibration/estimation/pseudo_inverse.h"
#include "camera_self_calibration/estimation/segment_structure.h"
#include "camera_self_calibration/estimation/transfer.h"

namespace camera_self_calibration {

/// The normal equations of one segment, with residual r = z - W (eq. 2) whitened and weighted, and
/// J the derivative of W: `H = J^T J`, `b = J^T r`. A change of the segment's own variables is one
/// vector: 6 entries per free keyframe, then up to 3 per landmark (inverse depth, then two of the
/// bearing). The intrinsics, shared with other segments, stand apart.
///
/// Eigen's vectors of fixed size do the work: a landmark has 1 or 3 rows, a pose 6, and what all
/// rows have in common, the "tail" of intrinsics and right-hand side, is padded with zeros to 2, 6
/// or 10. Memory is kept from one linearisation to the next.
class LinearSegment {
 public:
  /// Linearises at the block's present state. `huber` is the threshold on the whitened residual's
  /// norm above which it counts linearly. `for_marginal`: trackScores() and what tells of the
  /// depths are going to be asked for.
  void linearize(const SegmentBlock& block, const Camera& camera, int intrinsics_count,
                 double huber, bool for_marginal = false);
  /// The same at another state of the same block, whose keyframes, landmarks and observations are
  /// still those of the last `linearize`.
  void relinearize(const SegmentBlock& block, const Camera& camera, double huber);

  double cost() const { return cost_; }
  int poseColumns() const { return 6 * structure_.free_poses; }
  int landmarkRows() const { return structure_.landmark_rows; }
  /// Of the segment itself.
  int variables() const { return poseColumns() + landmarkRows(); }
  int intrinsicsCount() const { return intrinsics_count_; }

  /// b and the diagonal of H, i.e. the squared column norms of J: of the segment's variables (into
  /// `variables()` entries) and of the intrinsics.
  void copyGradient(Eigen::Ref<Eigen::VectorXd> own) const;
  void copyDiagonal(Eigen::Ref<Eigen::VectorXd> own) const;
  Intrinsics intrinsicsGradient() const;
  Intrinsics intrinsicsDiagonal() const;

  /// v^T H v = |J v|^2 for a change of this segment's variables and the intrinsics.
  double curvature(const Eigen::Ref<const Eigen::VectorXd>& own,
                   const Intrinsics& intrinsics) const;

  /// Eliminates landmarks, then poses, with H's diagonal times (1 + damping): leaves the reduced
  /// system of the intrinsics.
  void eliminate(double damping);
  IntrinsicsMatrix reducedHessian() const;
  Intrinsics reducedGradient() const;
  /// After eliminate(0): `|r|^2 / 2` at its least, to first order, over the segment's variables,
  /// with the intrinsics as they are.
  double reducedCost() const { return 0.5 * reduced_(tail_ - 1, tail_ - 1); }

  /// After linearize(.., true) and eliminate(0), at an optimum: `sum s s^T` over the landmarks'
  /// tracks, with s the track's share of the intrinsics' reduced gradient. Equal to
  /// reducedHessian() in expectation if all residuals are independent and the sigmas right; larger
  /// by what is correlated along a track.
  IntrinsicsMatrix trackScores() const;

  /// After linearize(.., true), of one observation, whitened and transposed: the derivative of its
  /// pixel by the translation of the reference camera relative to the observing one, in the world.
  /// 0 where these are the same, or where there is no prediction.
  const Matrix32d& translationView(std::size_t observation) const {
    return translation_views_[observation];
  }
  /// After linearize(.., true): H of a landmark's inverse depth and, unless it is anchored, its
  /// bearing; lower triangle. A held depth has it too.
  const Eigen::Matrix3d& landmarkInformation(std::size_t landmark) const {
    return structure_.landmarks[landmark].inverse_depth_fixed ? held_landmark_
                                                              : landmark_hessian_[landmark];
  }

  /// After eliminate(0), for columns B of poseColumns() rows, with S the poses' and intrinsics'
  /// system without landmarks: `B^T S_pp^-1 B` and `S_cp S_pp^-1 B`.
  void crossPoses(const Eigen::MatrixXd& columns, Eigen::MatrixXd* among_poses,
                  Eigen::MatrixXd* to_intrinsics) const;

  /// The Gauss-Newton change of the segment's variables, given that of the intrinsics (n_c).
  void backSubstitute(const Intrinsics& intrinsics_step, Eigen::Ref<Eigen::VectorXd> own) const;

  /// Eigenvalues of the poses' reduced system below this share of the largest, after scaling it to
  /// a unit diagonal, count as unobservable.
  static constexpr double kRankTolerance = 1e-12;

 private:
  // Columns that all observations of a pair of keyframes share: translation of the reference camera
  // relative to the observing one, in the world; rotation of the observing camera.
  static constexpr int kLocal = 6;

  // What all observations of a pair of keyframes need.
  struct PairFactors {
    Transfer transfer;
    bool same = false;  // a keyframe with itself
    Eigen::Matrix3d observing_from_world;
    Eigen::Matrix3d lever;  // [t_r - t_i]x R_r
  };

  // What all observations of a landmark need.
  struct LandmarkFactors {
    bool has_ray = false;
    Eigen::Vector3d ray;
    RayIntrinsicsJacobian d_intrinsics;  // of an anchored ray
    Matrix32d basis;                     // of a free bearing
  };

  template <int kTail>
  struct Row;

  void layOut();
  void clearSums();
  void prepareFactors(const Segment& segment, const Camera& camera);
  template <int kTail>
  void addObservations(const SegmentBlock& block, const Camera& camera, double huber);
  template <int kTail>
  bool linearizeRow(const Observation& observation, const Segment& segment, const PairFactors& pair,
                    const Camera& camera, double huber, Row<kTail>* row);
  template <int kTail, int kDimension>
  void addToLandmark(const SegmentStructure::ObservationPlace& place, int landmark,
                     const Row<kTail>& row);
  template <int kTail, int kDimension>
  void addCoupling(const SegmentStructure::ObservationPlace& place,
                   const SegmentStructure::LandmarkPlace& landmark,
                   const Eigen::Matrix<double, kLocal + kTail, kDimension>& coupling,
                   double* values) const;
  template <int kTail>
  void expandPair(int fixed_keyframes, std::size_t pair);
  void addInverseDepthPrior(const Segment& segment, const InverseDepthPrior& prior);
  template <int kTail>
  void eliminateLandmarks(double damping);
  template <int kTail, int kDimension>
  void whiten(std::size_t landmark, int first_pose, int poses, int column);
  void subtractProduct(int first_pose, int poses);
  void eliminatePoses();
  Eigen::Vector3d landmarkStep(std::size_t landmark, const Eigen::Ref<const Eigen::VectorXd>& poses,
                               const Intrinsics& intrinsics) const;
  // Coupling of one of a landmark's rows (of `dimension`) to the tail, and to a pose it touches.
  const double* landmarkTail(std::size_t l, int row) const {
    const SegmentStructure::LandmarkPlace& place = structure_.landmarks[l];
    return couplings_.data() + coupling_begin_[l] + 6 * place.entries * place.dimension +
           row * tail_;
  }
  Eigen::Map<const Vector6d> landmarkEntry(std::size_t l, int entry, int row) const {
    const int dimension = structure_.landmarks[l].dimension;
    return Eigen::Map<const Vector6d>(couplings_.data() + coupling_begin_[l] +
                                      6 * (entry * dimension + row));
  }

  int intrinsics_count_ = 0;
  int tail_ = 2;  // intrinsics, zeros, right-hand side
  bool for_marginal_ = false;
  double cost_ = 0.0;
  double squared_unit_ = 1.0;  // of the typical inverse depth
  SegmentStructure structure_;
  Transfers transfers_;
  std::vector<PairFactors> pair_factors_;
  std::vector<LandmarkFactors> landmark_factors_;

  // Per pair, (6 + tail) x 6: of J^T J for columns (translation between the two, rotation of the
  // observing one, tail) those of the first two, expanded into the poses once.
  std::vector<double> pair_products_;
  // (poses, tail)^2, lower triangle: H with the right-hand side as the last column.
  Eigen::MatrixXd normal_;
  // Per landmark, from couplings_[coupling_begin_[l]]: for each entry 6 x dimension, then tail x
  // dimension.
  std::vector<std::size_t> coupling_begin_;
  std::vector<double> couplings_;
  std::vector<Eigen::Matrix3d> landmark_hessian_;  // lower triangle
  Eigen::Matrix3d held_landmark_;             // of the one whose depth is held, as if it were not
  std::vector<Matrix32d> translation_views_;  // per observation
  // Per landmark, for each entry 6, then the tail: its track's share of the gradient.
  std::vector<std::size_t> score_begin_;
  std::vector<double> scores_;

  // After eliminate(): Cholesky factors of the landmark blocks, the poses' system, the tail with
  // factors of the poses' eliminated.
  std::vector<Eigen::Matrix3d> landmark_cholesky_;
  Panel panel_;  // scratch: the whitened couplings of some landmarks
  Eigen::MatrixXd schur_;
  PseudoInverse poses_inverse_;
  Eigen::MatrixXd whitened_tail_;  // F^T S_pt, with S_pp^-1 = F F^T
  Eigen::MatrixXd solved_tail_;    // S_pp^-1 S_pt
  Eigen::MatrixXd reduced_;        // tail by tail
};

}  // namespace camera_self_calibration
