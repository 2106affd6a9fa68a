// Linearisation: observations into pairs of keyframes, these into the normal equations.

#include "camera_self_calibration/estimation/linear_segment.h"

#include <algorithm>

#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/map/inverse_depth.h"

namespace camera_self_calibration {
namespace {

using Matrix66d = Eigen::Matrix<double, 6, 6>;

// Local columns from a change of the reference keyframe's pose; from one of the observing
// keyframe's it is the identity with the translation's sign changed.
Matrix66d localFromReference(const Eigen::Matrix3d& rotation, const Eigen::Matrix3d& lever) {
  Matrix66d local;
  local << Eigen::Matrix3d::Identity(), lever, Eigen::Matrix3d::Zero(), -rotation;
  return local;
}

// Number of columns of the tail for which there is code: intrinsics, right-hand side, zeros.
int tailColumns(int intrinsics_count) {
  if (intrinsics_count == 0) return 2;
  return intrinsics_count <= 5 ? 6 : 10;
}

}  // namespace

// An observation's whitened, weighted Jacobian and residual, transposed.
template <int kTail>
struct LinearSegment::Row {
  Eigen::Matrix<double, kLocal + kTail, 2> x;  // local columns, tail
  Eigen::Matrix<double, 3, 2> landmark;        // inverse depth, bearing

  Row() {
    x.setZero();
    landmark.setZero();
  }
  auto residual() { return x.template bottomRows<1>().transpose(); }
};

void LinearSegment::linearize(const SegmentBlock& block, const Camera& camera, int intrinsics_count,
                              double huber, bool for_marginal) {
  intrinsics_count_ = intrinsics_count;
  tail_ = tailColumns(intrinsics_count);
  for_marginal_ = for_marginal;
  structure_.build(block);
  layOut();
  relinearize(block, camera, huber);
}

void LinearSegment::relinearize(const SegmentBlock& block, const Camera& camera, double huber) {
  clearSums();
  const double unit = typicalInverseDepth(inverseDepths(*block.segment));
  squared_unit_ = unit * unit;
  prepareFactors(*block.segment, camera);
  if (tail_ == 2) addObservations<2>(block, camera, huber);
  if (tail_ == 6) addObservations<6>(block, camera, huber);
  if (tail_ == 10) addObservations<10>(block, camera, huber);
}

void LinearSegment::layOut() {
  const std::size_t landmarks = structure_.landmarks.size();
  coupling_begin_.resize(landmarks);
  score_begin_.resize(landmarks);
  std::size_t values = 0;
  std::size_t scores = 0;
  for (std::size_t l = 0; l < landmarks; ++l) {
    const SegmentStructure::LandmarkPlace& place = structure_.landmarks[l];
    const auto columns = static_cast<std::size_t>(6 * place.entries + tail_);
    coupling_begin_[l] = values;
    score_begin_[l] = scores;
    values += static_cast<std::size_t>(place.dimension) * columns;
    scores += columns;
  }
  couplings_.resize(values);
  scores_.resize(for_marginal_ ? scores : 0);
}

void LinearSegment::clearSums() {
  std::fill(couplings_.begin(), couplings_.end(), 0.0);
  std::fill(scores_.begin(), scores_.end(), 0.0);
  landmark_hessian_.assign(structure_.landmarks.size(), Eigen::Matrix3d::Zero());
  held_landmark_.setZero();
  translation_views_.assign(for_marginal_ ? structure_.observations.size() : 0, Matrix32d::Zero());
  const auto values = static_cast<std::size_t>((kLocal + tail_) * kLocal);
  pair_products_.assign(structure_.pairs.size() * values, 0.0);
  normal_.setZero(poseColumns() + tail_, poseColumns() + tail_);
}

void LinearSegment::prepareFactors(const Segment& segment, const Camera& camera) {
  transfers_.reset(segment);
  pair_factors_.resize(structure_.pairs.size());
  for (std::size_t p = 0; p < pair_factors_.size(); ++p) {
    const SegmentStructure::Pair& pair = structure_.pairs[p];
    const PoseMatrices& reference = transfers_.poses()[pair.reference];
    const PoseMatrices& observing = transfers_.poses()[pair.observing];
    PairFactors& factors = pair_factors_[p];
    factors.transfer = transferBetween(reference, observing);
    factors.same = pair.reference == pair.observing;
    factors.observing_from_world = observing.rotation.transpose();
    factors.lever.noalias() = skew(reference.position - observing.position) * reference.rotation;
  }
  landmark_factors_.resize(segment.landmarks.size());
  for (std::size_t l = 0; l < landmark_factors_.size(); ++l) {
    const Landmark& landmark = segment.landmarks[l];
    LandmarkFactors& factors = landmark_factors_[l];
    factors.has_ray =
        landmarkRay(segment.cameraOf(landmark.reference, camera), landmark, &factors.ray,
                    intrinsics_count_ > 0 ? &factors.d_intrinsics : nullptr);
    if (segment.isLensHeld(landmark.reference)) factors.d_intrinsics.setZero(3, intrinsics_count_);
    if (!landmark.anchored) factors.basis = tangentBasis(landmark.bearing);
  }
}

template <int kTail>
void LinearSegment::addObservations(const SegmentBlock& block, const Camera& camera, double huber) {
  using Product = Eigen::Matrix<double, kLocal + kTail, kLocal>;
  const Segment& segment = *block.segment;
  Eigen::Matrix<double, kTail, kTail> tail_product = Eigen::Matrix<double, kTail, kTail>::Zero();
  cost_ = 0.0;
  Row<kTail> row;
  for (std::size_t o = 0; o < segment.observations.size(); ++o) {
    Observation observation = segment.observations[o];
    observation.sigma *= block.sigma_scale;
    const Landmark& landmark = segment.landmarks[observation.landmark];
    const SegmentStructure::ObservationPlace& place = structure_.observations[o];
    if (!linearizeRow(observation, segment, pair_factors_[place.pair], camera, huber, &row)) {
      cost_ += unpredictableCost(observation.sigma, huber);
      continue;
    }
    if (for_marginal_) translation_views_[o] = row.x.template topRows<3>();
    const auto offset = static_cast<std::size_t>(place.pair) * Product::SizeAtCompileTime;
    const auto tail = row.x.template bottomRows<kTail>();
    // Eigen would call its kernel for large matrices.
    Eigen::Map<Product>(pair_products_.data() + offset) +=
        row.x.lazyProduct(row.x.template topRows<kLocal>().transpose());
    tail_product += tail.lazyProduct(tail.transpose());
    if (landmark.anchored) {
      addToLandmark<kTail, 1>(place, observation.landmark, row);
    } else {
      addToLandmark<kTail, 3>(place, observation.landmark, row);
    }
  }
  normal_.template bottomRightCorner<kTail, kTail>() = tail_product;
  for (std::size_t p = 0; p < structure_.pairs.size(); ++p) {
    expandPair<kTail>(block.fixed_keyframes, p);
  }
  addInverseDepthPrior(segment, block.inverse_depth_prior);
}

void LinearSegment::addInverseDepthPrior(const Segment& segment, const InverseDepthPrior& prior) {
  const double weight = prior.weight();
  if (weight == 0.0) return;
  cost_ += prior.cost(segment);
  for (std::size_t l = 0; l < structure_.landmarks.size(); ++l) {
    const SegmentStructure::LandmarkPlace& place = structure_.landmarks[l];
    if (place.inverse_depth_fixed) continue;
    landmark_hessian_[l](0, 0) += weight;
    double* tail = couplings_.data() + coupling_begin_[l] + 6 * place.entries * place.dimension;
    tail[tail_ - 1] += weight * (prior.mean - segment.landmarks[l].inverse_depth);
  }
}

// False, and nothing changed, where there is no prediction.
template <int kTail>
bool LinearSegment::linearizeRow(const Observation& observation, const Segment& segment,
                                 const PairFactors& pair, const Camera& camera, double huber,
                                 Row<kTail>* row) {
  const Landmark& landmark = segment.landmarks[observation.landmark];
  const LandmarkFactors& point = landmark_factors_[observation.landmark];
  if (!point.has_ray) return false;
  const Eigen::Vector3d in_camera = pair.transfer(point.ray, landmark.inverse_depth);  // Eq. (1)
  Eigen::Vector2d prediction;
  Matrix23d d_point;
  PixelIntrinsicsJacobian d_intrinsics;
  const Camera& seen_with = segment.cameraOf(observation.keyframe, camera);
  if (!seen_with.project(in_camera, &prediction, &d_point, kTail > 2 ? &d_intrinsics : nullptr)) {
    return false;
  }
  if (segment.isLensHeld(observation.keyframe)) d_intrinsics.setZero(2, intrinsics_count_);
  // Eq. (2), whitened
  const Eigen::Vector2d residual = (observation.pixel - prediction) / observation.sigma;
  const HuberLoss loss(residual.squaredNorm(), huber);
  cost_ += loss.cost;
  row->residual() = loss.root_weight * residual;
  const double scale = loss.root_weight / observation.sigma;
  d_point *= scale;

  if (pair.same) {  // its pixel does not depend on any pose, nor on its depth
    row->x.template topRows<kLocal>().setZero();
  } else {
    const Matrix23d d_world = d_point * pair.observing_from_world;
    row->x.template topRows<3>() = landmark.inverse_depth * d_world.transpose();
    // Row by row, a^T skew(b) = (a x b)^T.
    for (int i = 0; i < 2; ++i) {
      row->x.template block<3, 1>(3, i) = d_point.row(i).transpose().cross(in_camera);
    }
  }
  row->landmark.row(0) = (d_point * pair.transfer.translation).transpose();
  if (kTail == 2 && landmark.anchored) return true;
  const Matrix23d d_ray = d_point * pair.transfer.rotation;
  if (!landmark.anchored) {
    row->landmark.template bottomRows<2>() = (d_ray * point.basis).transpose();
  }
  for (int k = 0; k < intrinsics_count_; ++k) {
    Eigen::Vector2d column = scale * d_intrinsics.col(k);
    if (landmark.anchored) column += d_ray * point.d_intrinsics.col(k);
    row->x.row(kLocal + k) = column.transpose();
  }
  return true;
}

template <int kTail, int kDimension>
void LinearSegment::addToLandmark(const SegmentStructure::ObservationPlace& place, int landmark,
                                  const Row<kTail>& row) {
  const SegmentStructure::LandmarkPlace& landmark_place = structure_.landmarks[landmark];
  Eigen::Matrix<double, kDimension, 2> own = row.landmark.template topRows<kDimension>();
  if (landmark_place.inverse_depth_fixed) {
    held_landmark_.template topLeftCorner<kDimension, kDimension>() +=
        own.lazyProduct(own.transpose());
    own.row(0).setZero();
  }
  landmark_hessian_[landmark].template topLeftCorner<kDimension, kDimension>() +=
      own.lazyProduct(own.transpose());
  const Eigen::Matrix<double, kLocal + kTail, kDimension> coupling =
      row.x.lazyProduct(own.transpose());
  addCoupling<kTail, kDimension>(place, landmark_place, coupling,
                                 couplings_.data() + coupling_begin_[landmark]);
  if (!for_marginal_) return;
  const Eigen::Matrix<double, kLocal + kTail, 1> share =
      row.x * row.x.template bottomRows<1>().transpose();
  addCoupling<kTail, 1>(place, landmark_place, share, scores_.data() + score_begin_[landmark]);
}

// From local columns to those of the two poses.
template <int kTail, int kDimension>
void LinearSegment::addCoupling(const SegmentStructure::ObservationPlace& place,
                                const SegmentStructure::LandmarkPlace& landmark,
                                const Eigen::Matrix<double, kLocal + kTail, kDimension>& coupling,
                                double* values) const {
  using Entry = Eigen::Map<Eigen::Matrix<double, 6, kDimension>>;
  const auto translation = coupling.template topRows<3>();
  const auto rotation = coupling.template middleRows<3>(3);
  const PairFactors& pair = pair_factors_[place.pair];
  if (place.entry >= 0) {
    Entry entry(values + (place.entry - landmark.first_entry) * 6 * kDimension);
    entry.template topRows<3>() -= translation;
    entry.template bottomRows<3>() += rotation;
  }
  if (landmark.reference_free && !pair.same) {
    Entry entry(values);
    entry.template topRows<3>() += translation;
    entry.template bottomRows<3>() +=
        pair.lever.transpose() * translation - pair.transfer.rotation.transpose() * rotation;
  }
  Eigen::Map<Eigen::Matrix<double, kTail, kDimension>> tail(values +
                                                            landmark.entries * 6 * kDimension);
  tail += coupling.template bottomRows<kTail>();
}

template <int kTail>
void LinearSegment::expandPair(int fixed_keyframes, std::size_t p) {
  using Product = Eigen::Matrix<double, kLocal + kTail, kLocal>;
  const Eigen::Map<const Product> product(pair_products_.data() + p * Product::SizeAtCompileTime);
  const int last = poseColumns();
  const PairFactors& factors = pair_factors_[p];
  if (factors.same) return;
  const int r = 6 * (structure_.pairs[p].reference - fixed_keyframes);
  const int i = 6 * (structure_.pairs[p].observing - fixed_keyframes);
  const Matrix66d local = product.template topRows<6>();
  const Eigen::Matrix<double, kTail, 6> tail = product.template bottomRows<kTail>();
  const Matrix66d reference = localFromReference(factors.transfer.rotation, factors.lever);
  if (r >= 0) {
    const Matrix66d half = local.lazyProduct(reference);
    normal_.block<6, 6>(r, r).noalias() += reference.transpose().lazyProduct(half);
    normal_.template block<kTail, 6>(last, r).noalias() += tail.lazyProduct(reference);
    if (i >= 0) {
      Matrix66d cross = half;
      cross.topRows<3>() *= -1.0;
      if (i > r) {
        normal_.block<6, 6>(i, r) += cross;
      } else {
        normal_.block<6, 6>(r, i) += cross.transpose();
      }
    }
  }
  if (i >= 0) {
    Matrix66d own = local;
    own.topRightCorner<3, 3>() *= -1.0;
    own.bottomLeftCorner<3, 3>() *= -1.0;
    normal_.block<6, 6>(i, i) += own;
    normal_.template block<kTail, 3>(last, i) -= tail.template leftCols<3>();
    normal_.template block<kTail, 3>(last, i + 3) += tail.template rightCols<3>();
  }
}

void LinearSegment::copyGradient(Eigen::Ref<Eigen::VectorXd> own) const {
  const int last = poseColumns() + tail_ - 1;
  own.head(poseColumns()) = normal_.row(last).head(poseColumns()).transpose();
  for (std::size_t l = 0; l < structure_.landmarks.size(); ++l) {
    const SegmentStructure::LandmarkPlace& place = structure_.landmarks[l];
    const int first = place.dimension - place.rows();
    for (int j = first; j < place.dimension; ++j) {
      own(poseColumns() + place.row + j - first) = landmarkTail(l, j)[tail_ - 1];
    }
  }
}

void LinearSegment::copyDiagonal(Eigen::Ref<Eigen::VectorXd> own) const {
  own.head(poseColumns()) = normal_.diagonal().head(poseColumns());
  for (std::size_t l = 0; l < structure_.landmarks.size(); ++l) {
    const SegmentStructure::LandmarkPlace& place = structure_.landmarks[l];
    const int first = place.dimension - place.rows();
    for (int j = first; j < place.dimension; ++j) {
      own(poseColumns() + place.row + j - first) = landmark_hessian_[l](j, j);
    }
  }
}

Intrinsics LinearSegment::intrinsicsGradient() const {
  const int last = poseColumns() + tail_ - 1;
  return normal_.row(last).segment(poseColumns(), intrinsics_count_).transpose();
}

Intrinsics LinearSegment::intrinsicsDiagonal() const {
  return normal_.diagonal().segment(poseColumns(), intrinsics_count_);
}

double LinearSegment::curvature(const Eigen::Ref<const Eigen::VectorXd>& own,
                                const Intrinsics& intrinsics) const {
  const int c = intrinsics_count_;
  const int columns = poseColumns() + c;
  Eigen::VectorXd x(columns);
  x << own.head(poseColumns()), intrinsics.head(c);
  double sum = x.dot(normal_.topLeftCorner(columns, columns).selfadjointView<Eigen::Lower>() * x);
  for (std::size_t l = 0; l < structure_.landmarks.size(); ++l) {
    const SegmentStructure::LandmarkPlace& place = structure_.landmarks[l];
    const int first = place.dimension - place.rows();
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    v.segment(first, place.rows()) = own.segment(poseColumns() + place.row, place.rows());
    sum += v.dot(landmark_hessian_[l].selfadjointView<Eigen::Lower>() * v);
    for (int j = first; j < place.dimension; ++j) {
      double coupled = Eigen::Map<const Eigen::VectorXd>(landmarkTail(l, j), c).dot(x.tail(c));
      for (int e = 0; e < place.entries; ++e) {
        coupled += landmarkEntry(l, e, j).dot(
            x.segment<6>(6 * structure_.entry_poses[place.first_entry + e]));
      }
      sum += 2.0 * v(j) * coupled;
    }
  }
  return sum;
}

}  // namespace camera_self_calibration
