#include "camera_self_calibration/tools/truth_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace camera_self_calibration {
namespace {

Calibration calibration(const std::vector<double>& values, const std::vector<double>& sigma) {
  Calibration message;
  message.calibration_state = Calibration::CONVERGED;
  message.model = "pinhole";
  message.parameter_names = {"fx", "fy", "cx", "cy"};
  message.values = values;
  message.sigma = sigma;
  return message;
}

const std::vector<double> kTruth = {500, 501, 320, 240};
const std::vector<double> kSigma = {1, 1, 2, 2};

TEST(TruthTable, PassesWithinThreeSigma) {
  const auto result =
      compareWithTruth(calibration(kTruth, {}), calibration({502, 501, 317, 245}, kSigma));
  EXPECT_TRUE(result.passed());
  EXPECT_DOUBLE_EQ(result.largest_z, 2.5);
  EXPECT_NE(result.table.find("fx"), std::string::npos);
  EXPECT_NE(result.table.find("502.0"), std::string::npos);
}

TEST(TruthTable, FailsBeyondThreeSigmaOrWithoutConvergence) {
  EXPECT_FALSE(compareWithTruth(calibration(kTruth, {}), calibration({504, 501, 320, 240}, kSigma))
                   .passed());
  Calibration converging = calibration(kTruth, kSigma);
  converging.calibration_state = Calibration::CONVERGING;
  EXPECT_FALSE(compareWithTruth(calibration(kTruth, {}), converging).passed());
}

TEST(TruthTable, ASigmaOfNothingProvesNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto result = compareWithTruth(calibration(kTruth, {}),
                                       calibration({500.1, 501, 320, 240}, {nan, 1, 1, 1}));
  EXPECT_TRUE(std::isinf(result.largest_z));
  EXPECT_FALSE(result.passed());
}

TEST(TruthTable, RefusesAnotherModel) {
  Calibration other = calibration(kTruth, kSigma);
  other.model = "fov";
  EXPECT_FALSE(compareWithTruth(calibration(kTruth, {}), other).passed());
  EXPECT_FALSE(compareWithTruth(Calibration(), Calibration()).passed());
}

}  // namespace
}  // namespace camera_self_calibration
