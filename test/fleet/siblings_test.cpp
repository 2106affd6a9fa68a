#include "camera_self_calibration/fleet/siblings.h"

#include <gtest/gtest.h>

#include "estimation/sample_segments.h"
#include "fleet/made_estimates.h"

namespace camera_self_calibration {
namespace {

// Lenses of one type that differ by 1 px rms, each known to 0.05 px.
std::vector<Sibling> fronts(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Sibling> cameras;
  for (int i = 0; i < count; ++i) {
    const Estimate estimate = madeEstimate(valuesOf(madeLens()), 0.05, 1.0, &random);
    cameras.push_back({"robot" + std::to_string(i) + "/front",
                       withParameters(madeLens(), estimate.value), estimate.covariance});
  }
  return cameras;
}

TEST(Siblings, TheSpreadOfATypeIsNoOutlier) {
  int outliers = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    for (const SiblingVerdict& verdict : compareSiblings(fronts(8, seed), 0.05)) {
      EXPECT_EQ(verdict.siblings, 7);
      outliers += verdict.outlier;
    }
  }
  EXPECT_LE(outliers, 12);  // 5 of 100 fleets are promised, and three standard deviations
}

TEST(Siblings, OneThatWasBumpedStandsOut) {
  std::vector<Sibling> cameras = fronts(8, 3);
  cameras[5].lens = withParameters(madeLens(), zoomed(1.1));
  const std::vector<SiblingVerdict> verdicts = compareSiblings(cameras, 0.01);
  for (std::size_t i = 0; i < verdicts.size(); ++i) EXPECT_EQ(verdicts[i].outlier, i == 5) << i;
  EXPECT_GT(verdicts[5].distance_px, 5.0);
  EXPECT_NEAR(verdicts[5].spread_px, 1.0, 0.5);
}

TEST(Siblings, OnlyCamerasOfATypeAreCompared) {
  std::vector<Sibling> cameras = fronts(3, 1);
  cameras[2].name = "robot2/rear";
  cameras.push_back({"front", madeLens(), cameras[0].covariance});
  for (const SiblingVerdict& verdict : compareSiblings(cameras, 0.01)) {
    EXPECT_EQ(verdict.siblings, 0);
    EXPECT_FALSE(verdict.outlier);
  }
}

}  // namespace
}  // namespace camera_self_calibration
