#include "camera_self_calibration/tracking/secant_steps.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace camera_self_calibration {
namespace {

WarpStep offset() {
  WarpStep result;
  result << 0.8, -0.5, 0.02, -0.03, 0.01, 0.04;
  return result;
}

// Steps until a registration is there whose Gauss-Newton steps reach only `share` of what is left.
int stepsToGo(double share, bool secant) {
  SecantSteps steps;
  WarpStep left = offset();
  int count = 0;
  while (left.norm() > 1e-3 && count < 100) {
    const WarpStep proposed = share * left;
    left -= secant ? steps.next(proposed) : proposed;
    ++count;
  }
  return count;
}

TEST(SecantSteps, TheFirstStepIsTheProposedOne) {
  SecantSteps steps;
  EXPECT_LT((steps.next(offset()) - offset()).norm(), 1e-15);
}

TEST(SecantSteps, StepsThatStayShortAreMadeLonger) {
  EXPECT_GT(stepsToGo(0.4, false), 12);
  EXPECT_LE(stepsToGo(0.4, true), 4);
}

TEST(SecantSteps, StepsThatGoTooFarAreMadeShorter) {
  EXPECT_GT(stepsToGo(1.7, false), 15);
  EXPECT_LE(stepsToGo(1.7, true), 4);
}

TEST(SecantSteps, ExactStepsAreLeftAsTheyAre) { EXPECT_LE(stepsToGo(1.0, true), 2); }

// Each direction of the warp has a curvature of its own.
TEST(SecantSteps, LearnsEachDirection) {
  WarpStep shares;
  shares << 0.9, 0.4, 0.7, 0.5, 0.8, 0.6;
  SecantSteps steps;
  WarpStep left = offset();
  int secant = 0, plain = 0;
  for (; left.norm() > 1e-4 && secant < 100; ++secant) {
    left -= steps.next(shares.cwiseProduct(left));
  }
  for (left = offset(); left.norm() > 1e-4 && plain < 100; ++plain) {
    left -= shares.cwiseProduct(left);
  }
  EXPECT_LT(secant, plain);
}

// What was learnt never makes a step more than four times as long.
TEST(SecantSteps, NeverFarBeyondTheProposal) {
  SecantSteps steps;
  WarpStep proposed = offset();
  for (int i = 0; i < 20; ++i) {
    EXPECT_LT(steps.next(proposed).head<2>().norm(), 4.0 * std::max(1.0, proposed.norm()) + 1e-9);
    proposed *= i % 2 == 0 ? 0.999 : 0.2;
  }
}

}  // namespace
}  // namespace camera_self_calibration
