#include "camera_self_calibration/estimation/pseudo_inverse.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>
#include <random>

#include "camera_self_calibration/estimation/pivoted_cholesky.h"

namespace camera_self_calibration {
namespace {

constexpr double kRankTolerance = 1e-12;

// n x n of this rank, with columns whose sizes are up to a million times apart.
Eigen::MatrixXd randomMatrix(int n, int rank, std::mt19937* random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> exponent(-3.0, 3.0);
  Eigen::MatrixXd root(n, rank);
  for (int i = 0; i < n; ++i) {
    const double size = std::pow(10.0, exponent(*random));
    for (int j = 0; j < rank; ++j) root(i, j) = size * normal(*random);
  }
  return root * root.transpose();
}

// D V W^-1 V^T D, with D the scale to a unit diagonal and V W V^T what it makes of the matrix.
Eigen::MatrixXd byEigenvalues(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd scale = matrix.diagonal().unaryExpr(&inverseRoot);
  const Eigen::MatrixXd scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const double limit = 1e-10 * eigen.eigenvalues().maxCoeff();
  const Eigen::VectorXd inverse = eigen.eigenvalues().unaryExpr(
      [limit](double value) { return value > limit ? 1.0 / value : 0.0; });
  const Eigen::MatrixXd axes = scale.asDiagonal() * eigen.eigenvectors();
  return axes * inverse.asDiagonal() * axes.transpose();
}

void expectAsByEigenvalues(const Eigen::MatrixXd& matrix, int rank) {
  PseudoInverse inverse;
  inverse.compute(matrix, kRankTolerance);
  EXPECT_EQ(inverse.rank(), rank);
  const Eigen::MatrixXd expected = byEigenvalues(matrix);
  const Eigen::MatrixXd found =
      inverse.solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
  const Eigen::VectorXd size = matrix.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::MatrixXd error = size.asDiagonal() * (found - expected) * size.asDiagonal();
  const Eigen::MatrixXd whole = size.asDiagonal() * expected * size.asDiagonal();
  EXPECT_LT(error.norm(), 1e-7 * whole.norm());
}

TEST(PseudoInverse, AsByEigenvaluesAtEveryRank) {
  std::mt19937 random(7);
  for (const int n : {1, 6, 30, 90}) {
    for (const int rank : {1, n / 3, n / 2, n - 1, n}) {
      if (rank < 1) continue;
      SCOPED_TRACE(testing::Message() << n << " x " << n << " of rank " << rank);
      expectAsByEigenvalues(randomMatrix(n, rank, &random), rank);
    }
  }
}

TEST(PseudoInverse, OfBlocksThatNothingConnects) {
  std::mt19937 random(8);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(36, 36);
  matrix.topLeftCorner(12, 12) = randomMatrix(12, 12, &random);
  matrix.block(12, 12, 12, 12) = randomMatrix(12, 5, &random);  // and 12 that nothing sees
  expectAsByEigenvalues(matrix, 17);
}

TEST(PseudoInverse, OfZeroIsZero) {
  for (const int n : {1, 4, 90}) {  // Eigen takes another way where matrices are large
    PseudoInverse inverse;
    inverse.compute(Eigen::MatrixXd::Zero(n, n), kRankTolerance);
    EXPECT_EQ(inverse.rank(), 0);
    EXPECT_EQ(inverse.solve(Eigen::MatrixXd::Identity(n, n)).norm(), 0.0);
  }
}

TEST(PseudoInverse, OfWhatIsNotFiniteIsNotFinite) {
  std::mt19937 random(9);
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (const int column : {2, 5}) {
      Eigen::MatrixXd matrix = randomMatrix(6, 3, &random);
      matrix(5, column) = value;
      PseudoInverse inverse;
      inverse.compute(matrix, kRankTolerance);
      EXPECT_FALSE(inverse.solve(Eigen::MatrixXd::Identity(6, 6)).allFinite());
    }
  }
}

TEST(PivotedCholesky, TakesTheLargestThatIsLeft) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(3, 3);
  // Of the first and second only the difference is left once the first is taken.
  matrix << 4.0, 3.9, 0.0, 3.9, 3.9, 0.0, 0.0, 0.0, 1.0;
  PivotedCholesky cholesky;
  cholesky.compute(matrix, 0.5);
  EXPECT_EQ(cholesky.rank(), 2);
  EXPECT_EQ(cholesky.order()(0), 0);
  EXPECT_EQ(cholesky.order()(1), 2);
  EXPECT_EQ(cholesky.order()(2), 1);
  EXPECT_DOUBLE_EQ(cholesky.top()(0, 0), 2.0);
  EXPECT_DOUBLE_EQ(cholesky.bottom()(0, 0), 1.95);
}

}  // namespace
}  // namespace camera_self_calibration
