#include "camera_self_calibration/geometry/so3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>
#include <vector>

namespace camera_self_calibration {
namespace {

// Axes in general and in special position.
std::vector<Eigen::Vector3d> axes() {
  std::vector<Eigen::Vector3d> list = {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
                                       -Eigen::Vector3d::UnitZ()};
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 10; ++i) {
    list.push_back(Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized());
  }
  return list;
}

// From nothing over both sides of every branch to nearly half a turn.
const double kAngles[] = {0.0,     1e-300, 1e-12, 1e-9, 1e-8,        0.99e-4,    1.01e-4,
                          0.99e-3, 1e-3,   0.1,   1.0,  M_PI - 1e-3, M_PI - 1e-6};

TEST(So3, SkewIsTheCrossProduct) {
  const Eigen::Vector3d a(1, -2, 3), b(0.5, 4, -1);
  EXPECT_TRUE((skew(a) * b).isApprox(a.cross(b), 1e-15));
}

TEST(So3, ExpIsTheMatrixExponential) {
  for (const Eigen::Vector3d& axis : axes()) {
    for (const double angle : kAngles) {
      const Eigen::Matrix3d exponential = skew(angle * axis).exp();
      EXPECT_LT((expSo3(angle * axis).toRotationMatrix() - exponential).norm(), 1e-14) << angle;
    }
  }
}

TEST(So3, LogInvertsExp) {
  for (const Eigen::Vector3d& axis : axes()) {
    for (const double angle : kAngles) {
      const Eigen::Vector3d v = angle * axis;
      EXPECT_LE((logSo3(expSo3(v)) - v).norm(), 1e-9 * 1e-6 + 1e-14 * angle) << angle;
    }
  }
}

TEST(So3, LogKeepsRelativePrecisionOfTinyAngles) {
  for (const double angle : {1e-3, 1e-6, 1e-9, 1e-12, 1e-20}) {
    const Eigen::Vector3d v = angle * Eigen::Vector3d(0.48, -0.6, 0.64);
    EXPECT_LT((logSo3(expSo3(v)) - v).norm(), 1e-13 * angle) << angle;
  }
}

TEST(So3, BothQuaternionsOfARotationHaveTheSameLog) {
  for (const Eigen::Vector3d& axis : axes()) {
    const Eigen::Quaterniond q = expSo3(2.5 * axis);
    const Eigen::Quaterniond negative(-q.coeffs());
    EXPECT_LT((logSo3(q) - logSo3(negative)).norm(), 1e-14);
  }
}

TEST(So3, LogIsAtMostHalfATurn) {
  for (const Eigen::Vector3d& axis : axes()) {
    for (const double angle : {M_PI - 1e-9, M_PI, M_PI + 1e-9, 4.0, 6.0, 2.0 * M_PI - 1e-7}) {
      const Eigen::Vector3d v = logSo3(expSo3(angle * axis));
      EXPECT_LE(v.norm(), M_PI + 1e-12);
      EXPECT_LT(expSo3(v).angularDistance(expSo3(angle * axis)), 1e-7) << angle;
    }
  }
}

TEST(So3, TurnsAboutOneAxisAdd) {
  for (const Eigen::Vector3d& axis : axes()) {
    const Eigen::Quaterniond sum = expSo3(0.7 * axis) * expSo3(0.9 * axis);
    EXPECT_LT(sum.angularDistance(expSo3(1.6 * axis)), 1e-7);
    EXPECT_LT((expSo3(-0.7 * axis).coeffs() - expSo3(0.7 * axis).conjugate().coeffs()).norm(),
              1e-15);
  }
}

}  // namespace
}  // namespace camera_self_calibration
