#include "camera_self_calibration/rig/hand_eye.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/geometry/so3.h"
#include "robust_weights.h"

namespace camera_self_calibration {
namespace {

void solveRotation(const std::vector<MotionPair>& motions, HandEye* result) {
  std::vector<double> weights(motions.size(), 1.0);
  std::vector<double> residuals(motions.size());
  for (int round = 0; round < kReweightingRounds; ++round) {
    Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < motions.size(); ++i) {
      const Eigen::Vector3d rig = logSo3(motions[i].rig.rotation);
      correlation += weights[i] * rig * logSo3(motions[i].camera.rotation).transpose();
      information +=
          weights[i] * (rig.squaredNorm() * Eigen::Matrix3d::Identity() - rig * rig.transpose());
    }
    result->rotation = Eigen::Quaterniond(nearestRotation(correlation));
    for (std::size_t i = 0; i < motions.size(); ++i) {
      residuals[i] =
          (logSo3(motions[i].rig.rotation) - result->rotation * logSo3(motions[i].camera.rotation))
              .norm();
    }
    const double sigma = reweight(residuals, &weights);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
    result->rotation_sigma = sigma / std::sqrt(std::max(eigen.eigenvalues()(0), 1e-300));
  }
}

void solvePosition(const std::vector<MotionPair>& motions, HandEye* result) {
  std::vector<double> weights(motions.size(), 1.0);
  std::vector<double> residuals(motions.size());
  const auto rows = [&](const MotionPair& motion) {
    Eigen::Matrix<double, 3, 4> a;
    a.leftCols<3>() = motion.rig.rotation.toRotationMatrix() - Eigen::Matrix3d::Identity();
    a.col(3) = -(result->rotation * motion.camera.translation);
    return a;
  };
  for (int round = 0; round < kReweightingRounds; ++round) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (std::size_t i = 0; i < motions.size(); ++i) {
      const auto a = rows(motions[i]);
      normal += weights[i] * a.transpose() * a;
      right -= weights[i] * a.transpose() * motions[i].rig.translation;
    }
    // Of a motion without rotation the position is not told: the least one is taken.
    const Eigen::Vector4d x =
        Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix4d>(normal).solve(right);
    result->position = x.head<3>();
    for (std::size_t i = 0; i < motions.size(); ++i) {
      residuals[i] = (rows(motions[i]) * x + motions[i].rig.translation).norm();
    }
    reweight(residuals, &weights);
  }
}

using Maps = std::pair<std::uint64_t, std::uint64_t>;

Maps mapsOf(const RigFrame& frame, int camera) {
  return {frame.views[0].map_id, frame.views[camera].map_id};
}

bool placed(const RigFrame& frame, int camera) {
  return frame.views[0].world_from_camera && frame.views[camera].world_from_camera;
}

MotionPair motionBetween(const RigFrame& begin, const RigFrame& end, int camera) {
  const auto motion = [&](int c) {
    return begin.views[c].world_from_camera->inverse() * *end.views[c].world_from_camera;
  };
  return {motion(0), motion(camera)};
}

}  // namespace

HandEye handEye(const std::vector<MotionPair>& motions) {
  HandEye result;
  result.rotation_sigma = std::numeric_limits<double>::infinity();
  if (motions.size() < 3) return result;
  solveRotation(motions, &result);
  solvePosition(motions, &result);
  return result;
}

std::vector<MotionPair> motionPairs(const std::vector<RigFrame>& frames, int camera,
                                    double interval_s) {
  std::map<Maps, int> counts;
  for (const RigFrame& frame : frames) {
    if (placed(frame, camera)) ++counts[mapsOf(frame, camera)];
  }
  if (counts.empty()) return {};
  const Maps most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) {
        return a.second < b.second;
      })->first;
  std::vector<const RigFrame*> usable;
  for (const RigFrame& frame : frames) {
    if (placed(frame, camera) && mapsOf(frame, camera) == most) usable.push_back(&frame);
  }
  std::vector<MotionPair> motions;
  std::size_t end = 0;
  for (const RigFrame* begin : usable) {
    while (end < usable.size() && toSeconds(usable[end]->stamp_ns - begin->stamp_ns) < interval_s) {
      ++end;
    }
    if (end == usable.size()) break;
    motions.push_back(motionBetween(*begin, *usable[end], camera));
  }
  return motions;
}

}  // namespace camera_self_calibration
