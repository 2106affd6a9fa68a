#include "camera_self_calibration/estimation/observation_model.h"

#include <gtest/gtest.h>

#include <functional>

#include "camera_self_calibration/geometry/so3.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

// What eq. 1 depends on.
struct Inputs {
  Camera camera;
  Rigid3 reference;
  Rigid3 observing;
  Eigen::Vector3d ray;
  double inverse_depth;

  Eigen::Vector2d pixel() const {
    Eigen::Vector2d result;
    EXPECT_TRUE(predictPixel(camera, PoseMatrices(reference), PoseMatrices(observing), ray,
                             inverse_depth, false, &result, nullptr));
    return result;
  }
};

Rigid3 moved(const Rigid3& pose, int column, double h) {
  const Vector6d step = h * Vector6d::Unit(column);
  return {pose.rotation * expSo3(step.tail<3>()), pose.translation + step.head<3>()};
}

Eigen::Vector2d derivative(const Inputs& inputs,
                           const std::function<void(double, Inputs*)>& change) {
  constexpr double kStep = 1e-5;
  Inputs plus = inputs, minus = inputs;
  change(kStep, &plus);
  change(-kStep, &minus);
  return (plus.pixel() - minus.pixel()) / (2.0 * kStep);
}

void expectNear(const Eigen::Vector2d& analytic, const Eigen::Vector2d& numeric,
                const std::string& what) {
  EXPECT_LT((analytic - numeric).norm(), 1e-6 * (1.0 + numeric.norm())) << what;
}

void checkDerivatives(const Inputs& inputs) {
  PredictionJacobians jacobians;
  Eigen::Vector2d pixel;
  ASSERT_TRUE(predictPixel(inputs.camera, PoseMatrices(inputs.reference),
                           PoseMatrices(inputs.observing), inputs.ray, inputs.inverse_depth, true,
                           &pixel, &jacobians));
  EXPECT_LT((pixel - inputs.pixel()).norm(), 1e-12);
  for (int i = 0; i < 6; ++i) {
    expectNear(
        jacobians.observing_pose.col(i),
        derivative(inputs, [i](double h, Inputs* x) { x->observing = moved(x->observing, i, h); }),
        "observing pose");
    expectNear(
        jacobians.reference_pose.col(i),
        derivative(inputs, [i](double h, Inputs* x) { x->reference = moved(x->reference, i, h); }),
        "reference pose");
  }
  expectNear(jacobians.inverse_depth,
             derivative(inputs, [](double h, Inputs* x) { x->inverse_depth += h; }), "depth");
  for (int i = 0; i < 3; ++i) {
    expectNear(jacobians.ray.col(i),
               derivative(inputs, [i](double h, Inputs* x) { x->ray(i) += h; }), "ray");
  }
  for (int i = 0; i < inputs.camera.parameterCount(); ++i) {
    expectNear(jacobians.intrinsics.col(i),
               derivative(inputs,
                          [i](double h, Inputs* x) {
                            Intrinsics p = x->camera.parameters();
                            p(i) += h;
                            x->camera.setParameters(p);
                          }),
               "intrinsics");
  }
}

TEST(PredictPixel, DerivativesOfAllModels) {
  Random random(5);
  for (const Camera& camera : ordinaryCameras()) {
    for (int trial = 0; trial < 30; ++trial) {
      const auto ray =
          camera.unproject({random.uniform(100.0, 540.0), random.uniform(80.0, 400.0)});
      ASSERT_TRUE(ray);
      // Near, far, at infinity and, as a solver may pass through it, beyond.
      for (const double inverse_depth : {0.5, 0.01, 0.0, -0.05}) {
        checkDerivatives({camera,
                          {expSo3(0.1 * random.normal3()), 0.2 * random.normal3()},
                          {expSo3(0.1 * random.normal3()), 0.2 * random.normal3()},
                          *ray,
                          inverse_depth});
      }
    }
  }
}

TEST(PredictPixel, FarPointsDoNotDependOnTranslation) {
  const Camera camera = ordinaryCameras()[1];
  const Eigen::Vector3d ray = *camera.unproject({200, 300});
  const Inputs far{camera, Rigid3(), Rigid3({1, 0, 0, 0}, {5, -3, 2}), ray, 0.0};
  EXPECT_LT((far.pixel() - Eigen::Vector2d(200, 300)).norm(), 1e-9);
}

TEST(PredictPixel, RefusesPointsBehindTheCamera) {
  const Camera camera = ordinaryCameras()[0];
  const PoseMatrices here{Rigid3()};
  const PoseMatrices turned{Rigid3(expSo3({0.0, M_PI, 0.0}), Eigen::Vector3d::Zero())};
  Eigen::Vector2d pixel;
  PredictionJacobians jacobians;
  const Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();
  EXPECT_TRUE(predictPixel(camera, here, here, ray, 0.3, true, &pixel, &jacobians));
  EXPECT_FALSE(predictPixel(camera, here, turned, ray, 0.3, true, &pixel, &jacobians));
  EXPECT_FALSE(predictPixel(camera, here, turned, ray, 0.3, false, &pixel, nullptr));
}

TEST(LandmarkRay, OfReferencePixelOrBearing) {
  const Camera camera = ordinaryCameras()[2];
  Landmark landmark;
  landmark.reference_pixel = {100, 350};
  landmark.bearing = Eigen::Vector3d(0.1, 0.2, 1.0).normalized();
  Eigen::Vector3d ray;
  RayIntrinsicsJacobian jacobian;
  ASSERT_TRUE(landmarkRay(camera, landmark, &ray, &jacobian));
  EXPECT_LT((ray - *camera.unproject({100, 350})).norm(), 1e-12);
  EXPECT_GT(jacobian.norm(), 0.0);
  landmark.anchored = false;
  ASSERT_TRUE(landmarkRay(camera, landmark, &ray, &jacobian));
  EXPECT_EQ(ray, landmark.bearing);
  EXPECT_EQ(jacobian.norm(), 0.0);
  landmark.anchored = true;
  landmark.reference_pixel = {5000, 5000};  // beyond what the distortion reaches
  const Camera barrel = camera640(CameraModel::kRadtan, {420, 422, 318, 243, -0.3, 0, 0, 0});
  EXPECT_FALSE(landmarkRay(barrel, landmark, &ray, nullptr));
  EXPECT_FALSE(landmarkRay(barrel, landmark, &ray, &jacobian));
}

TEST(TangentBasis, IsOrthonormal) {
  Random random(2);
  std::vector<Eigen::Vector3d> bearings = {Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitY(),
                                           Eigen::Vector3d::UnitZ()};
  for (int i = 0; i < 100; ++i) bearings.push_back(random.normal3().normalized());
  for (const Eigen::Vector3d& bearing : bearings) {
    const Matrix32d basis = tangentBasis(bearing);
    EXPECT_LT((basis.transpose() * basis - Eigen::Matrix2d::Identity()).norm(), 1e-14);
    EXPECT_LT((basis.transpose() * bearing).norm(), 1e-15);
  }
}

}  // namespace
}  // namespace camera_self_calibration
