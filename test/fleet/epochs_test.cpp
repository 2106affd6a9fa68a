#include "camera_self_calibration/fleet/epochs.h"

#include <gtest/gtest.h>

#include "fleet/made_estimates.h"

namespace camera_self_calibration {
namespace {

TEST(Epochs, ALensThatStaysHasOne) {
  const auto splits = findEpochs({madeSeries(std::vector<double>(20, 1.0), 0.1, 0.0, 1)}, 0.01);
  ASSERT_EQ(splits.size(), 1u);
  EXPECT_EQ(splits[0].epochs(), 1);
  EXPECT_EQ(splits[0].epoch, std::vector<int>(20, 0));
}

TEST(Epochs, ARefocusIsFoundAndDated) {
  const auto splits = findEpochs({madeSeries({1, 1, 1, 1.005, 1.005, 1.005}, 0.05, 0.0, 2)}, 0.01);
  ASSERT_EQ(splits[0].changes.size(), 1u);
  EXPECT_EQ(splits[0].changes[0].first, 3u);
  EXPECT_EQ(splits[0].epoch, (std::vector<int>{0, 0, 0, 1, 1, 1}));
}

TEST(Epochs, SeveralChangesAndTheLastBagAlone) {
  const auto splits = findEpochs(
      {madeSeries({1, 1, 1, 1, 1.02, 1.02, 1.02, 0.99, 0.99, 1.03}, 0.05, 0.0, 3)}, 0.01);
  EXPECT_EQ(splits[0].epoch, (std::vector<int>{0, 0, 0, 0, 1, 1, 1, 2, 2, 3}));
}

TEST(Epochs, ABagOfAnotherCameraIsNoChange) {
  const auto splits = findEpochs({madeSeries({1, 1, 1, 1.05, 1, 1, 1}, 0.05, 0.0, 4)}, 0.01);
  EXPECT_EQ(splits[0].epochs(), 1);
  EXPECT_EQ(splits[0].epoch, (std::vector<int>{0, 0, 0, -1, 0, 0, 0}));
}

TEST(Epochs, EachCameraHasItsOwn) {
  const auto splits = findEpochs({madeSeries({1, 1, 1}, 0.05, 0.0, 5),
                                  {madeLens(), {}},
                                  madeSeries({1}, 0.05, 0.0, 6),
                                  madeSeries({1, 1.02}, 0.05, 0.0, 7)},
                                 0.01);
  ASSERT_EQ(splits.size(), 4u);
  EXPECT_EQ(splits[0].epochs(), 1);
  EXPECT_TRUE(splits[1].epoch.empty());
  EXPECT_EQ(splits[2].epoch, std::vector<int>{0});
  EXPECT_EQ(splits[3].epoch, (std::vector<int>{0, 1}));
}

// Of fleets without a change the share `level` shows one, however many bags they have, and whether
// or not bags scatter beyond their sigmas.
TEST(Epochs, FalseChangesAreAsRareInAFleetAsPromised) {
  constexpr double kLevel = 0.1;
  constexpr int kFleets = 200;
  for (const double tau : {0.0, 0.2}) {
    int fleets_with_a_change = 0;
    for (int fleet = 0; fleet < kFleets; ++fleet) {
      std::vector<EstimateSeries> cameras;
      for (int camera = 0; camera < 5; ++camera) {
        cameras.push_back(madeSeries(std::vector<double>(6, 1.0), 0.1, tau,
                                     static_cast<std::uint64_t>(10 * fleet + camera)));
      }
      bool any = false;
      for (const EpochSplit& split : findEpochs(cameras, kLevel)) {
        any |= split.epochs() > 1 || split.epoch != std::vector<int>(6, 0);
      }
      fleets_with_a_change += any;
    }
    // Three standard deviations more.
    EXPECT_LE(fleets_with_a_change, kLevel * kFleets + 13) << "tau " << tau;
  }
}

}  // namespace
}  // namespace camera_self_calibration
