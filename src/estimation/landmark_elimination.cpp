// Nested elimination: landmarks, then poses; and back.

#include <cmath>
#include <cstddef>

#include "camera_self_calibration/estimation/linear_segment.h"
#include "camera_self_calibration/geometry/cpu_clones.h"

namespace camera_self_calibration {
namespace {

// Lower Cholesky factor of a landmark's damped block, with the reciprocals of the pivots on its
// diagonal; a direction without information has a zero there, and so does not move.
Eigen::Matrix3d landmarkCholesky(const Eigen::Matrix3d& hessian, int dimension, double damping) {
  Eigen::Matrix3d factor = Eigen::Matrix3d::Zero();
  const double largest = hessian.diagonal().maxCoeff();
  for (int j = 0; j < dimension; ++j) {
    double pivot = hessian(j, j) * (1.0 + damping);
    for (int k = 0; k < j; ++k) pivot -= factor(j, k) * factor(j, k);
    if (!(pivot > 1e-13 * hessian(j, j) && pivot > 1e-24 * largest)) continue;
    factor(j, j) = 1.0 / std::sqrt(pivot);
    for (int i = j + 1; i < dimension; ++i) {
      double value = hessian(i, j);
      for (int k = 0; k < j; ++k) value -= factor(i, k) * factor(j, k);
      factor(i, j) = value * factor(j, j);
    }
  }
  return factor;
}

// target -= left right^T, with `rank` columns (1 or 3) in both, `pitch` apart; the target's are
// `target_pitch` apart.
SELFCAL_CPU_CLONES void subtractProducts(const double* left, const double* right, int pitch,
                                         int rank, int rows, int columns, double* target,
                                         std::ptrdiff_t target_pitch) {
  for (int c = 0; c < columns; ++c) {
    double* __restrict out = target + c * target_pitch;
    if (rank == 3) {
      const double x = right[c], y = right[pitch + c], z = right[2 * pitch + c];
      for (int r = 0; r < rows; ++r) {
        out[r] -= left[r] * x + left[pitch + r] * y + left[2 * pitch + r] * z;
      }
    } else {
      for (int r = 0; r < rows; ++r) out[r] -= left[r] * right[c];
    }
  }
}

}  // namespace

void LinearSegment::eliminate(double damping) {
  schur_ = normal_;
  schur_.diagonal() *= 1.0 + damping;
  if (tail_ == 2) eliminateLandmarks<2>(damping);
  if (tail_ == 6) eliminateLandmarks<6>(damping);
  if (tail_ == 10) eliminateLandmarks<10>(damping);
  eliminatePoses();
}

template <int kTail>
void LinearSegment::eliminateLandmarks(double damping) {
  landmark_cholesky_.resize(structure_.landmarks.size());
  for (std::size_t l = 0; l < structure_.landmarks.size(); ++l) {
    const int dimension = structure_.landmarks[l].dimension;
    landmark_cholesky_[l] = landmarkCholesky(landmark_hessian_[l], dimension, damping);
    if (dimension == 1) {
      eliminateLandmark<kTail, 1>(l);
    } else {
      eliminateLandmark<kTail, 3>(l);
    }
  }
}

// S -= U U^T with U = W L^-T, W the landmark's coupling to the poses that see it and to the tail.
// Column by column of S: keyframes that follow each other give long columns.
template <int kTail, int kDimension>
void LinearSegment::eliminateLandmark(std::size_t l) {
  const SegmentStructure::LandmarkPlace& place = structure_.landmarks[l];
  const int* poses = structure_.entry_poses.data() + place.first_entry;
  const int rows = 6 * place.entries + kTail;
  const int tail = 6 * place.entries;
  const int last = poseColumns();
  whiten<kTail, kDimension>(l);
  const auto subtract = [&](int row, int count, int at_row, int column, int columns,
                            int at_column) {
    subtractProducts(whitened_.data() + row, whitened_.data() + column, rows, kDimension, count,
                     columns, &schur_(at_row, at_column), schur_.rows());
  };
  for (int b = 0; b < place.entries; ++b) {
    for (int a = 0, end = 0; a < place.entries; a = end) {
      end = a + 1;
      if (poses[a] < poses[b]) continue;
      while (end < place.entries && poses[end] == poses[end - 1] + 1) ++end;
      subtract(6 * a, 6 * (end - a), 6 * poses[a], 6 * b, 6, 6 * poses[b]);
    }
    subtract(tail, kTail, last, 6 * b, 6, 6 * poses[b]);
  }
  subtract(tail, kTail, last, tail, kTail, last);
}

// U of one landmark, one column for each of its dimensions: rows of the poses, then of the tail.
template <int kTail, int kDimension>
void LinearSegment::whiten(std::size_t l) {
  const SegmentStructure::LandmarkPlace& place = structure_.landmarks[l];
  const Eigen::Matrix3d& factor = landmark_cholesky_[l];
  const double* couplings = couplings_.data() + coupling_begin_[l];
  const int rows = 6 * place.entries + kTail;
  whitened_.resize(static_cast<std::size_t>(rows * kDimension));
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, kDimension>> all(whitened_.data(), rows,
                                                                    kDimension);
  const auto fill = [&](auto part, const double* from) {
    using Part = Eigen::Matrix<double, decltype(part)::RowsAtCompileTime, kDimension>;
    Part values = Eigen::Map<const Part>(from);
    for (int j = 0; j < kDimension; ++j) {
      for (int k = 0; k < j; ++k) values.col(j) -= factor(j, k) * values.col(k);
      values.col(j) *= factor(j, j);
    }
    part = values;
  };
  for (int e = 0; e < place.entries; ++e) {
    fill(all.template middleRows<6>(6 * e), couplings + 6 * kDimension * e);
  }
  fill(all.template bottomRows<kTail>(), couplings + 6 * kDimension * place.entries);
}

void LinearSegment::eliminatePoses() {
  const int p = poseColumns();
  poses_inverse_.compute(schur_.topLeftCorner(p, p), kRankTolerance);
  poses_inverse_.whiten(schur_.bottomLeftCorner(tail_, p).transpose(), &whitened_tail_);
  poses_inverse_.unwhiten(whitened_tail_, &solved_tail_);
  reduced_ = schur_.bottomRightCorner(tail_, tail_);
  reduced_.noalias() -= whitened_tail_.transpose() * whitened_tail_;
}

IntrinsicsMatrix LinearSegment::reducedHessian() const {
  return reduced_.topLeftCorner(intrinsics_count_, intrinsics_count_)
      .selfadjointView<Eigen::Lower>();
}

Intrinsics LinearSegment::reducedGradient() const {
  return reduced_.row(tail_ - 1).head(intrinsics_count_).transpose();
}

// L^-T L^-1 (b - W^T x)
Eigen::Vector3d LinearSegment::landmarkStep(std::size_t l,
                                            const Eigen::Ref<const Eigen::VectorXd>& poses,
                                            const Intrinsics& intrinsics) const {
  const SegmentStructure::LandmarkPlace& place = structure_.landmarks[l];
  const Eigen::Matrix3d& factor = landmark_cholesky_[l];
  Eigen::Vector3d step = Eigen::Vector3d::Zero();
  for (int j = 0; j < place.dimension; ++j) {
    const double* tail = landmarkTail(l, j);
    double value = tail[tail_ - 1];
    for (int k = 0; k < intrinsics.size(); ++k) value -= tail[k] * intrinsics(k);
    for (int e = 0; e < place.entries; ++e) {
      value -= landmarkEntry(l, e, j).dot(
          poses.segment<6>(6 * structure_.entry_poses[place.first_entry + e]));
    }
    for (int k = 0; k < j; ++k) value -= factor(j, k) * step(k);
    step(j) = value * factor(j, j);
  }
  for (int j = place.dimension - 1; j >= 0; --j) {
    for (int k = j + 1; k < place.dimension; ++k) step(j) -= factor(k, j) * step(k);
    step(j) *= factor(j, j);
  }
  return step;
}

void LinearSegment::backSubstitute(const Intrinsics& intrinsics_step,
                                   Eigen::Ref<Eigen::VectorXd> own) const {
  auto poses = own.head(poseColumns());
  poses = solved_tail_.col(tail_ - 1);
  poses.noalias() -= solved_tail_.leftCols(intrinsics_count_) * intrinsics_step;
  for (std::size_t l = 0; l < structure_.landmarks.size(); ++l) {
    const SegmentStructure::LandmarkPlace& place = structure_.landmarks[l];
    const Eigen::Vector3d step = landmarkStep(l, poses, intrinsics_step);
    const int first = place.dimension - place.rows();
    for (int j = first; j < place.dimension; ++j) {
      own(poseColumns() + place.row + j - first) = step(j);
    }
  }
}

IntrinsicsMatrix LinearSegment::trackScores() const {
  const int c = intrinsics_count_;
  IntrinsicsMatrix sum = IntrinsicsMatrix::Zero(c, c);
  if (c == 0) return sum;
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(poseColumns());
  for (std::size_t l = 0; l < structure_.landmarks.size(); ++l) {
    const SegmentStructure::LandmarkPlace& place = structure_.landmarks[l];
    const Eigen::Vector3d step = landmarkStep(l, still, Intrinsics::Zero(c));
    // Of the track's share of the gradient, what its landmark leaves over.
    const double* shares = scores_.data() + score_begin_[l];
    Intrinsics score = Eigen::Map<const Eigen::VectorXd>(shares + 6 * place.entries, c);
    for (int j = 0; j < place.dimension; ++j) {
      score -= step(j) * Eigen::Map<const Eigen::VectorXd>(landmarkTail(l, j), c);
    }
    for (int e = 0; e < place.entries; ++e) {
      Vector6d rest = Eigen::Map<const Vector6d>(shares + 6 * e);
      for (int j = 0; j < place.dimension; ++j) rest -= step(j) * landmarkEntry(l, e, j);
      const int at = 6 * structure_.entry_poses[place.first_entry + e];
      score.noalias() -= solved_tail_.block(at, 0, 6, c).transpose() * rest;
    }
    sum += score * score.transpose();
  }
  return sum;
}

}  // namespace camera_self_calibration
