#include "camera_self_calibration/rig/rig_estimate.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/map/inverse_depth.h"
#include "camera_self_calibration/pipeline/options.h"

namespace camera_self_calibration {
namespace {

// Sigmas from zero at which a distance counts as seen.
constexpr double kSignificant = 3.0;

double largestSigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(
      std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues()(2)));
}

// What another lens model says differently is one sigma.
void addDoubt(const Rig& rig, const Rig& other, double unit,
              const std::vector<ImageWeights>& features, std::vector<PlaceInRig>* places) {
  for (int c = 1; c < rig.size(); ++c) {
    const Eigen::Vector3d turn =
        logSo3(other.rig_from_camera[c].rotation * rig.rig_from_camera[c].rotation.conjugate());
    const Eigen::Vector3d shift = unit * (relativePosition(other, c) - relativePosition(rig, c));
    (*places)[c].rotation_covariance += turn * turn.transpose();
    (*places)[c].position_covariance += shift * shift.transpose();
    const PlaceVector difference = placeDifference(rig, other, c, features);
    (*places)[c].difference_covariance += difference * difference.transpose();
  }
}

void describeLenses(const Rig& rig, const RigLayout& layout, const Eigen::MatrixXd& covariance,
                    const std::optional<Rig>& other, RigEstimate* estimate) {
  for (int c = 0; c < rig.size(); ++c) {
    const Camera& camera = rig.cameras[c];
    const int at = layout.intrinsics_at[c];
    const int n = camera.estimatedCount();
    IntrinsicsMatrix own;
    if (at >= 0) own = covariance.block(at, at, n, n);
    PixelError error = at < 0 ? PixelError() : pixelUncertainty(camera, own);
    if (other) error = error.inQuadrature(pixelDistance(camera, other->cameras[c]));
    estimate->intrinsics_covariance.push_back(own);
    estimate->uncertainty.push_back(error);
  }
}

bool positionKnown(const Rig& rig, const RigLayout& layout, int c,
                   const Eigen::MatrixXd& covariance) {
  const Eigen::Matrix3d own = covariance.block<3, 3>(layout.pose_at[c] + 3, layout.pose_at[c] + 3);
  return rig.rig_from_camera[c].translation.norm() > kSignificant * largestSigma(own);
}

bool wellKnown(const RigEstimate& estimate, int c) {
  const RigLimits limits = rigLimits(estimate.rig.cameras[c]);
  const PlaceInRig& place = estimate.places[c];
  return place.rotationSigma() <= limits.rotation && place.position_known &&
         place.directionSigma(estimate.rig.rig_from_camera[c].translation) <= limits.direction;
}

}  // namespace

Eigen::Vector3d sigmasOf(const Eigen::Matrix3d& covariance) {
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

double PlaceInRig::rotationSigma() const { return largestSigma(rotation_covariance); }

double PlaceInRig::directionSigma(const Eigen::Vector3d& position) const {
  const double length = position.norm();
  const Eigen::Vector3d n = position / length;
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - n * n.transpose();
  return largestSigma(across * position_covariance * across) / length;
}

RigLimits rigLimits(const Camera& camera) {
  const double pixels = convergedRms(0.0, camera);
  return {pixels / camera.parameters()(0), pixels / (kTypicalDisparity * camera.longerSide())};
}

RigEstimate describeRig(const Rig& rig, const RigLayout& layout, const Eigen::MatrixXd& covariance,
                        const std::optional<Rig>& other, std::optional<double> baseline_m,
                        const std::vector<ImageWeights>& features,
                        std::vector<RigSegment>* segments) {
  RigEstimate estimate;
  estimate.usable = true;
  estimate.rig = rig;
  estimate.places.resize(rig.cameras.size());
  const bool unit_known = positionKnown(rig, layout, 1, covariance);
  const double unit = baseline_m.value_or(1.0);
  for (int c = 1; c < rig.size(); ++c) {
    PlaceInRig& place = estimate.places[c];
    place.rotation_covariance = covariance.block<3, 3>(layout.pose_at[c], layout.pose_at[c]);
    place.position_known = unit_known && positionKnown(rig, layout, c, covariance);
    const auto positions = relativePositionJacobian(rig, layout, c);
    place.position_covariance = unit * unit * positions * covariance * positions.transpose();
    const auto j = placeJacobian(rig, layout, c, features);
    place.difference_covariance = j * covariance * j.transpose();
  }
  describeLenses(rig, layout, covariance, other, &estimate);
  if (other) addDoubt(rig, *other, unit, features, &estimate.places);
  estimate.metric = unit_known && baseline_m;
  if (unit_known) {
    const double factor = unit / rig.rig_from_camera[1].translation.norm();
    for (Rigid3& pose : estimate.rig.rig_from_camera) pose.translation *= factor;
    for (RigSegment& segment : *segments) scaleSegment(factor, &segment);
  }
  std::vector<double> inverse_depths;
  for (std::size_t s = 0; s < segments->size(); ++s) {
    const RigSegment& segment = (*segments)[s];
    const std::vector<double> more = inverseDepths(segment.tracks.front());
    inverse_depths.insert(inverse_depths.end(), more.begin(), more.end());
    for (int k = 0; k < segment.frames(); ++k) {
      estimate.poses.push_back(
          {segment.stamps_ns[k], static_cast<int>(s), segment.world_from_rig[k]});
    }
    for (int c = 0; c < rig.size(); ++c) {
      estimate.places[c].shared_landmarks += sharedLandmarks(segment, c);
      estimate.observations += static_cast<int>(segment.tracks[c].observations.size());
    }
  }
  estimate.inverse_depth = typicalInverseDepth(std::move(inverse_depths));
  return estimate;
}

std::string lengthUnit(bool metric) {
  return metric ? "m" : "distances between the first two cameras";
}

std::string lengthUnit(const RigEstimate& estimate) { return lengthUnit(estimate.metric); }

void judgeRig(RigEstimate* estimate) {
  estimate->converged = true;
  estimate->sentence.clear();
  estimate->hint.clear();
  for (int c = 1; c < estimate->rig.size(); ++c) {
    estimate->converged = estimate->converged && wellKnown(*estimate, c);
    estimate->sentence += (c > 1 ? " " : "") + placeText(*estimate, c);
  }
  if (!estimate->metric) {
    estimate->sentence += " Lengths are relative: a given baseline makes them metric.";
  }
  if (!estimate->converged) {
    estimate->hint =
        "turn the rig about all axes, and quickly, so that the cameras move differently; views "
        "that overlap tell the positions best";
  }
  // Images that are not taken when their stamps say bend all else.
  for (int c = 1; c < estimate->rig.size(); ++c) {
    const TimeOffset& offset = estimate->places[c].time_offset;
    if (!offset.harms()) continue;
    estimate->converged = false;
    estimate->sentence += formatted(
        " The images of camera %d are taken %.1f ms (sigma %.1f) %s those of camera 0 with the "
        "same stamps.",
        c, 1e3 * std::abs(offset.seconds), 1e3 * offset.sigma,
        offset.seconds > 0.0 ? "after" : "before");
    estimate->hint = "trigger the cameras together, or correct the stamps";
  }
}

void setBaseline(std::optional<double> baseline_m, RigEstimate* estimate) {
  if (!estimate->usable || !estimate->places[1].position_known) return;
  const double factor =
      baseline_m.value_or(1.0) / estimate->rig.rig_from_camera[1].translation.norm();
  for (Rigid3& pose : estimate->rig.rig_from_camera) pose.translation *= factor;
  for (RigPose& pose : estimate->poses) pose.world_from_rig.translation *= factor;
  for (PlaceInRig& place : estimate->places) place.position_covariance *= factor * factor;
  estimate->inverse_depth /= factor;
  estimate->metric = baseline_m.has_value();
  judgeRig(estimate);
}

std::string placeText(const RigEstimate& estimate, int camera) {
  const PlaceInRig& place = estimate.places[camera];
  const Rigid3& pose = estimate.rig.rig_from_camera[camera];
  std::string text =
      formatted("Camera %d is turned by %.3f degrees against camera 0, known to %.3f", camera,
                logSo3(pose.rotation).norm() / kDegree, place.rotationSigma() / kDegree);
  if (!place.position_known) {
    return text + "; where it sits neither the motion nor shared landmarks tell.";
  }
  const Eigen::Vector3d& t = pose.translation;
  text += formatted("; it sits at (%.4f, %.4f, %.4f)%s, the direction known to %.2f degrees", t.x(),
                    t.y(), t.z(), estimate.metric ? " m" : "", place.directionSigma(t) / kDegree);
  return text + formatted(" (%d shared landmarks).", place.shared_landmarks);
}

}  // namespace camera_self_calibration
