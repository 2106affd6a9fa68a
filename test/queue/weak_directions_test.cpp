#include "camera_self_calibration/queue/weak_directions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {
namespace {

const Camera kFov = camera640(CameraModel::kFov, {320, 310, 319.5, 239.5, 0.9});
const Camera kPinhole = camera640(CameraModel::kPinhole, {500, 500, 319.5, 239.5});

// Every direction known to 0.1 px, but nothing along `direction`.
IntrinsicsMatrix informationWithout(const Intrinsics& direction, const Camera& camera) {
  const IntrinsicsMatrix metric = pixelMetric(camera);
  const Intrinsics image = metric * direction;
  return 100.0 * (metric - image * image.transpose() / direction.dot(image));
}

Intrinsics bothFocalLengths(const Camera& camera) {
  Intrinsics direction = Intrinsics::Zero(camera.estimatedCount());
  direction.head<2>().setOnes();
  return direction;
}

TEST(WeakDirections, AreMeasuredInPixels) {
  for (const Camera& camera : {kFov, kPinhole}) {
    const KnownDirections all = knownDirections(camera, 100.0 * pixelMetric(camera));
    for (Eigen::Index i = 0; i < all.sigma_px.size(); ++i) {
      EXPECT_NEAR(all.sigma_px(i), 0.1, 1e-6);
      // A step along an axis moves the image by one pixel.
      Camera moved = camera;
      Intrinsics parameters = camera.parameters();
      parameters += 0.01 * all.axes.col(i);
      moved.setParameters(parameters);
      EXPECT_NEAR(pixelDistance(camera, moved).rms, 0.01, 1e-3);
    }
    const auto n = all.sigma_px.size();
    EXPECT_LT((all.coordinates * all.axes - Eigen::MatrixXd::Identity(n, n)).norm(), 1e-6);
  }
}

TEST(WeakDirections, KeepTheirTrustedValues) {
  const Intrinsics unknown = bothFocalLengths(kFov);
  const IntrinsicsMatrix information = informationWithout(unknown, kFov);
  EXPECT_GT(knownDirections(kFov, information).sigma_px(0), 1e3);
  // What is known moves, what is not stays: the latter's part in the metric of the image.
  Intrinsics change(5);
  change << 3.0, -3.0, 4.0, -2.0, 0.01;
  const IntrinsicsMatrix metric = pixelMetric(kFov);
  change -= unknown * unknown.dot(metric * change) / unknown.dot(metric * unknown);
  Camera estimate = kFov;
  estimate.setParameters(kFov.parameters() + 80.0 * unknown + change);
  const Camera held = withWeakDirectionsHeld(estimate, information, kFov, 19.0);
  EXPECT_LT((held.parameters() - kFov.parameters() - change).norm(), 1e-3);
}

TEST(WeakDirections, HoldsAllWhereNothingIsKnown) {
  Camera estimate = kFov;
  estimate.setParameters(2.0 * kFov.parameters());
  const IntrinsicsMatrix nothing = IntrinsicsMatrix::Zero(5, 5);
  for (const IntrinsicsMatrix& information :
       {nothing, IntrinsicsMatrix(), IntrinsicsMatrix(NAN * nothing)}) {
    const Camera held = withWeakDirectionsHeld(estimate, information, kFov, 19.0);
    EXPECT_EQ(held.parameters(), kFov.parameters());
  }
  // An estimate that the information calls good is taken as it is.
  const Camera taken = withWeakDirectionsHeld(kFov, pixelMetric(kFov), kFov, 19.0);
  EXPECT_LT((taken.parameters() - kFov.parameters()).norm(), 1e-9);
}

TEST(WeakDirections, AreNamedWithTheMotionThatWouldTell) {
  WeakDirection weak = weakestDirection(informationWithout(bothFocalLengths(kFov), kFov), kFov);
  EXPECT_EQ(weak.name, "the focal length (fx, fy)");
  EXPECT_NE(weak.hint.find("several axes"), std::string::npos);
  weak = weakestDirection(informationWithout(Intrinsics::Unit(4, 1), kPinhole), kPinhole);
  EXPECT_EQ(weak.name, "the focal length (fy)");
  EXPECT_NE(weak.hint.find("tilt up and down"), std::string::npos);
  weak = weakestDirection(informationWithout(Intrinsics::Unit(4, 0), kPinhole), kPinhole);
  EXPECT_EQ(weak.name, "the focal length (fx)");
  EXPECT_NE(weak.hint.find("pan left and right"), std::string::npos);
  weak = weakestDirection(informationWithout(Intrinsics::Unit(4, 2), kPinhole), kPinhole);
  EXPECT_EQ(weak.name, "the principal point (cx)");
  weak = weakestDirection(informationWithout(Intrinsics::Unit(5, 4), kFov), kFov);
  EXPECT_EQ(weak.name, "the distortion (w)");
  EXPECT_NE(weak.hint.find("corners"), std::string::npos);
  EXPECT_EQ(weakestDirection(IntrinsicsMatrix(), kFov).name, "all parameters");
  EXPECT_FALSE(weakestDirection(IntrinsicsMatrix(), kFov).hint.empty());
}

}  // namespace
}  // namespace camera_self_calibration
