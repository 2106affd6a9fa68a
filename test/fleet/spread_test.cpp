#include "camera_self_calibration/fleet/spread.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "camera_self_calibration/base/holm.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "fleet/made_estimates.h"

namespace camera_self_calibration {
namespace {

EstimateSum sumOf(const std::vector<Estimate>& estimates) {
  EstimateSum sum(valuesOf(madeLens()), pixelUnit(madeLens()));
  for (const Estimate& estimate : estimates) EXPECT_TRUE(sum.add(estimate));
  return sum;
}

TEST(Spread, ThePixelUnitIsOnePixelOverTheImage) {
  EXPECT_NEAR(pixelUncertainty(madeLens(), pixelUnit(madeLens())).rms, 1.0, 1e-6);
}

TEST(Spread, MeanAndChiSquareAreThoseOfTheirDefinition) {
  const std::vector<Estimate> estimates = madeSeries({1, 1, 1, 1}, 0.1, 0.0, 5).estimates;
  const EstimateSum sum = sumOf(estimates);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(5, 5);
  Eigen::VectorXd weighted = Eigen::VectorXd::Zero(5);
  for (const Estimate& estimate : estimates) {
    information += estimate.covariance.inverse();
    weighted += estimate.covariance.inverse() * estimate.value;
  }
  const Eigen::VectorXd mean = information.inverse() * weighted;
  double chi_square = 0.0;
  for (const Estimate& estimate : estimates) {
    const Eigen::VectorXd off = estimate.value - mean;
    chi_square += off.dot(estimate.covariance.inverse() * off);
  }
  EXPECT_LT((sum.mean() - mean).norm(), 1e-9 * mean.norm());
  EXPECT_NEAR(sum.chiSquare(), chi_square, 1e-6 * chi_square);
  EXPECT_EQ(sum.scatterFreedom(), 15);
  EXPECT_EQ(sum.freedom(), 200);
}

TEST(Spread, WhatIsTakenOutAgainLeavesNoTrace) {
  const std::vector<Estimate> estimates = madeSeries({1, 1, 1, 1.02}, 0.1, 0.0, 6).estimates;
  EstimateSum sum = sumOf(estimates);
  EXPECT_TRUE(sum.remove(estimates[3]));
  const EstimateSum others = sumOf({estimates[0], estimates[1], estimates[2]});
  EXPECT_EQ(sum.count(), 3);
  EXPECT_LT((sum.mean() - others.mean()).norm(), 1e-8);
  EXPECT_NEAR(sum.chiSquare(), others.chiSquare(), 1e-5);
}

TEST(Spread, AnEstimateOfNothingIsNotTaken) {
  EstimateSum sum = sumOf({});
  Estimate nothing{valuesOf(madeLens()), IntrinsicsMatrix::Zero(5, 5), 0};
  EXPECT_FALSE(sum.add(nothing));
  EXPECT_EQ(sum.count(), 0);
}

TEST(Spread, ScatterBeyondTheSigmasIsFoundAndMakesTheMeanLessCertain) {
  double found = 0.0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const EstimateSum sum =
        sumOf(madeSeries(std::vector<double>(12, 1.0), 0.1, 0.3, seed).estimates);
    found += std::sqrt(scatterBeyond(sum, sumOf({}))) / 30.0;
  }
  EXPECT_NEAR(found, 0.3, 0.03);
  const EstimateSum sum = sumOf(madeSeries(std::vector<double>(12, 1.0), 0.1, 0.3, 3).estimates);
  const double apart = pixelUncertainty(madeLens(), sum.covariance(0.09)).rms;
  EXPECT_GT(apart, 0.3 / std::sqrt(12.0));
  EXPECT_LT(apart, 0.6 / std::sqrt(12.0));
}

// Of equal means, p-values below 5 % are 5 % of all, whether or not bags scatter beyond their
// sigmas.
TEST(Spread, EqualMeansDifferAsOftenAsTheirPValueSays) {
  for (const double tau : {0.0, 0.2}) {
    int below = 0;
    constexpr int kTrials = 1000;
    for (int i = 0; i < kTrials; ++i) {
      const auto seed = static_cast<std::uint64_t>(i);
      const EstimateSum a = sumOf(madeSeries({1, 1, 1, 1}, 0.1, tau, 2 * seed).estimates);
      const EstimateSum b = sumOf(madeSeries({1, 1, 1}, 0.1, tau, 2 * seed + 1).estimates);
      below += difference(a, b).p_value < 0.05;
    }
    // Four standard deviations; too few are no harm.
    EXPECT_LT(below, 0.05 * kTrials + 28) << "tau " << tau;
    EXPECT_GT(below, 5) << "tau " << tau;
  }
}

TEST(Spread, ADifferenceIsSeenThroughTheScatter) {
  const EstimateSum a = sumOf(madeSeries({1, 1, 1, 1, 1}, 0.05, 0.1, 1).estimates);
  const EstimateSum b = sumOf(madeSeries({1.01, 1.01, 1.01, 1.01}, 0.05, 0.1, 2).estimates);
  EXPECT_LT(difference(a, b).p_value, 1e-8);
  EXPECT_EQ(difference(a, sumOf({})).p_value, 1.0);
}

TEST(Holm, RejectsStepByStepUntilTheFirstThatHolds) {
  EXPECT_EQ(rejectedByHolm({0.012, 0.001, 0.04, 0.03}, 0.05),
            (std::vector<bool>{true, true, false, false}));
  EXPECT_EQ(rejectedByHolm({0.013, 0.02}, 0.05), (std::vector<bool>{true, true}));
  EXPECT_TRUE(rejectedByHolm({}, 0.05).empty());
}

}  // namespace
}  // namespace camera_self_calibration
