#include "camera_self_calibration/rig/hand_eye.h"

#include <gtest/gtest.h>

#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/random.h"
#include "rig/simulated_rig.h"

namespace camera_self_calibration {
namespace {

const Rigid3 kRigFromCamera(expSo3({0.3, -1.2, 0.8}), {0.2, -0.1, 0.05});
constexpr double kScale = 2.5;  // of the rig's map over the camera's

// `axes` times noise is the motion's rotation vector.
std::vector<MotionPair> motions(const Eigen::Vector3d& axes, double noise_rad) {
  Random random(3);
  std::vector<MotionPair> all;
  for (int i = 0; i < 40; ++i) {
    MotionPair pair;
    pair.rig = Rigid3(expSo3(0.3 * axes.cwiseProduct(random.normal3())), 0.2 * random.normal3());
    pair.camera = kRigFromCamera.inverse() * pair.rig * kRigFromCamera;
    pair.camera.translation /= kScale;
    pair.camera.rotation =
        (pair.camera.rotation * expSo3(noise_rad * random.normal3())).normalized();
    all.push_back(pair);
  }
  return all;
}

TEST(HandEye, ExactMotionsGiveTheExactPose) {
  const HandEye found = handEye(motions(Eigen::Vector3d::Ones(), 0.0));
  EXPECT_LT(angleBetween(found.rotation, kRigFromCamera.rotation), 1e-9);
  EXPECT_LT((found.position - kRigFromCamera.translation).norm(), 1e-9);
}

TEST(HandEye, OutliersDoNoHarmAndSigmaIsHonest) {
  std::vector<MotionPair> noisy = motions(Eigen::Vector3d::Ones(), 0.002);
  for (int i = 0; i < 8; ++i) noisy[5 * i].camera.rotation = expSo3({0.5, 0.1 * i, -0.4});
  const HandEye found = handEye(noisy);
  const double error = angleBetween(found.rotation, kRigFromCamera.rotation);
  EXPECT_LT(error, 0.01);
  EXPECT_LT(error, 4.0 * found.rotation_sigma);
  EXPECT_GT(found.rotation_sigma, 1e-4);
}

TEST(HandEye, OneAxisDoesNotTellTheRotation) {
  const HandEye found = handEye(motions(Eigen::Vector3d::UnitZ(), 0.002));
  EXPECT_GT(found.rotation_sigma, 0.1);
}

TEST(HandEye, FewMotionsTellNothing) { EXPECT_TRUE(std::isinf(handEye({}).rotation_sigma)); }

TEST(MotionPairs, KeepToOnePairOfMaps) {
  std::vector<RigFrame> frames(10);
  for (int f = 0; f < 10; ++f) {
    frames[f].stamp_ns = 500'000'000LL * f;
    frames[f].views.resize(2);
    for (RigView& view : frames[f].views) view.world_from_camera = Rigid3();
    frames[f].views[1].map_id = f < 3 ? 1 : 2;
  }
  // From 3 to 5, ..., from 7 to 9.
  EXPECT_EQ(motionPairs(frames, 1, 1.0).size(), 5u);
  frames[5].views[0].world_from_camera.reset();
  EXPECT_EQ(motionPairs(frames, 1, 1.0).size(), 4u);
}

}  // namespace
}  // namespace camera_self_calibration
