#pragma once

#include <ceres/problem.h>
#include <ceres/version.h>

#include <vector>

#if CERES_VERSION_MAJOR > 2 || (CERES_VERSION_MAJOR == 2 && CERES_VERSION_MINOR >= 1)
#define CAMERA_SELF_CALIBRATION_CERES_MANIFOLDS
#include <ceres/manifold.h>
#include <ceres/sphere_manifold.h>
#else
#include <ceres/local_parameterization.h>
#endif

namespace camera_self_calibration {

// Ceres calls it Manifold from 2.1 on, LocalParameterization before; this is the one place that
// knows. The problem takes ownership.
#ifdef CAMERA_SELF_CALIBRATION_CERES_MANIFOLDS

inline void keepUnitQuaternion(ceres::Problem* problem, double* quaternion) {
  problem->SetManifold(quaternion, new ceres::EigenQuaternionManifold);
}

inline void keepUnitVector(ceres::Problem* problem, double* vector) {
  problem->SetManifold(vector, new ceres::SphereManifold<3>);
}

inline void keepEntries(ceres::Problem* problem, double* block, int size,
                        const std::vector<int>& constant) {
  problem->SetManifold(block, new ceres::SubsetManifold(size, constant));
}

inline int freedomsOf(const ceres::Problem& problem, const double* block) {
  return problem.ParameterBlockTangentSize(block);
}

#else

inline void keepUnitQuaternion(ceres::Problem* problem, double* quaternion) {
  problem->SetParameterization(quaternion, new ceres::EigenQuaternionParameterization);
}

inline void keepUnitVector(ceres::Problem* problem, double* vector) {
  problem->SetParameterization(vector, new ceres::HomogeneousVectorParameterization(3));
}

inline void keepEntries(ceres::Problem* problem, double* block, int size,
                        const std::vector<int>& constant) {
  problem->SetParameterization(block, new ceres::SubsetParameterization(size, constant));
}

inline int freedomsOf(const ceres::Problem& problem, const double* block) {
  return problem.ParameterBlockLocalSize(block);
}

#endif

}  // namespace camera_self_calibration
