#include "camera_self_calibration/geometry/rigid3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

Eigen::Matrix4d matrix(const Rigid3& motion) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = motion.rotation.toRotationMatrix();
  m.topRightCorner<3, 1>() = motion.translation;
  return m;
}

Eigen::Matrix4d generator(const Vector6d& twist) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Zero();
  m.topLeftCorner<3, 3>() = skew(twist.tail<3>());
  m.topRightCorner<3, 1>() = twist.head<3>();
  return m;
}

// Twists whose rotation parts have the given angles.
std::vector<Vector6d> twists(double angle) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::vector<Vector6d> list;
  for (int i = 0; i < 10; ++i) {
    Vector6d twist;
    for (int k = 0; k < 6; ++k) twist(k) = normal(random);
    twist.tail<3>() *= angle / twist.tail<3>().norm();
    list.push_back(twist);
  }
  return list;
}

const double kAngles[] = {0.0, 1e-12, 1e-6, 0.99e-3, 1.01e-3, 0.1, 1.0, 3.0, M_PI - 1e-6};

TEST(Rigid3, ExpIsTheMatrixExponential) {
  for (const double angle : kAngles) {
    for (const Vector6d& twist : twists(angle)) {
      const Eigen::Matrix4d exponential = generator(twist).exp();
      EXPECT_LT((matrix(expSe3(twist)) - exponential).norm(), 1e-10) << angle;
    }
  }
}

TEST(Rigid3, LogInvertsExp) {
  for (const double angle : kAngles) {
    for (const Vector6d& twist : twists(angle)) {
      EXPECT_LT((logSe3(expSe3(twist)) - twist).norm(), 1e-9) << angle;
    }
  }
}

TEST(Rigid3, ProductsReadOff) {
  const Rigid3 a_from_b = expSe3(twists(1.0)[0]);
  const Rigid3 b_from_c = expSe3(twists(2.0)[1]);
  const Eigen::Vector3d point(0.3, -2.0, 5.0);
  EXPECT_LT(((a_from_b * b_from_c) * point - a_from_b * (b_from_c * point)).norm(), 1e-13);
  EXPECT_LT((matrix(a_from_b * b_from_c) - matrix(a_from_b) * matrix(b_from_c)).norm(), 1e-13);
}

TEST(Rigid3, GroupLaws) {
  const Rigid3 a = expSe3(twists(1.0)[2]);
  const Rigid3 b = expSe3(twists(2.0)[3]);
  const Rigid3 c = expSe3(twists(3.0)[4]);
  EXPECT_LT((matrix((a * b) * c) - matrix(a * (b * c))).norm(), 1e-13);
  EXPECT_LT((matrix(a * a.inverse()) - Eigen::Matrix4d::Identity()).norm(), 1e-13);
  EXPECT_LT((matrix(a.inverse() * a) - Eigen::Matrix4d::Identity()).norm(), 1e-13);
  EXPECT_LT((matrix(a * Rigid3()) - matrix(a)).norm(), 1e-15);
  EXPECT_LT((matrix((a * b).inverse()) - matrix(b.inverse() * a.inverse())).norm(), 1e-13);
}

TEST(Rigid3, LongChainsStayRotations) {
  const Rigid3 step = expSe3(twists(0.3)[5]);
  Rigid3 chain;
  for (int i = 0; i < 100000; ++i) chain = chain * step;
  EXPECT_NEAR(chain.rotation.norm(), 1.0, 1e-14);
}

}  // namespace
}  // namespace camera_self_calibration
