// Nested elimination: landmarks, then poses; and back.

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "camera_self_calibration/estimation/linear_segment.h"

namespace camera_self_calibration {
namespace {

constexpr int kPanelColumns = 24;  // of landmarks that are eliminated together

// Lower Cholesky factor of a landmark's damped block, with the reciprocals of the pivots on its
// diagonal; a direction without information has a zero there, and so does not move: a bearing that
// the depth explains, or a depth whose parallax is rounding, whatever the map's unit. `unit`: of
// inverse depths, squared.
Eigen::Matrix3d landmarkCholesky(const Eigen::Matrix3d& hessian, int dimension, double unit,
                                 double damping) {
  Eigen::Matrix3d factor = Eigen::Matrix3d::Zero();
  const double bearing = dimension > 1 ? hessian.diagonal().tail<2>().maxCoeff() : 0.0;
  for (int j = 0; j < dimension; ++j) {
    double pivot = hessian(j, j) * (1.0 + damping);
    for (int k = 0; k < j; ++k) pivot -= factor(j, k) * factor(j, k);
    if (!(pivot > 1e-13 * hessian(j, j))) continue;
    if (j == 0 && !(unit * pivot > 1e-24 * bearing)) continue;
    factor(j, j) = 1.0 / std::sqrt(pivot);
    for (int i = j + 1; i < dimension; ++i) {
      double value = hessian(i, j);
      for (int k = 0; k < j; ++k) value -= factor(i, k) * factor(j, k);
      factor(i, j) = value * factor(j, j);
    }
  }
  return factor;
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

// S -= U U^T with U = W L^-T, W the landmarks' couplings to the poses that see them and to the
// tail. Landmarks that are seen by about the same poses follow each other: as many at a time as a
// panel holds.
template <int kTail>
void LinearSegment::eliminateLandmarks(double damping) {
  landmark_cholesky_.resize(structure_.landmarks.size());
  const std::vector<int>& order = structure_.elimination_order;
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    int first = structure_.free_poses, last = -1;
    int columns = 0;
    for (; end < order.size(); ++end) {
      const SegmentStructure::LandmarkPlace& place = structure_.landmarks[order[end]];
      if (columns + place.dimension > kPanelColumns) break;
      columns += place.dimension;
      first = std::min(first, place.first_pose);
      last = std::max(last, place.last_pose);
    }
    const int poses = std::max(0, last - first + 1);
    panel_.reset(6 * poses + kTail, columns);
    columns = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const auto l = static_cast<std::size_t>(order[i]);
      const int dimension = structure_.landmarks[l].dimension;
      landmark_cholesky_[l] =
          landmarkCholesky(landmark_hessian_[l], dimension, squared_unit_, damping);
      if (dimension == 1) {
        whiten<kTail, 1>(l, first, poses, columns);
      } else {
        whiten<kTail, 3>(l, first, poses, columns);
      }
      columns += dimension;
    }
    panel_.multiply();
    subtractProduct(first, poses);
  }
}

// U of one landmark, one column for each of its dimensions: rows of the poses from `first` on, then
// of the tail.
template <int kTail, int kDimension>
void LinearSegment::whiten(std::size_t l, int first, int poses, int column) {
  const SegmentStructure::LandmarkPlace& place = structure_.landmarks[l];
  const Eigen::Matrix3d& factor = landmark_cholesky_[l];
  const double* couplings = couplings_.data() + coupling_begin_[l];
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, kDimension>> all(panel_.column(column),
                                                                    panel_.pitch(), kDimension);
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
    const int pose = structure_.entry_poses[place.first_entry + e];
    fill(all.template middleRows<6>(6 * (pose - first)), couplings + 6 * kDimension * e);
  }
  fill(all.template middleRows<kTail>(6 * poses), couplings + 6 * kDimension * place.entries);
}

// From the lower triangle.
void LinearSegment::subtractProduct(int first, int poses) {
  using Column = Eigen::Map<const Eigen::VectorXd>;
  const int rows = 6 * poses;
  for (int c = 0; c < rows + tail_; ++c) {
    auto target = schur_.col(c < rows ? 6 * first + c : poseColumns() + c - rows);
    const int row = std::max(c, rows);  // of the tail
    target.tail(rows + tail_ - row) -= Column(panel_.product(c) + row, rows + tail_ - row);
    if (c < rows)
      target.segment(6 * first + c, rows - c) -= Column(panel_.product(c) + c, rows - c);
  }
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

void LinearSegment::crossPoses(const Eigen::MatrixXd& columns, Eigen::MatrixXd* among_poses,
                               Eigen::MatrixXd* to_intrinsics) const {
  Eigen::MatrixXd whitened;
  poses_inverse_.whiten(columns, &whitened);
  const auto own = static_cast<int>(whitened.cols());
  Panel panel;  // all products at once
  panel.reset(own + intrinsics_count_, static_cast<int>(whitened.rows()));
  for (Eigen::Index c = 0; c < whitened.rows(); ++c) {
    Eigen::Map<Eigen::RowVectorXd> column(panel.column(static_cast<int>(c)),
                                          own + intrinsics_count_);
    column << whitened.row(c), whitened_tail_.row(c).head(intrinsics_count_);
  }
  panel.multiply();
  using Product = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
  const Product product(panel.product(0), own + intrinsics_count_, own,
                        Eigen::OuterStride<>(panel.pitch()));
  *among_poses = product.topRows(own).selfadjointView<Eigen::Lower>();
  *to_intrinsics = product.bottomRows(intrinsics_count_);
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
