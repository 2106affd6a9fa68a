#include "camera_self_calibration/fleet/camera_history.h"

#include <gtest/gtest.h>

#include "camera_self_calibration/base/formatted.h"
#include "estimation/sample_segments.h"
#include "fleet/made_estimates.h"

namespace camera_self_calibration {
namespace {

BagRecord recordOn(int day, double zoom, const std::string& camera = "front") {
  Random random(static_cast<std::uint64_t>(100 + day));
  const Estimate estimate = madeEstimate(zoomed(zoom), 0.05, 0.0, &random);
  BagRecord record;
  record.bag = formatted("day%d.bag", day);
  record.camera = camera;
  record.begin_ns = (1700000000LL + 86400LL * day) * 1000000000LL;
  record.end_ns = record.begin_ns + 20000000000LL;
  record.lens = withParameters(madeLens(), estimate.value);
  record.covariance = estimate.covariance;
  record.uncertainty_px = 0.05;
  return record;
}

std::vector<CameraHistory> histories(std::vector<BagRecord> records) {
  return historiesOf(std::move(records), SegmentStore(), 0.01);
}

TEST(CameraHistory, BagsAreOrderedInTimeWhateverWayTheyCame) {
  const std::vector<CameraHistory> found =
      histories({recordOn(3, 1.01), recordOn(0, 1.0), recordOn(0, 1.0, "rear"), recordOn(2, 1.01),
                 recordOn(1, 1.0), recordOn(3, 1.01)});
  ASSERT_EQ(found.size(), 2u);
  const CameraHistory& front = found[0];
  EXPECT_EQ(front.name, "front");
  ASSERT_EQ(front.bags.size(), 4u) << "the same bag twice counts once";
  EXPECT_EQ(front.bags[0].record.bag, "day0.bag");
  EXPECT_EQ(front.bags[3].record.bag, "day3.bag");
  ASSERT_EQ(front.changes.size(), 1u);
  EXPECT_EQ(front.changes[0].first, 2u);
  EXPECT_EQ(found[1].bags.size(), 1u);
}

// As videos have, which all begin at 0.
TEST(CameraHistory, OtherBagsOfTheSameTimesAreOtherBags) {
  std::vector<BagRecord> records = {recordOn(0, 1.0), recordOn(1, 1.0), recordOn(0, 1.0)};
  for (BagRecord& record : records) {
    record.begin_ns = 0;
    record.end_ns = 20000000000LL;
  }
  const CameraHistory found = histories(records).at(0);
  ASSERT_EQ(found.bags.size(), 2u);
  EXPECT_EQ(found.bags[0].record.bag, "day0.bag");
  EXPECT_EQ(found.bags[1].record.bag, "day1.bag");
}

TEST(CameraHistory, BagsOfAnotherSizeOrModelAreNamed) {
  BagRecord small = recordOn(1, 1.0);
  small.lens = Camera::defaultGuess(CameraModel::kFov, 320, 240);
  BagRecord other = recordOn(4, 1.0);
  other.lens = ordinaryCameras()[0];
  other.covariance = IntrinsicsMatrix::Identity(4, 4);
  const CameraHistory found =
      histories({recordOn(0, 1.0), small, recordOn(2, 1.01), recordOn(3, 1.01), other})[0];
  EXPECT_NE(found.bags[1].problem.find("320 x 240"), std::string::npos);
  EXPECT_NE(found.bags[4].problem.find("pinhole"), std::string::npos);
  EXPECT_EQ(found.bags[4].epoch, -1);
  ASSERT_EQ(found.changes.size(), 1u);
  EXPECT_EQ(found.changes[0].first, 2u) << "counted in all bags";
  EXPECT_EQ(found.lens.model(), CameraModel::kFov);
}

// However many models the bags of one size chose.
TEST(CameraHistory, TheCommonestSizeCountsBeforeTheCommonestModel) {
  std::vector<BagRecord> records;
  for (int day = 0; day < 10; ++day) records.push_back(recordOn(day, 1.0));
  for (std::size_t i = 3; i < 6; ++i) {
    records[i].lens = ordinaryCameras()[0];
    records[i].covariance = IntrinsicsMatrix::Identity(4, 4);
  }
  for (std::size_t i = 6; i < 10; ++i) {
    records[i].lens = Camera::defaultGuess(CameraModel::kFov, 1280, 720);
  }
  const CameraHistory found = histories(records).at(0);
  EXPECT_EQ(found.lens.width(), 640);
  EXPECT_TRUE(found.bags[0].problem.empty()) << found.bags[0].problem;
  EXPECT_NE(found.bags[9].problem.find("those of most bags 640 x 480"), std::string::npos);
}

TEST(CameraHistory, WhatABagDoubtsBeyondItsNoiseCounts) {
  std::vector<BagRecord> records;
  for (int day = 0; day < 4; ++day) records.push_back(recordOn(day, day < 2 ? 1.0 : 1.003));
  EXPECT_EQ(histories(records)[0].epochs(), 2);
  for (BagRecord& record : records) record.uncertainty_px = 1.0;
  EXPECT_EQ(histories(records)[0].epochs(), 1);
}

}  // namespace
}  // namespace camera_self_calibration
