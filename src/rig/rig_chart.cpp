#include "rig_chart.h"

#include <Eigen/Core>
#include <cmath>

#include "camera_self_calibration/base/decompositions.h"
#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

// Sigmas from zero at which a distance counts as seen.
constexpr double kSignificant = 3.0;

// Units of the estimated intrinsics: what a coordinate of 1 means.
Eigen::VectorXd unitsOf(const Camera& camera) {
  Eigen::VectorXd units = Eigen::VectorXd::Ones(camera.estimatedCount());
  const Intrinsics& p = camera.parameters();
  units.head<4>() << p(0), p(1), p(0), p(1);
  return units;
}

// Of n unknowns those from `begin` on, `count` of them, eliminated.
void eliminate(Eigen::Index begin, Eigen::Index count, Eigen::MatrixXd* information,
               Eigen::VectorXd* gradient) {
  const Eigen::MatrixXd cross = information->middleCols(begin, count);
  const Eigen::MatrixXd own = information->block(begin, begin, count, count);
  const Eigen::MatrixXd leverage = leastNormSolution(own, cross.transpose()).x;
  *gradient -= leverage.transpose() * gradient->segment(begin, count).eval();
  *information -= cross * leverage;
  information->middleCols(begin, count).setZero();
  information->middleRows(begin, count).setZero();
  gradient->segment(begin, count).setZero();
}

}  // namespace

RigChart::RigChart(const Rig& reference)
    : reference_(reference), unit_(reference.rig_from_camera[1].translation.norm()) {
  // A position that is not known tells no direction either; some segment may.
  if (!(unit_ > 0.0)) {
    unit_ = 1.0;
    reference_.rig_from_camera[1].translation = Eigen::Vector3d::UnitX();
  }
  const int cameras = reference.size();
  int at = 6 * (cameras - 1) - 1;
  for (const Camera& camera : reference.cameras) {
    intrinsics_at_.push_back(at);
    at += camera.estimatedCount();
  }
  intrinsics_at_.push_back(at);
}

Eigen::VectorXd RigChart::positions(const Rig& rig) const {
  Eigen::VectorXd result(3 * (rig.size() - 1));
  for (int c = 1; c < rig.size(); ++c) {
    result.segment<3>(3 * (c - 1)) = rig.rig_from_camera[c].translation;
  }
  return result;
}

// A change of the distance between the first two, which is the unit, changes all others.
Eigen::MatrixXd RigChart::positionsFromShifts() const {
  const Eigen::VectorXd all = positions(reference_) / unit_;
  const Eigen::Index n = all.size();
  const Eigen::Vector3d direction = all.head<3>();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n - 1, n);
  result.topLeftCorner<2, 3>() = tangentBasis(direction).transpose() / unit_;
  result.bottomRightCorner(n - 3, n - 3).diagonal().setConstant(1.0 / unit_);
  result.bottomLeftCorner(n - 3, 3) -= all.tail(n - 3) * direction.transpose() / unit_;
  return result;
}

Eigen::MatrixXd RigChart::shiftsFromPositions(double scale) const {
  const Eigen::VectorXd all = positions(reference_);
  const Eigen::Index n = all.size();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, n);
  result.topLeftCorner<3, 2>() = scale * unit_ * tangentBasis(all.head<3>() / unit_);
  result.block(3, 2, n - 3, n - 3).diagonal().setConstant(scale * unit_);
  result.col(n - 1) = scale * all;
  return result;
}

// Rotations, then positions, then intrinsics in their units; at the reference's rotations and
// intrinsics, and the segment's own positions.
RigChart::Quadratic RigChart::ordered(const RigLikelihood& segment) const {
  const int cameras = reference_.size();
  const Eigen::Index total = segment.gradient.size();
  Eigen::MatrixXd order = Eigen::MatrixXd::Zero(total, total);
  Eigen::VectorXd off = Eigen::VectorXd::Zero(total);
  for (int c = 1; c < cameras; ++c) {
    const int from = 6 * (c - 1);
    order.block<3, 3>(from, rotationAt(c)).setIdentity();
    order.block<3, 3>(from + 3, positionsAt() + rotationAt(c)).setIdentity();
    off.segment<3>(rotationAt(c)) = logSo3(reference_.rig_from_camera[c].rotation *
                                           segment.rig.rig_from_camera[c].rotation.conjugate());
  }
  for (int c = 0; c < cameras; ++c) {
    const int at = intrinsics_at_[c] + 1;  // positions have one more here
    const Eigen::VectorXd units = unitsOf(reference_.cameras[c]);
    const auto n = units.size();
    order.block(at, at, n, n) = units.asDiagonal();
    off.segment(at, n) =
        (reference_.cameras[c].parameters().head(n) - segment.rig.cameras[c].parameters().head(n))
            .cwiseQuotient(units);
  }
  Quadratic result;
  result.first = order.transpose() * segment.information * order;
  result.second = order.transpose() * segment.gradient - result.first * off;
  return result;
}

// The scale at which the reference's positions fit the segment's best, with rotations left open;
// nothing where it is not told.
std::optional<double> RigChart::scaleOf(const RigLikelihood& segment,
                                        const Eigen::MatrixXd& information) const {
  const Eigen::Index turns = positionsAt();
  Eigen::MatrixXd whole = information;
  Eigen::VectorXd unused = Eigen::VectorXd::Zero(whole.rows());
  eliminate(0, turns, &whole, &unused);
  const Eigen::MatrixXd own = whole.block(turns, turns, turns, turns);
  const Eigen::VectorXd reference = positions(reference_);
  const double square = reference.dot(own * reference);
  const double scale = reference.dot(own * positions(segment.rig)) / square;
  if (!(scale > 0.0 && scale * std::sqrt(square) > kSignificant)) return std::nullopt;
  return scale;
}

RigChart::Quadratic RigChart::of(const RigLikelihood& segment) const {
  const Eigen::Index turns = positionsAt();
  const Eigen::Index poses = 2 * turns;
  const Eigen::Index total = segment.gradient.size();
  auto [information, gradient] = ordered(segment);
  if (const auto scale = scaleOf(segment, information)) {
    gradient -= information.middleCols(turns, turns) *
                (*scale * positions(reference_) - positions(segment.rig));
    Eigen::MatrixXd chart = Eigen::MatrixXd::Identity(total, total);
    chart.block(turns, turns, turns, turns) = shiftsFromPositions(*scale);
    information = (chart.transpose() * information * chart).eval();
    gradient = (chart.transpose() * gradient).eval();
    eliminate(poses - 1, 1, &information, &gradient);
  } else {
    eliminate(turns, turns, &information, &gradient);
  }
  // The scale's place goes.
  Eigen::MatrixXd keep = Eigen::MatrixXd::Zero(total, total - 1);
  keep.topLeftCorner(poses - 1, poses - 1).setIdentity();
  keep.bottomRightCorner(total - poses, total - poses).setIdentity();
  return {keep.transpose() * information * keep, keep.transpose() * gradient};
}

std::vector<Eigen::MatrixXd> RigChart::mountBases() const {
  const int cameras = reference_.size();
  const Eigen::MatrixXd shifts = positionsFromShifts();
  std::vector<Eigen::MatrixXd> bases;
  if (cameras > 2) {
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(size(), 6);
    Eigen::MatrixXd moves(positionsAt(), 6);
    for (int c = 1; c < cameras; ++c) {
      const Eigen::Vector3d& t = reference_.rig_from_camera[c].translation;
      basis.block<3, 3>(rotationAt(c), 0).setIdentity();
      moves.block<3, 3>(rotationAt(c), 0) = -skew(t);
      moves.block<3, 3>(rotationAt(c), 3).setIdentity();
    }
    basis.middleRows(positionsAt(), shifts.rows()) = shifts * moves;
    bases.push_back(basis);
  }
  for (int c = 1; c < cameras; ++c) {
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(size(), 6);
    basis.block<3, 3>(rotationAt(c), 0).setIdentity();
    basis.block(positionsAt(), 3, shifts.rows(), 3) = shifts.middleCols<3>(rotationAt(c));
    bases.push_back(basis);
  }
  return bases;
}

Eigen::MatrixXd RigChart::allPoses() const {
  return Eigen::MatrixXd::Identity(size(), intrinsics_at_.front());
}

std::vector<Eigen::MatrixXd> RigChart::lensBases() const {
  std::vector<Eigen::MatrixXd> bases;
  for (std::size_t c = 0; c + 1 < intrinsics_at_.size(); ++c) {
    const int n = intrinsics_at_[c + 1] - intrinsics_at_[c];
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(size(), n);
    basis.middleRows(intrinsics_at_[c], n).setIdentity();
    bases.push_back(basis);
  }
  return bases;
}

}  // namespace camera_self_calibration
