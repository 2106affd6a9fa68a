#include "camera_self_calibration/rig/place_difference.h"

#include <Eigen/Geometry>

#include "camera_self_calibration/camera/rotation_compensation.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

// Rays of `other` from those of `camera`.
Eigen::Quaterniond turnOfRays(const Camera& camera, const Camera& other,
                              const ImageWeights& features) {
  return bestRotation(pixelGrid(camera, features), other).rotation;
}

}  // namespace

std::vector<ImageWeights> featuresOf(const Rig& rig, const std::vector<RigSegment>& segments) {
  const RigViews views{rig.size()};
  std::vector<ImageWeights> features;
  for (int c = 0; c < rig.size(); ++c) {
    features.emplace_back(rig.cameras[c].width(), rig.cameras[c].height());
    for (const RigSegment& segment : segments) {
      for (const Observation& seen : segment.tracks[c].observations) {
        if (views.camera(seen.keyframe) == c) features.back().count(seen.pixel);
      }
    }
  }
  return features;
}

Eigen::Vector3d relativePosition(const Rig& rig, int camera) {
  const double unit = rig.rig_from_camera[1].translation.norm();
  if (!(unit > 0.0)) return Eigen::Vector3d::Zero();
  return rig.rig_from_camera[camera].translation / unit;
}

Eigen::Matrix<double, 3, Eigen::Dynamic> relativePositionJacobian(const Rig& rig,
                                                                  const RigLayout& layout,
                                                                  int camera) {
  const Eigen::Vector3d& unit = rig.rig_from_camera[1].translation;
  const double length = unit.norm();
  Eigen::Matrix<double, 3, Eigen::Dynamic> j =
      Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, layout.size);
  j.middleCols<3>(layout.pose_at[camera] + 3) += Eigen::Matrix3d::Identity() / length;
  j.middleCols<3>(layout.pose_at[1] + 3) -=
      rig.rig_from_camera[camera].translation * unit.transpose() / (length * length * length);
  return j;
}

PlaceVector placeDifference(const Rig& rig, const Rig& other, int camera,
                            const std::vector<ImageWeights>& features) {
  const Eigen::Quaterniond first =
      turnOfRays(rig.cameras[0], other.cameras[0], features[0]).conjugate();
  const Eigen::Quaterniond own =
      turnOfRays(rig.cameras[camera], other.cameras[camera], features[camera]);
  // `other` in the rays of `rig`.
  const Eigen::Quaterniond rotation = first * other.rig_from_camera[camera].rotation * own;
  PlaceVector difference;
  difference << logSo3(rig.rig_from_camera[camera].rotation * rotation.conjugate()),
      relativePosition(rig, camera) - first * relativePosition(other, camera);
  return difference;
}

// With d the change of a lens and `absorbed` d the rotation that would do the same to its pixels,
// its rays turn by -absorbed d.
Eigen::Matrix<double, 6, Eigen::Dynamic> placeJacobian(const Rig& rig, const RigLayout& layout,
                                                       int camera,
                                                       const std::vector<ImageWeights>& features) {
  Eigen::Matrix<double, 6, Eigen::Dynamic> j =
      Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, layout.size);
  const Eigen::Vector3d position = relativePosition(rig, camera);
  j.block<3, 3>(0, layout.pose_at[camera]).setIdentity();
  j.bottomRows<3>() = relativePositionJacobian(rig, layout, camera);
  for (const int c : {0, camera}) {
    const int at = layout.intrinsics_at[c];
    if (at < 0) continue;
    const RayIntrinsicsJacobian absorbed =
        compensatedGrid(rig.cameras[c], pixelGrid(rig.cameras[c], features[c])).absorbed;
    const int n = rig.cameras[c].estimatedCount();
    if (c == 0) {
      j.block(0, at, 3, n) += absorbed;
      j.block(3, at, 3, n) -= skew(position) * absorbed;
    } else {
      j.block(0, at, 3, n) -= rig.rig_from_camera[c].rotation.toRotationMatrix() * absorbed;
    }
  }
  return j;
}

}  // namespace camera_self_calibration
