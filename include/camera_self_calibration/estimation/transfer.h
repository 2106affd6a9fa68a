#pragma once

#include <Eigen/Core>
#include <vector>

#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// Eq. (1) between two keyframes, in the observing camera: `x = rotation ray + rho translation`.
/// Many observations share it.
struct Transfer {
  Eigen::Matrix3d rotation;     ///< observing_from_reference
  Eigen::Vector3d translation;  ///< Of the reference camera, seen from the observing one.

  Eigen::Vector3d operator()(const Eigen::Vector3d& ray, double inverse_depth) const {
    return rotation * ray + inverse_depth * translation;
  }
};

/// Exactly the identity from a keyframe to itself.
inline Transfer transferBetween(const PoseMatrices& reference, const PoseMatrices& observing) {
  if (&reference == &observing) return {Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()};
  return {observing.rotation.transpose() * reference.rotation,
          observing.rotation.transpose() * (reference.position - observing.position)};
}

/// The transfers of a segment at its present poses, computed when first asked for.
class Transfers {
 public:
  Transfers() = default;
  explicit Transfers(const Segment& segment) { reset(segment); }

  /// Forgets all transfers; memory is kept.
  void reset(const Segment& segment) {
    poses_.clear();
    for (const Keyframe& keyframe : segment.keyframes) {
      poses_.emplace_back(keyframe.world_from_camera);
    }
    known_.assign(poses_.size() * poses_.size(), 0);
    transfers_.resize(known_.size());
  }

  const std::vector<PoseMatrices>& poses() const { return poses_; }

  const Transfer& between(int reference, int observing) {
    const std::size_t i = static_cast<std::size_t>(reference) * poses_.size() + observing;
    if (known_[i] == 0) {
      transfers_[i] = transferBetween(poses_[reference], poses_[observing]);
      known_[i] = 1;
    }
    return transfers_[i];
  }

 private:
  std::vector<PoseMatrices> poses_;
  std::vector<char> known_;
  std::vector<Transfer> transfers_;
};

/// Calls `visit(o, pixel)` for each observation o of a segment in turn, with its prediction (eq. 1)
/// or null where there is none.
template <typename Visit>
void predictObservations(const Segment& segment, const Camera& camera, Transfers* transfers,
                         const Visit& visit) {
  transfers->reset(segment);
  int ray_landmark = -1;  // observations of a landmark follow each other
  bool ray_valid = false;
  Eigen::Vector3d ray;
  for (std::size_t o = 0; o < segment.observations.size(); ++o) {
    const Observation& observation = segment.observations[o];
    const Landmark& landmark = segment.landmarks[observation.landmark];
    if (observation.landmark != ray_landmark) {
      ray_landmark = observation.landmark;
      ray_valid =
          landmarkRay(segment.cameraOf(landmark.reference, camera), landmark, &ray, nullptr);
    }
    const Transfer& transfer = transfers->between(landmark.reference, observation.keyframe);
    Eigen::Vector2d pixel;
    const bool predicted = ray_valid && segment.cameraOf(observation.keyframe, camera)
                                            .project(transfer(ray, landmark.inverse_depth), &pixel);
    visit(o, predicted ? &pixel : nullptr);
  }
}

}  // namespace camera_self_calibration
