#include "camera_self_calibration/model_choice/displacement_marginal.h"

#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "camera_self_calibration/base/parallel.h"
#include "camera_self_calibration/estimation/linear_segment.h"
#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/estimation/pseudo_inverse.h"
#include "camera_self_calibration/estimation/robust.h"

namespace camera_self_calibration {
namespace {

constexpr int kPose = 6;
constexpr double kLeastPivot = 1e-13;  // of a landmark: below, its other variables explain this one

// d ray / d pixel: the change of a unit ray that moves its pixel so, and stays of unit length.
bool rayOfPixel(const Camera& camera, const Eigen::Vector3d& ray, Matrix32d* d_pixel) {
  Eigen::Vector2d pixel;
  Matrix23d j;
  if (!camera.project(ray, &pixel, &j)) return false;
  *d_pixel = j.transpose() * (j * j.transpose()).inverse();
  return true;
}

// What one segment's observations say, track by track.
class BlockLinearization {
 public:
  BlockLinearization(const SegmentBlock& block, const Camera& camera, double huber)
      : block_(block),
        segment_(*block.segment),
        camera_(camera),
        huber_(huber),
        basis_(camera.width(), camera.height()),
        intrinsics_(camera.estimatedCount()),
        shared_(intrinsics_ + DisplacementBasis::kCount),
        poses_(kPose *
               std::max(0, static_cast<int>(segment_.keyframes.size()) - block.fixed_keyframes)) {
    for (const Keyframe& keyframe : segment_.keyframes) {
      matrices_.emplace_back(keyframe.world_from_camera);
    }
    const int columns = poses_ + shared_ + 1;
    normal_.setZero(columns, columns);
    first_column_.assign(segment_.keyframes.size(), -1);
  }

  void run();

  DisplacementMarginal::System share;
  Eigen::MatrixXd track_scores;
  double cost = 0.0;
  int observations = 0;
  int variables = 0;

 private:
  // A track's reduced gradient, by poses and shared unknowns.
  struct TrackGradient {
    std::vector<int> keyframes;
    Eigen::VectorXd values;
  };

  int poseColumn(int keyframe) const { return kPose * (keyframe - block_.fixed_keyframes); }
  void addTrack(std::size_t first, std::size_t last);
  bool linearize(const Observation& observation, Eigen::Index row);
  void layOut(std::size_t first, std::size_t last);
  void eliminateLandmark();
  void scatter();
  void eliminatePoses();

  const SegmentBlock& block_;
  const Segment& segment_;
  const Camera& camera_;
  const double huber_;
  const DisplacementBasis basis_;
  const int intrinsics_;
  const int shared_;
  const int poses_;
  std::vector<PoseMatrices> matrices_;
  Eigen::MatrixXd normal_;  // poses, shared, right-hand side; lower triangle
  std::vector<TrackGradient> gradients_;

  // Of the track at hand: its landmark, and what its rows have.
  const Landmark* landmark_ = nullptr;
  int dimension_ = 0;  // of the landmark's free variables
  bool inverse_depth_held_ = false;
  Eigen::Vector3d ray_;
  RayIntrinsicsJacobian d_ray_;
  Matrix32d tangent_;
  Eigen::Matrix<double, 3, DisplacementBasis::kCount> ray_displacement_;
  std::vector<int> keyframes_;     // free ones that it touches
  std::vector<int> first_column_;  // per keyframe, in rows_; -1: it is held
  Eigen::MatrixXd rows_;           // landmark, poses, shared, residual
  Eigen::MatrixXd product_;
};

void BlockLinearization::layOut(std::size_t first, std::size_t last) {
  keyframes_.clear();
  const auto touch = [this](int keyframe) {
    if (keyframe < block_.fixed_keyframes) return;
    if (std::find(keyframes_.begin(), keyframes_.end(), keyframe) != keyframes_.end()) return;
    keyframes_.push_back(keyframe);
  };
  touch(landmark_->reference);
  for (std::size_t o = first; o < last; ++o) touch(segment_.observations[o].keyframe);
  std::sort(keyframes_.begin(), keyframes_.end());
  std::fill(first_column_.begin(), first_column_.end(), -1);
  int column = dimension_;
  for (const int keyframe : keyframes_) {
    first_column_[static_cast<std::size_t>(keyframe)] = column;
    column += kPose;
  }
  rows_.setZero(2 * static_cast<Eigen::Index>(last - first), column + shared_ + 1);
}

bool BlockLinearization::linearize(const Observation& observation, Eigen::Index row) {
  const double sigma = observation.sigma * block_.sigma_scale;
  Eigen::Vector2d prediction;
  PredictionJacobians j;
  const auto reference = static_cast<std::size_t>(landmark_->reference);
  const auto observing = static_cast<std::size_t>(observation.keyframe);
  if (!predictPixel(segment_.cameraOf(observation.keyframe, camera_), matrices_[reference],
                    matrices_[observing], ray_, landmark_->inverse_depth, true, &prediction, &j)) {
    return false;
  }
  const Eigen::Vector2d residual = (observation.pixel - prediction) / sigma;
  const HuberLoss loss(residual.squaredNorm(), huber_);
  cost += loss.cost;
  const double scale = loss.root_weight / sigma;
  auto rows = rows_.middleRows<2>(row);
  int column = 0;
  if (!inverse_depth_held_) rows.col(column++) = scale * j.inverse_depth;
  if (!landmark_->anchored) rows.middleCols<2>(column) = scale * j.ray * tangent_;
  // A keyframe that observes its own landmark: both parts cancel.
  if (first_column_[observing] >= 0) {
    rows.middleCols<kPose>(first_column_[observing]) += scale * j.observing_pose;
  }
  if (first_column_[reference] >= 0) {
    rows.middleCols<kPose>(first_column_[reference]) += scale * j.reference_pose;
  }
  const Eigen::Index shared = rows_.cols() - shared_ - 1;
  auto displaced = rows.middleCols(shared + intrinsics_, DisplacementBasis::kCount);
  if (!segment_.isLensHeld(observation.keyframe)) {
    rows.middleCols(shared, intrinsics_) = scale * j.intrinsics.leftCols(intrinsics_);
    // Not where the feature was observed: what noise does to a displacement there goes with the
    // residual, so that the gradient would gain a trace of d displacement / d pixel with each
    // observation. Where the motion hardly shows a displacement, that is many sigmas.
    displaced = scale * basis_.at(prediction);
  }
  if (landmark_->anchored && !segment_.isLensHeld(landmark_->reference)) {
    rows.middleCols(shared, intrinsics_) += scale * j.ray * d_ray_.leftCols(intrinsics_);
    displaced -= scale * j.ray * ray_displacement_;
  }
  rows.rightCols<1>() = loss.root_weight * residual;
  return true;
}

void BlockLinearization::eliminateLandmark() {
  const Eigen::Index size = rows_.cols();
  product_.setZero(size, size);
  product_.selfadjointView<Eigen::Lower>().rankUpdate(rows_.transpose());
  const Eigen::VectorXd diagonal = product_.diagonal().head(dimension_);
  for (int d = 0; d < dimension_; ++d) {
    const double pivot = product_(d, d);
    if (!(pivot > kLeastPivot * diagonal(d))) continue;
    const Eigen::VectorXd column = product_.col(d).tail(size - d - 1);
    product_.bottomRightCorner(size - d - 1, size - d - 1)
        .selfadjointView<Eigen::Lower>()
        .rankUpdate(column, -1.0 / pivot);
  }
}

// From the track's columns to the segment's.
void BlockLinearization::scatter() {
  const int tail = shared_ + 1;
  const auto count = static_cast<int>(keyframes_.size());
  const auto own = [this](int k) { return dimension_ + kPose * k; };
  for (int a = 0; a < count; ++a) {
    const int column = poseColumn(keyframes_[static_cast<std::size_t>(a)]);
    for (int b = a; b < count; ++b) {
      const int row = poseColumn(keyframes_[static_cast<std::size_t>(b)]);
      normal_.block<kPose, kPose>(row, column) += product_.block<kPose, kPose>(own(b), own(a));
    }
    normal_.block(poses_, column, tail, kPose) += product_.block(own(count), own(a), tail, kPose);
  }
  normal_.bottomRightCorner(tail, tail) += product_.bottomRightCorner(tail, tail);
  const Eigen::Index last = product_.rows() - 1;
  gradients_.push_back(
      {keyframes_, product_.row(last).segment(dimension_, last - dimension_).transpose()});
}

void BlockLinearization::addTrack(std::size_t first, std::size_t last) {
  const int index = segment_.observations[first].landmark;
  landmark_ = &segment_.landmarks[static_cast<std::size_t>(index)];
  const Camera& seen_with = segment_.cameraOf(landmark_->reference, camera_);
  if (!landmarkRay(seen_with, *landmark_, &ray_, &d_ray_)) return;
  if (landmark_->anchored) {
    Matrix32d d_pixel;
    if (!rayOfPixel(seen_with, ray_, &d_pixel)) return;
    ray_displacement_ = d_pixel * basis_.at(landmark_->reference_pixel);
  } else {
    tangent_ = tangentBasis(landmark_->bearing);
  }
  inverse_depth_held_ = index == block_.fixed_landmark;
  dimension_ = (inverse_depth_held_ ? 0 : 1) + (landmark_->anchored ? 0 : 2);
  layOut(first, last);
  Eigen::Index row = 0;
  for (std::size_t o = first; o < last; ++o) {
    if (linearize(segment_.observations[o], row)) row += 2;
  }
  if (row == 0 || !rows_.allFinite()) return;
  observations += static_cast<int>(row / 2);
  variables += dimension_;
  eliminateLandmark();
  scatter();
}

void BlockLinearization::eliminatePoses() {
  PseudoInverse inverse;
  inverse.compute(normal_.topLeftCorner(poses_, poses_), LinearSegment::kRankTolerance);
  const Eigen::MatrixXd coupling = normal_.bottomLeftCorner(shared_ + 1, poses_).transpose();
  const Eigen::MatrixXd solved = inverse.solve(coupling);
  Eigen::MatrixXd reduced =
      normal_.bottomRightCorner(shared_ + 1, shared_ + 1).selfadjointView<Eigen::Lower>();
  reduced.noalias() -= coupling.transpose() * solved;
  share.information = reduced.topLeftCorner(shared_, shared_);
  share.gradient = reduced.col(shared_).head(shared_);
  Eigen::MatrixXd scores(shared_, static_cast<Eigen::Index>(gradients_.size()));
  for (std::size_t t = 0; t < gradients_.size(); ++t) {
    const TrackGradient& track = gradients_[t];
    auto score = scores.col(static_cast<Eigen::Index>(t));
    score = track.values.tail(shared_);
    for (std::size_t k = 0; k < track.keyframes.size(); ++k) {
      score.noalias() -=
          solved.block(poseColumn(track.keyframes[k]), 0, kPose, shared_).transpose() *
          track.values.segment<kPose>(kPose * static_cast<Eigen::Index>(k));
    }
  }
  track_scores.setZero(shared_, shared_);
  track_scores.selfadjointView<Eigen::Lower>().rankUpdate(scores);
  variables += poses_;
}

void BlockLinearization::run() {
  const std::vector<Observation>& all = segment_.observations;
  for (std::size_t first = 0; first < all.size();) {
    std::size_t last = first + 1;
    while (last < all.size() && all[last].landmark == all[first].landmark) ++last;
    addTrack(first, last);
    first = last;
  }
  eliminatePoses();
}

}  // namespace

DisplacementMarginal displacementMarginal(const Problem& problem, double huber, int threads) {
  std::vector<BlockLinearization> blocks;
  blocks.reserve(problem.blocks.size());
  for (const SegmentBlock& block : problem.blocks) {
    blocks.emplace_back(block, *problem.camera, huber);
  }
  parallelFor(threads, static_cast<int>(blocks.size()),
              [&blocks](int i) { blocks[static_cast<std::size_t>(i)].run(); });
  const int shared = problem.camera->estimatedCount() + DisplacementBasis::kCount;
  DisplacementMarginal marginal;
  marginal.sum = {Eigen::MatrixXd::Zero(shared, shared), Eigen::VectorXd::Zero(shared)};
  marginal.track_scores.setZero(shared, shared);
  marginal.variables = problem.camera->estimatedCount();  // the residuals know no displacement
  for (BlockLinearization& block : blocks) {
    marginal.sum.information += block.share.information;
    marginal.sum.gradient += block.share.gradient;
    marginal.track_scores += block.track_scores;
    marginal.cost += block.cost;
    marginal.observations += block.observations;
    marginal.variables += block.variables;
    marginal.shares.push_back(std::move(block.share));
  }
  marginal.track_scores = Eigen::MatrixXd(marginal.track_scores.selfadjointView<Eigen::Lower>());
  const int freedom = marginal.freedom();
  if (freedom > 0) marginal.track_scores *= 2.0 * marginal.observations / freedom;
  return marginal;
}

int DisplacementMarginal::freedom() const { return 2 * observations - variables; }

double DisplacementMarginal::residualVariance() const {
  return freedom() > 0 ? 2.0 * cost / freedom() : 1.0;
}

}  // namespace camera_self_calibration
