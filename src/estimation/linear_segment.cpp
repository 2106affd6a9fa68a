#include "camera_self_calibration/estimation/linear_segment.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/estimation/robust.h"

namespace camera_self_calibration {
namespace {

constexpr int kMaxLandmarkDimension = 3;
constexpr int kMaxColumns = 12 + kMaxIntrinsics;

// One observation's whitened, weighted residual and Jacobian: the landmark's columns, and those of
// x with their indices in increasing order, so that products fill the lower triangle.
struct Row {
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, kMaxLandmarkDimension> landmark;
  Eigen::Matrix<double, 2, kMaxColumns> x;
  std::array<int, kMaxColumns> column;
  int columns = 0;

  template <typename Block>
  void append(int first_column, const Block& block) {
    for (int i = 0; i < block.cols(); ++i, ++columns) {
      x.col(columns) = block.col(i);
      column[columns] = first_column + i;
    }
  }
};

// The poses' columns in increasing order; those of fixed keyframes are negative. In its own
// reference keyframe a point's pixel does not depend on any pose.
void appendPoses(int reference_column, int observing_column, double scale,
                 const PredictionJacobians& jacobians, Row* row) {
  if (reference_column == observing_column) return;
  const bool reference_first = reference_column < observing_column;
  if (reference_first && reference_column >= 0) {
    row->append(reference_column, scale * jacobians.reference_pose);
  }
  if (observing_column >= 0) row->append(observing_column, scale * jacobians.observing_pose);
  if (!reference_first && reference_column >= 0) {
    row->append(reference_column, scale * jacobians.reference_pose);
  }
}

// Inverse depth if it is free, then the bearing of an inherited landmark.
void setLandmark(const Landmark& landmark, int columns, double scale,
                 const PredictionJacobians& jacobians, Row* row) {
  const int depth_columns = columns % 2;  // 1 or 3: the inverse depth is free
  if (depth_columns > 0) row->landmark.col(0) = scale * jacobians.inverse_depth;
  if (columns >= 2) {
    row->landmark.middleCols<2>(depth_columns) =
        scale * jacobians.ray * tangentBasis(landmark.bearing);
  }
}

int landmarkDimension(const SegmentBlock& block, int landmark) {
  const bool free_depth = landmark != block.fixed_landmark;
  return (block.segment->landmarks[landmark].anchored ? 0 : 2) + (free_depth ? 1 : 0);
}

double unpredictableCost(double sigma, double huber) {
  return huberCost(kUnpredictableResidualPx / sigma, huber);
}

std::vector<PoseMatrices> poseMatrices(const Segment& segment) {
  std::vector<PoseMatrices> poses;
  poses.reserve(segment.keyframes.size());
  for (const Keyframe& keyframe : segment.keyframes) poses.emplace_back(keyframe.world_from_camera);
  return poses;
}

// Lower Cholesky factor of a small damped block; a direction without information keeps a zero row
// of the coupling and a unit pivot, and so does not move.
void factorLandmark(Eigen::Ref<Eigen::MatrixXd> block, double damping) {
  const int n = static_cast<int>(block.cols());
  const double largest = block.diagonal().maxCoeff();
  for (int j = 0; j < n; ++j) {
    const double undamped = block(j, j);
    double pivot = undamped * (1.0 + damping);
    for (int k = 0; k < j; ++k) pivot -= block(j, k) * block(j, k);
    const bool informed = pivot > 1e-13 * undamped && pivot > 1e-24 * largest;
    block(j, j) = informed ? std::sqrt(pivot) : 0.0;
    for (int i = j + 1; i < n; ++i) {
      double value = block(i, j);
      for (int k = 0; k < j; ++k) value -= block(i, k) * block(j, k);
      block(i, j) = informed ? value / block(j, j) : 0.0;
    }
  }
}

// Solves L y = rows in place, with zero pivots giving zero.
template <typename Rows>
void forwardSubstitute(const Eigen::Ref<const Eigen::MatrixXd>& factor, Rows&& rows) {
  for (int i = 0; i < factor.cols(); ++i) {
    for (int k = 0; k < i; ++k) rows.row(i) -= factor(i, k) * rows.row(k);
    rows.row(i) *= factor(i, i) > 0.0 ? 1.0 / factor(i, i) : 0.0;
  }
}

// Solves L^T y = rhs in place.
void backwardSubstitute(const Eigen::Ref<const Eigen::MatrixXd>& factor,
                        Eigen::Ref<Eigen::VectorXd> rhs) {
  for (int i = static_cast<int>(factor.cols()) - 1; i >= 0; --i) {
    for (int k = i + 1; k < factor.cols(); ++k) rhs(i) -= factor(k, i) * rhs(k);
    rhs(i) *= factor(i, i) > 0.0 ? 1.0 / factor(i, i) : 0.0;
  }
}

}  // namespace

void LinearSegment::resize(const SegmentBlock& block, int intrinsics_count) {
  const Segment& segment = *block.segment;
  const int keyframes = static_cast<int>(segment.keyframes.size());
  pose_columns_ = 6 * std::max(0, keyframes - block.fixed_keyframes);
  intrinsics_count_ = intrinsics_count;
  rows_.resize(segment.landmarks.size());
  int rows = 0;
  for (std::size_t l = 0; l < rows_.size(); ++l) {
    rows_[l] = {rows, landmarkDimension(block, static_cast<int>(l))};
    rows += rows_[l].count;
  }
  groupLandmarks(block);
  const int columns = pose_columns_ + intrinsics_count_;
  hessian_.setZero(columns, columns);
  gradient_.setZero(columns);
  track_gradients_.setZero(columns, static_cast<Eigen::Index>(rows_.size()));
  coupling_.setZero(rows, columns);
  landmark_hessian_.setZero(rows, kMaxLandmarkDimension);
  landmark_gradient_.setZero(rows);
  cost_ = 0.0;
}

// Landmarks of one reference keyframe follow each other in a segment and are seen from much the
// same keyframes: long segments stay cheap when each group touches these alone.
void LinearSegment::groupLandmarks(const SegmentBlock& block) {
  const Segment& segment = *block.segment;
  std::vector<int> last(segment.landmarks.size(), -1);  // keyframe
  std::vector<int> first(segment.landmarks.size(), 1 << 20);
  for (const Observation& observation : segment.observations) {
    const int l = observation.landmark;
    last[l] = std::max({last[l], observation.keyframe, segment.landmarks[l].reference});
    first[l] = std::min({first[l], observation.keyframe, segment.landmarks[l].reference});
  }
  groups_.clear();
  int reference = -1;
  for (std::size_t l = 0; l < segment.landmarks.size(); ++l) {
    if (groups_.empty() || segment.landmarks[l].reference != reference) {
      reference = segment.landmarks[l].reference;
      groups_.push_back({rows_[l].row, 0, pose_columns_, 0});
    }
    LandmarkGroup& group = groups_.back();
    group.rows += rows_[l].count;
    if (last[l] < 0) continue;
    const int begin = 6 * std::max(0, first[l] - block.fixed_keyframes);
    const int end = 6 * std::max(0, last[l] + 1 - block.fixed_keyframes);
    group.begin_column = std::min(group.begin_column, begin);
    group.end_column = std::max(group.end_column, end);
  }
  for (LandmarkGroup& group : groups_) {
    group.begin_column = std::min(group.begin_column, group.end_column);
  }
}

void LinearSegment::linearize(const SegmentBlock& block, const Camera& camera, int intrinsics_count,
                              double huber) {
  resize(block, intrinsics_count);
  const Segment& segment = *block.segment;
  poses_ = poseMatrices(segment);
  const std::size_t landmarks = segment.landmarks.size();
  rays_.resize(landmarks);
  ray_jacobians_.resize(landmarks);
  ray_valid_.resize(landmarks);
  for (std::size_t l = 0; l < landmarks; ++l) {
    const Landmark& landmark = segment.landmarks[l];
    ray_valid_[l] = landmarkRay(segment.cameraOf(landmark.reference, camera), landmark, &rays_[l],
                                intrinsics_count > 0 ? &ray_jacobians_[l] : nullptr);
    if (segment.isEarlier(landmark.reference)) ray_jacobians_[l].setZero();
  }
  for (const Observation& observation : segment.observations) {
    addObservation(block, camera, huber, observation);
  }
  gradient_ = track_gradients_.rowwise().sum();
}

void LinearSegment::addObservation(const SegmentBlock& block, const Camera& camera, double huber,
                                   const Observation& observation) {
  const Landmark& landmark = block.segment->landmarks[observation.landmark];
  const double sigma = observation.sigma * block.sigma_scale;
  const Eigen::Vector3d& ray = rays_[observation.landmark];
  const bool with_intrinsics = intrinsics_count_ > 0;
  PredictionJacobians jacobians;
  Eigen::Vector2d prediction;
  const bool earlier = block.segment->isEarlier(observation.keyframe);
  const Camera& seen_with = block.segment->cameraOf(observation.keyframe, camera);
  if (!ray_valid_[observation.landmark] ||
      !predictPixel(seen_with, poses_[landmark.reference], poses_[observation.keyframe], ray,
                    landmark.inverse_depth, with_intrinsics, &prediction, &jacobians)) {
    cost_ += unpredictableCost(sigma, huber);
    return;
  }

  Row row;
  row.residual = (observation.pixel - prediction) / sigma;  // Eq. (2), whitened
  const double norm = row.residual.norm();
  cost_ += huberCost(norm, huber);
  const double weight = std::sqrt(huberWeight(norm, huber));
  const double scale = weight / sigma;
  row.residual *= weight;

  appendPoses(6 * (landmark.reference - block.fixed_keyframes),
              6 * (observation.keyframe - block.fixed_keyframes), scale, jacobians, &row);
  if (with_intrinsics) {
    PixelIntrinsicsJacobian total = jacobians.intrinsics;
    if (earlier) total.setZero();  // held
    if (landmark.anchored) {
      total.noalias() += jacobians.ray * ray_jacobians_[observation.landmark];
    }
    row.append(pose_columns_, scale * total.leftCols(intrinsics_count_));
  }

  const LandmarkRows& rows = rows_[observation.landmark];
  setLandmark(landmark, rows.count, scale, jacobians, &row);
  for (int a = 0; a < row.columns; ++a) {
    const int column_a = row.column[a];
    track_gradients_(column_a, observation.landmark) += row.x.col(a).dot(row.residual);
    for (int b = 0; b <= a; ++b) {
      hessian_(column_a, row.column[b]) += row.x.col(a).dot(row.x.col(b));
    }
  }
  for (int a = 0; a < rows.count; ++a) {
    const int r = rows.row + a;
    landmark_gradient_(r) += row.landmark.col(a).dot(row.residual);
    for (int b = 0; b <= a; ++b) {
      landmark_hessian_(r, b) += row.landmark.col(a).dot(row.landmark.col(b));
    }
    for (int b = 0; b < row.columns; ++b) {
      coupling_(r, row.column[b]) += row.landmark.col(a).dot(row.x.col(b));
    }
  }
}

Eigen::VectorXd LinearSegment::landmarkDiagonal() const {
  Eigen::VectorXd diagonal(landmarkRows());
  for (const LandmarkRows& rows : rows_) {
    for (int i = 0; i < rows.count; ++i) {
      diagonal(rows.row + i) = landmark_hessian_(rows.row + i, i);
    }
  }
  return diagonal;
}

double LinearSegment::curvature(const SegmentStep& step, const Intrinsics& intrinsics) const {
  Eigen::VectorXd x(pose_columns_ + intrinsics_count_);
  x << step.poses, intrinsics.head(intrinsics_count_);
  double sum = x.dot(hessian_.selfadjointView<Eigen::Lower>() * x);
  sum += 2.0 * step.landmarks.dot(coupling_ * x);
  for (const LandmarkRows& rows : rows_) {
    if (rows.count == 0) continue;
    const auto v = step.landmarks.segment(rows.row, rows.count);
    const auto h = landmark_hessian_.block(rows.row, 0, rows.count, rows.count);
    sum += v.dot(h.selfadjointView<Eigen::Lower>() * v);
  }
  return sum;
}

void LinearSegment::eliminate(double damping) {
  eliminateLandmarks(damping);
  eliminatePoses();
}

void LinearSegment::eliminateLandmarks(double damping) {
  landmark_factor_ = landmark_hessian_;
  whitened_coupling_ = coupling_;
  whitened_gradient_ = landmark_gradient_;
  for (const LandmarkRows& rows : rows_) {
    if (rows.count == 0) continue;
    auto factor = landmark_factor_.block(rows.row, 0, rows.count, rows.count);
    factorLandmark(factor, damping);
    forwardSubstitute(factor, whitened_coupling_.middleRows(rows.row, rows.count));
    forwardSubstitute(factor, whitened_gradient_.segment(rows.row, rows.count));
  }
  schur_ = hessian_;
  schur_.diagonal() *= 1.0 + damping;
  for (const LandmarkGroup& group : groups_) {
    if (group.rows > 0) subtractFromSchur(group);  // Eigen's rank update takes no empty matrix
  }
  schur_gradient_.noalias() = gradient_ - whitened_coupling_.transpose() * whitened_gradient_;
}

// S -= U^T U for the rows of one group, which are zero outside its range of poses.
void LinearSegment::subtractFromSchur(const LandmarkGroup& group) {
  const int c = intrinsics_count_;
  const int width = group.end_column - group.begin_column;
  const auto rows = whitened_coupling_.middleRows(group.row, group.rows);
  const auto poses = rows.middleCols(group.begin_column, width);
  const auto intrinsics = rows.rightCols(c);
  if (width > 0) {
    schur_.block(group.begin_column, group.begin_column, width, width)
        .selfadjointView<Eigen::Lower>()
        .rankUpdate(poses.transpose(), -1.0);
  }
  if (c == 0) return;
  schur_.block(pose_columns_, group.begin_column, c, width).noalias() -=
      intrinsics.transpose() * poses;
  schur_.bottomRightCorner(c, c).selfadjointView<Eigen::Lower>().rankUpdate(intrinsics.transpose(),
                                                                            -1.0);
}

void LinearSegment::eliminatePoses() {
  const int p = pose_columns_;
  const int c = intrinsics_count_;
  pose_factor_ = inverseFactor(schur_.topLeftCorner(p, p), kRankTolerance);
  pose_coupling_.noalias() = pose_factor_.transpose() * schur_.bottomLeftCorner(c, p).transpose();
  pose_projection_.noalias() = pose_factor_.transpose() * schur_gradient_.head(p);
  reduced_hessian_ = schur_.bottomRightCorner(c, c).selfadjointView<Eigen::Lower>();
  reduced_hessian_.noalias() -= pose_coupling_.transpose() * pose_coupling_;
  reduced_gradient_ = schur_gradient_.tail(c);
  reduced_gradient_.noalias() -= pose_coupling_.transpose() * pose_projection_;
}

IntrinsicsMatrix LinearSegment::trackScores() const {
  IntrinsicsMatrix sum = IntrinsicsMatrix::Zero(intrinsics_count_, intrinsics_count_);
  for (std::size_t l = 0; l < rows_.size(); ++l) {
    const auto coupling = whitened_coupling_.middleRows(rows_[l].row, rows_[l].count);
    const auto gradient = whitened_gradient_.segment(rows_[l].row, rows_[l].count);
    const Eigen::VectorXd x =
        track_gradients_.col(static_cast<Eigen::Index>(l)) - coupling.transpose() * gradient;
    const Intrinsics score =
        x.tail(intrinsics_count_) -
        pose_coupling_.transpose() * (pose_factor_.transpose() * x.head(pose_columns_));
    sum += score * score.transpose();
  }
  return sum;
}

SegmentStep LinearSegment::backSubstitute(const Intrinsics& intrinsics_step) const {
  SegmentStep step;
  Eigen::VectorXd x(pose_columns_ + intrinsics_count_);
  step.poses = pose_factor_ * (pose_projection_ - pose_coupling_ * intrinsics_step);
  x << step.poses, intrinsics_step;
  step.landmarks = whitened_gradient_ - whitened_coupling_ * x;
  for (const LandmarkRows& rows : rows_) {
    if (rows.count == 0) continue;
    backwardSubstitute(landmark_factor_.block(rows.row, 0, rows.count, rows.count),
                       step.landmarks.segment(rows.row, rows.count));
  }
  return step;
}

Eigen::MatrixXd inverseFactor(const Eigen::MatrixXd& matrix, double rank_tolerance) {
  const Eigen::Index n = matrix.rows();
  if (n == 0) return Eigen::MatrixXd(0, 0);
  const Eigen::VectorXd scale = matrix.diagonal().unaryExpr(&inverseRoot);
  const Eigen::MatrixXd scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> cholesky(scaled);
  // Squared pivots bound the eigenvalues from above; a margin keeps nearly singular systems out.
  if (cholesky.info() == Eigen::Success &&
      cholesky.matrixLLT().diagonal().minCoeff() > 1e2 * std::sqrt(rank_tolerance)) {
    Eigen::MatrixXd factor = scale.asDiagonal();
    cholesky.matrixL().solveInPlace(factor);  // L^-1 D
    return factor.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const double threshold = rank_tolerance * eigen.eigenvalues()(n - 1);
  Eigen::Index first = 0;
  while (first < n && eigen.eigenvalues()(first) <= threshold) ++first;
  return scale.asDiagonal() * eigen.eigenvectors().rightCols(n - first) *
         eigen.eigenvalues().tail(n - first).cwiseSqrt().cwiseInverse().asDiagonal();
}

double robustCost(const SegmentBlock& block, const Camera& camera, double huber) {
  const Segment& segment = *block.segment;
  const std::vector<PoseMatrices> poses = poseMatrices(segment);
  double cost = 0.0;
  int ray_landmark = -1;
  bool ray_valid = false;
  Eigen::Vector3d ray;
  for (const Observation& observation : segment.observations) {
    const Landmark& landmark = segment.landmarks[observation.landmark];
    if (observation.landmark != ray_landmark) {
      ray_landmark = observation.landmark;
      ray_valid =
          landmarkRay(segment.cameraOf(landmark.reference, camera), landmark, &ray, nullptr);
    }
    const double sigma = observation.sigma * block.sigma_scale;
    Eigen::Vector2d prediction;
    const Camera& seen_with = segment.cameraOf(observation.keyframe, camera);
    if (ray_valid && predictPixel(seen_with, poses[landmark.reference], poses[observation.keyframe],
                                  ray, landmark.inverse_depth, false, &prediction, nullptr)) {
      cost += huberCost((observation.pixel - prediction).norm() / sigma, huber);
    } else {
      cost += unpredictableCost(sigma, huber);
    }
  }
  return cost;
}

}  // namespace camera_self_calibration
