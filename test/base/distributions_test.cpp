#include "camera_self_calibration/base/distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace camera_self_calibration {
namespace {

// Of printed tables.
TEST(ChiSquare, QuantilesOfTheTables) {
  EXPECT_NEAR(chiSquareQuantile(1, 0.05), 3.841458820694124, 1e-9);
  EXPECT_NEAR(chiSquareQuantile(1, 0.9973002), 1.14449e-5, 1e-8);
  EXPECT_NEAR(chiSquareQuantile(2, 0.01), 9.210340371976182, 1e-9);
  EXPECT_NEAR(chiSquareQuantile(3, 0.05), 7.814727903251179, 1e-9);
  EXPECT_NEAR(chiSquareQuantile(5, 0.001), 20.515005652432873, 1e-9);
  EXPECT_NEAR(chiSquareQuantile(10, 0.5), 9.34181776559197, 1e-9);
  EXPECT_NEAR(chiSquareQuantile(30, 0.975), 16.790772267408, 1e-6);
  EXPECT_NEAR(chiSquareQuantile(100, 0.005), 140.169489443, 1e-6);
}

// Two degrees of freedom have a closed form, into the far tail.
TEST(ChiSquare, TailsOfTwoDegrees) {
  for (const double p : {0.5, 1e-3, 1e-5, 1e-8, 1e-12}) {
    EXPECT_NEAR(chiSquareQuantile(2, p), -2.0 * std::log(p), 1e-8 * -std::log(p)) << p;
  }
  for (const double value : {1e-6, 0.5, 3.0, 20.0, 200.0}) {
    EXPECT_NEAR(chiSquareExceedance(value, 2), std::exp(-0.5 * value),
                1e-12 * std::exp(-0.5 * value) + 1e-16);
  }
}

TEST(ChiSquare, ExceedanceInvertsTheQuantile) {
  for (const int freedom : {1, 2, 3, 7, 17, 40, 200}) {
    for (const double p : {0.999, 0.5, 0.05, 1e-3, 1e-6}) {
      EXPECT_NEAR(chiSquareExceedance(chiSquareQuantile(freedom, p), freedom), p, 1e-10);
    }
  }
  EXPECT_EQ(chiSquareExceedance(0.0, 3), 1.0);
  EXPECT_EQ(chiSquareExceedance(-1.0, 3), 1.0);
}

TEST(ChiSquare, OfNoFreedomOrWithoutBound) {
  EXPECT_EQ(chiSquareExceedance(1.0, 0), 0.0);
  EXPECT_EQ(chiSquareExceedance(std::numeric_limits<double>::infinity(), 3), 0.0);
  EXPECT_TRUE(std::isnan(chiSquareExceedance(std::nan(""), 3)));
  EXPECT_TRUE(std::isnan(fExceedance(std::nan(""), 3, 3)));
}

// Of u^2 e^(-3 u): (2 - 17 e^-3) / 27. Of many degrees of freedom, which underflow by themselves.
TEST(IncompleteGamma, Logarithm) {
  EXPECT_NEAR(logIncompleteGamma(3.0, 3.0), std::log((2.0 - 17.0 * std::exp(-3.0)) / 27.0), 1e-12);
  EXPECT_NEAR(logIncompleteGamma(1.0, 0.5), std::log(2.0 - 2.0 * std::exp(-0.5)), 1e-12);
  const double many = logIncompleteGamma(150.0, 2.5);  // of u^149 alone: 1 / 150
  EXPECT_NEAR(many, -std::log(150.0) - 2.5 * 150.0 / 151.0, 1e-3);
}

TEST(FalseAlarms, IsTheTailOfTheBinomialDistribution) {
  EXPECT_NEAR(falseAlarms(1.0, 2, 3, 0.5), 0.5, 1e-12);
  EXPECT_NEAR(falseAlarms(10.0, 3, 3, 0.1), 10.0 * 1e-3, 1e-15);
  EXPECT_NEAR(falseAlarms(1.0, 1, 20, 0.01), 1.0 - std::pow(0.99, 20.0), 1e-12);
  EXPECT_EQ(falseAlarms(7.0, 0, 3, 0.1), 7.0);
  EXPECT_EQ(falseAlarms(7.0, -2, 1, 0.1), 7.0);
  EXPECT_EQ(falseAlarms(7.0, 4, 3, 0.1), 0.0);
}

TEST(FDistribution, OfTheTables) {
  EXPECT_NEAR(fExceedance(4.387, 3, 8), 0.0419, 2e-4);
  EXPECT_NEAR(fExceedance(3.3258, 5, 10), 0.05, 1e-4);  // tables
  EXPECT_NEAR(fExceedance(10.4807, 5, 10), 0.001, 2e-6);
  // The square of a t variable, and the limit of many degrees of freedom.
  EXPECT_NEAR(fExceedance(12.706 * 12.706, 1, 1), 0.05, 1e-5);
  EXPECT_NEAR(fExceedance(6.0, 5, 1000000) / chiSquareExceedance(30.0, 5), 1.0, 1e-3);
  EXPECT_EQ(fExceedance(0.0, 5, 5), 1.0);
}

}  // namespace
}  // namespace camera_self_calibration
