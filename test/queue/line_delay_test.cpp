#include "camera_self_calibration/queue/line_delay.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

constexpr int kSteps = 479;

LineDelayEstimate estimateOf(double readout_ms, double sigma_ms) {
  LineDelayEstimate estimate;
  estimate.usable = true;
  estimate.line_delay_s = 1e-3 * readout_ms / kSteps;
  estimate.sigma_s = 1e-3 * sigma_ms / kSteps;
  return estimate;
}

// Of the whole image [ms], after one estimate.
double doubtAfter(double readout_ms, double sigma_ms) {
  LineDelay line_delay(0.0, kSteps);
  line_delay.take(estimateOf(readout_ms, sigma_ms));
  return 1e3 * kSteps * line_delay.doubt();
}

TEST(LineDelay, ComesIntoUseWithoutADoubtOnly) {
  LineDelay line_delay(0.0, kSteps);
  EXPECT_FALSE(line_delay.take(estimateOf(4.0, 1.0)));
  EXPECT_EQ(line_delay.inUse(), 0.0);
  EXPECT_TRUE(line_delay.take(estimateOf(6.0, 1.0)));
  EXPECT_NEAR(line_delay.inUse(), 6e-3 / kSteps, 1e-12);
  EXPECT_FALSE(line_delay.take(estimateOf(6.2, 1.0))) << "a small part of its sigma";
  EXPECT_TRUE(line_delay.take(estimateOf(1.0, 1.0)));
  EXPECT_EQ(line_delay.inUse(), 0.0) << "it was a mistake";
}

TEST(LineDelay, InUseItIsAsUncertainAsItsEstimate) {
  EXPECT_NEAR(doubtAfter(15.0, 0.3), 0.3, 1e-9);
}

TEST(LineDelay, UnusedItMayStillBeTheTruth) {
  EXPECT_LT(doubtAfter(0.05, 0.1), 0.02) << "known to be global";
  EXPECT_NEAR(doubtAfter(10.0, 2.5), 10.0, 1.0) << "four sigma, and not used yet";
  EXPECT_NEAR(doubtAfter(0.0, 100.0), 14.0, 1.5) << "nothing is known: as likely as not";
  EXPECT_EQ(LineDelay(0.0, kSteps).doubt(), 0.0) << "never asked for";
}

}  // namespace
}  // namespace camera_self_calibration
