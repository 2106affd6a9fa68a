#include "camera_self_calibration/queue/row_time.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

constexpr int kSteps = 479;

RowTimeEstimate estimateOf(double readout_ms, double sigma_ms) {
  RowTimeEstimate estimate;
  estimate.usable = true;
  estimate.row_time_s = 1e-3 * readout_ms / kSteps;
  estimate.sigma_s = 1e-3 * sigma_ms / kSteps;
  return estimate;
}

// Of the whole image [ms], after one estimate.
double doubtAfter(double readout_ms, double sigma_ms) {
  RowTime row_time(0.0, kSteps);
  row_time.take(estimateOf(readout_ms, sigma_ms));
  return 1e3 * kSteps * row_time.doubt();
}

TEST(RowTime, ComesIntoUseWithoutADoubtOnly) {
  RowTime row_time(0.0, kSteps);
  EXPECT_FALSE(row_time.take(estimateOf(4.0, 1.0)));
  EXPECT_EQ(row_time.inUse(), 0.0);
  EXPECT_TRUE(row_time.take(estimateOf(6.0, 1.0)));
  EXPECT_NEAR(row_time.inUse(), 6e-3 / kSteps, 1e-12);
  EXPECT_FALSE(row_time.take(estimateOf(6.2, 1.0))) << "a small part of its sigma";
  EXPECT_TRUE(row_time.take(estimateOf(1.0, 1.0)));
  EXPECT_EQ(row_time.inUse(), 0.0) << "it was a mistake";
}

TEST(RowTime, InUseItIsAsUncertainAsItsEstimate) { EXPECT_NEAR(doubtAfter(15.0, 0.3), 0.3, 1e-9); }

TEST(RowTime, UnusedItMayStillBeTheTruth) {
  EXPECT_LT(doubtAfter(0.05, 0.1), 0.02) << "known to be global";
  EXPECT_NEAR(doubtAfter(10.0, 2.5), 10.0, 1.0) << "four sigma, and not used yet";
  EXPECT_NEAR(doubtAfter(0.0, 100.0), 14.0, 1.5) << "nothing is known: as likely as not";
  EXPECT_EQ(RowTime(0.0, kSteps).doubt(), 0.0) << "never asked for";
}

}  // namespace
}  // namespace camera_self_calibration
