#include "rig_residual.h"

#include <gtest/gtest.h>

#include <vector>

#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

const Rigid3 kObserving(expSo3({0.1, -0.2, 0.3}), {0.5, -0.1, 0.2});
const Rigid3 kReference(expSo3({-0.2, 0.05, -0.1}), {-0.3, 0.2, -0.1});
const Rigid3 kLeft(expSo3({0.02, 0.01, -0.03}), {-0.1, 0.02, 0.01});
const Rigid3 kRight(expSo3({-0.05, 0.1, 0.02}), {0.12, -0.01, 0.03});
const Eigen::Vector3d kBearing = Eigen::Vector3d(0.1, -0.15, 1.0).normalized();
const Eigen::Vector2d kPixel(300.0, 200.0);

Camera lens() {
  Intrinsics p(8);
  p << 400.0, 402.0, 322.0, 236.0, 0.02, 0.01, -0.003, 0.001;
  return Camera(CameraModel::kEquidistant, 640, 480, p);
}

using Blocks = std::vector<Eigen::VectorXd>;

Blocks blocksOf(const std::vector<Rigid3>& poses) {
  Blocks blocks;
  for (const Rigid3& pose : poses) {
    blocks.push_back(pose.rotation.coeffs());
    blocks.push_back(pose.translation);
  }
  blocks.push_back(Eigen::Vector3d(0.01, -0.02, 0.4));
  blocks.push_back(lens().parameters());
  return blocks;
}

Eigen::Vector2d evaluate(const RigResidual& cost, const Blocks& blocks) {
  std::vector<const double*> pointers;
  for (const Eigen::VectorXd& block : blocks) pointers.push_back(block.data());
  Eigen::Vector2d residual;
  EXPECT_TRUE(cost.Evaluate(pointers.data(), residual.data(), nullptr));
  return residual;
}

constexpr double kStep = 1e-6;

// Entries of a unit quaternion change by rotations: along the manifold.
Blocks moved(const Blocks& blocks, std::size_t b, int i, double change) {
  Blocks all = blocks;
  if (blocks[b].size() == 4) {
    const Eigen::Quaterniond q(blocks[b](3), blocks[b](0), blocks[b](1), blocks[b](2));
    const Eigen::Vector3d turn = change * Eigen::Vector3d::Unit(i);
    all[b] = (expSo3(turn) * q).coeffs();
  } else {
    all[b](i) += change;
  }
  return all;
}

void expectJacobians(const RigResidual& cost, const Blocks& blocks) {
  std::vector<const double*> pointers;
  std::vector<Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>> jacobians;
  std::vector<double*> jacobian_pointers;
  ASSERT_EQ(cost.parameter_block_sizes().size(), blocks.size());
  for (const Eigen::VectorXd& block : blocks) {
    pointers.push_back(block.data());
    jacobians.emplace_back(2, block.size());
  }
  for (auto& jacobian : jacobians) jacobian_pointers.push_back(jacobian.data());
  Eigen::Vector2d residual;
  ASSERT_TRUE(cost.Evaluate(pointers.data(), residual.data(), jacobian_pointers.data()));
  EXPECT_GT(residual.norm(), 1.0);
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const int directions = blocks[b].size() == 4 ? 3 : static_cast<int>(blocks[b].size());
    for (int i = 0; i < directions; ++i) {
      const Blocks plus = moved(blocks, b, i, kStep);
      const Blocks minus = moved(blocks, b, i, -kStep);
      const Eigen::Vector2d expected =
          (evaluate(cost, plus) - evaluate(cost, minus)) / (2.0 * kStep);
      const Eigen::Vector2d found = jacobians[b] * (plus[b] - minus[b]) / (2.0 * kStep);
      EXPECT_NEAR((found - expected).norm(), 0.0, 1e-4 * (1.0 + expected.norm()))
          << "block " << b << ", entry " << i;
    }
  }
}

RigResidual::Roles roles(int i, int ci, int r, int cr, int count) { return {i, ci, r, cr, count}; }

TEST(RigResidual, DerivativesAcrossTimeAndCameras) {
  expectJacobians(RigResidual(lens(), roles(0, 1, 2, 3, 4), kBearing, kPixel, 0.2),
                  blocksOf({kObserving, kRight, kReference, kLeft}));
}

TEST(RigResidual, DerivativesWhereOneCameraHasBothRoles) {
  expectJacobians(RigResidual(lens(), roles(0, 1, 2, 1, 3), kBearing, kPixel, 0.2),
                  blocksOf({kObserving, kRight, kReference}));
}

TEST(RigResidual, DerivativesAtOneTime) {
  constexpr int kNone = RigResidual::Roles::kNone;
  expectJacobians(RigResidual(lens(), roles(kNone, 0, kNone, 1, 2), kBearing, kPixel, 0.2),
                  blocksOf({kRight, kLeft}));
}

TEST(RigResidual, DerivativesOfTheFirstObservation) {
  expectJacobians(RigResidual(lens(), {}, kBearing, kPixel, 0.2), blocksOf({}));
}

TEST(RigResidual, AgreesWithTheResidualOfOneCamera) {
  const Blocks blocks = blocksOf({kObserving, kRight, kReference, kLeft});
  const RigResidual cost(lens(), roles(0, 1, 2, 3, 4), kBearing, kPixel, 0.2);
  const Rigid3 i = kObserving * kRight;
  const Rigid3 r = kReference * kLeft;
  const double rho = 0.4;
  const Eigen::Vector3d bearing =
      (kBearing + tangentBasis(kBearing) * Eigen::Vector2d(0.01, -0.02)).normalized();
  Eigen::Vector2d pixel;
  ASSERT_TRUE(lens().project(
      i.rotation.conjugate() * (r.rotation * bearing + rho * (r.translation - i.translation)),
      &pixel));
  EXPECT_NEAR((evaluate(cost, blocks) - (kPixel - pixel) / 0.2).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace camera_self_calibration
