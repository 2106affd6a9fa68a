#include "camera_self_calibration/reference/residuals.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <vector>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

// Parameter blocks by value, with the pointers that Ceres wants.
struct Blocks {
  std::vector<Eigen::VectorXd> values;

  std::vector<const double*> pointers() const {
    std::vector<const double*> result;
    for (const Eigen::VectorXd& value : values) result.push_back(value.data());
    return result;
  }
};

const Rigid3 kObserving(expSo3({0.1, -0.2, 0.3}), {0.5, -0.1, 0.2});
const Rigid3 kReference(expSo3({-0.2, 0.05, -0.1}), {-0.3, 0.2, -0.1});

Blocks transferBlocks(double rho) {
  return {{kObserving.rotation.coeffs(), kObserving.translation, kReference.rotation.coeffs(),
           kReference.translation, Eigen::VectorXd::Constant(1, rho)}};
}

Eigen::Vector2d evaluate(const ceres::CostFunction& cost, const Blocks& blocks) {
  Eigen::Vector2d residual = Eigen::Vector2d::Constant(std::nan(""));
  EXPECT_TRUE(cost.Evaluate(blocks.pointers().data(), residual.data(), nullptr));
  return residual;
}

// Fourth-order differences in the entries of every block, unit norms not kept: the formulas hold
// off the manifolds too.
void expectJacobians(const ceres::CostFunction& cost, const Blocks& blocks) {
  const std::size_t count = blocks.values.size();
  ASSERT_EQ(cost.parameter_block_sizes().size(), count);
  std::vector<Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::RowMajor>> analytic(count);
  std::vector<double*> pointers(count);
  for (std::size_t b = 0; b < count; ++b) {
    ASSERT_EQ(cost.parameter_block_sizes()[b], blocks.values[b].size());
    analytic[b].setConstant(2, blocks.values[b].size(), std::nan(""));
    pointers[b] = analytic[b].data();
  }
  Eigen::Vector2d residual;
  ASSERT_TRUE(cost.Evaluate(blocks.pointers().data(), residual.data(), pointers.data()));
  EXPECT_EQ(residual, evaluate(cost, blocks));
  EXPECT_GT(residual.norm(), 0.0);
  for (std::size_t b = 0; b < count; ++b) {
    for (int i = 0; i < blocks.values[b].size(); ++i) {
      const auto at = [&](double change) {
        Blocks moved = blocks;
        moved.values[b][i] += change;
        return evaluate(cost, moved);
      };
      const double value = std::abs(blocks.values[b][i]);
      const double step = 1e-4 * (value > 1e-3 ? value : 1.0);
      const Eigen::Vector2d numeric =
          (at(-2 * step) - 8 * at(-step) + 8 * at(step) - at(2 * step)) / (12 * step);
      EXPECT_LT((analytic[b].col(i) - numeric).norm(), 1e-6 * (1.0 + numeric.norm()))
          << "block " << b << " entry " << i << ": " << analytic[b].col(i).transpose()
          << " numeric " << numeric.transpose();
    }
  }
}

// Lenses that leave room for differences in every parameter.
std::vector<Camera> lenses() {
  std::vector<Camera> result;
  for (const Camera& camera : sampleCameras()) {
    if (camera.model() == CameraModel::kFov && camera.parameters()[4] < 0.01) continue;
    result.push_back(camera);
  }
  return result;
}

TEST(Residuals, AnchoredJacobians) {
  for (const Camera& camera : lenses()) {
    SCOPED_TRACE(describe(camera));
    for (const double rho : {0.4, 0.0, -0.05}) {
      Blocks blocks = transferBlocks(rho);
      blocks.values.push_back(camera.parameters());
      expectJacobians(AnchoredResidual(camera, {250, 290}, {333, 222}, 0.7), blocks);
    }
  }
}

TEST(Residuals, InheritedJacobians) {
  for (const Camera& camera : lenses()) {
    SCOPED_TRACE(describe(camera));
    for (const double rho : {0.4, 0.0}) {
      Blocks blocks = transferBlocks(rho);
      blocks.values.push_back(Eigen::Vector3d(-0.2, 0.15, 1.0).normalized());
      blocks.values.push_back(camera.parameters());
      expectJacobians(InheritedResidual(camera, {333, 222}, 0.7), blocks);
    }
  }
}

TEST(Residuals, FirstObservationJacobians) {
  for (const Camera& camera : lenses()) {
    SCOPED_TRACE(describe(camera));
    const Blocks blocks{{Eigen::Vector3d(-0.2, 0.15, 1.0).normalized(), camera.parameters()}};
    expectJacobians(FirstObservationResidual(camera, {333, 222}, 0.7), blocks);
  }
}

// Eq. (2) with the rigid motions of the geometry room: z - P(T_i^-1 T_r (ray / rho)).
TEST(Residuals, ValueIsThatOfThePaper) {
  const Camera camera = sampleCameras()[3];
  const Eigen::Vector2d reference(250, 290), seen(333, 222);
  const double rho = 0.4, sigma = 0.7;
  const Eigen::Vector3d ray = *camera.unproject(reference);
  const Eigen::Vector3d point = kObserving.inverse() * kReference * (ray / rho);
  Eigen::Vector2d pixel;
  ASSERT_TRUE(camera.project(point, &pixel));
  const Eigen::Vector2d expected = (seen - pixel) / sigma;

  Blocks blocks = transferBlocks(rho);
  blocks.values.push_back(camera.parameters());
  EXPECT_LT((evaluate(AnchoredResidual(camera, reference, seen, sigma), blocks) - expected).norm(),
            1e-10);
  blocks.values.insert(blocks.values.end() - 1, ray);
  EXPECT_LT((evaluate(InheritedResidual(camera, seen, sigma), blocks) - expected).norm(), 1e-10);
  const Blocks first{{ray, camera.parameters()}};
  EXPECT_LT(
      (evaluate(FirstObservationResidual(camera, seen, sigma), first) - (seen - reference) / sigma)
          .norm(),
      1e-10);
}

void expectZeros(const ceres::CostFunction& cost, const Blocks& blocks) {
  std::vector<Eigen::VectorXd> jacobians;
  std::vector<double*> pointers;
  for (const Eigen::VectorXd& value : blocks.values) {
    jacobians.push_back(Eigen::VectorXd::Ones(2 * value.size()));
  }
  for (Eigen::VectorXd& jacobian : jacobians) pointers.push_back(jacobian.data());
  Eigen::Vector2d residual(1, 1);
  ASSERT_TRUE(cost.Evaluate(blocks.pointers().data(), residual.data(), pointers.data()));
  EXPECT_EQ(residual, Eigen::Vector2d::Zero());
  for (const Eigen::VectorXd& jacobian : jacobians) EXPECT_EQ(jacobian.norm(), 0.0);
}

TEST(Residuals, APointThatCannotBeProjectedCountsNothing) {
  const Camera camera = sampleCameras()[3];
  Blocks blocks = transferBlocks(-30.0);  // behind the observing camera
  blocks.values[1] = Eigen::Vector3d(0, 0, -1);
  blocks.values[3] = Eigen::Vector3d(0, 0, 1);
  blocks.values.push_back(camera.parameters());
  expectZeros(AnchoredResidual(camera, {250, 290}, {333, 222}, 1.0), blocks);
  blocks.values.insert(blocks.values.end() - 1, Eigen::Vector3d::UnitZ());
  expectZeros(InheritedResidual(camera, {333, 222}, 1.0), blocks);
  expectZeros(FirstObservationResidual(camera, {333, 222}, 1.0),
              {{-Eigen::Vector3d::UnitZ(), camera.parameters()}});
}

TEST(Residuals, AReferencePixelWithoutRayCountsNothing) {
  const Camera camera = sampleCameras()[3];
  Blocks blocks = transferBlocks(0.3);
  blocks.values.push_back(camera.parameters());
  expectZeros(AnchoredResidual(camera, {5000, 290}, {333, 222}, 1.0), blocks);
}

TEST(Residuals, IntrinsicsThatAreNotValidFail) {
  const Camera camera = sampleCameras()[3];
  Blocks blocks = transferBlocks(0.3);
  blocks.values.push_back(camera.parameters());
  blocks.values.back()[0] = -300.0;
  Eigen::Vector2d residual;
  const AnchoredResidual cost(camera, {250, 290}, {333, 222}, 1.0);
  EXPECT_FALSE(cost.Evaluate(blocks.pointers().data(), residual.data(), nullptr));
}

}  // namespace
}  // namespace camera_self_calibration
