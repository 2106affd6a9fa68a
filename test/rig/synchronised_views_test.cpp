#include "camera_self_calibration/rig/synchronised_views.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

constexpr double kMillisecond = 1e6;

// Feeds the times of two cameras [ms] in their order; returns those of the first camera in the sets
// that come out.
std::vector<double> setsOf(const std::vector<double>& first, const std::vector<double>& second,
                           SynchronisedViews* views) {
  std::vector<std::pair<double, int>> all;
  for (const double time : first) all.emplace_back(time, 0);
  for (const double time : second) all.emplace_back(time, 1);
  std::sort(all.begin(), all.end());
  std::vector<double> sets;
  for (const auto& [time, camera] : all) {
    TimedView view;
    view.stamp_ns = std::llround(time * kMillisecond);
    if (const auto set = views->add(camera, view)) {
      EXPECT_EQ(set->size(), 2u);
      sets.push_back(static_cast<double>(set->front().stamp_ns) / kMillisecond);
    }
  }
  return sets;
}

TEST(SynchronisedViews, PairsByStamp) {
  SynchronisedViews views(2);
  EXPECT_EQ(setsOf({0, 50, 100, 150}, {0.4, 100, 150.2}, &views),
            (std::vector<double>{0, 100, 150}));
  EXPECT_EQ(views.problem(), "");
}

TEST(SynchronisedViews, SaysHowFarApartTheyAre) {
  SynchronisedViews views(2);
  EXPECT_TRUE(setsOf({0, 50, 100, 150}, {7, 57, 107, 157}, &views).empty());
  EXPECT_NE(views.problem().find("differ by 7.0 ms"), std::string::npos) << views.problem();
}

TEST(SynchronisedViews, WhatIsNewerCountsMore) {
  SynchronisedViews views(2);
  std::vector<double> times;
  std::vector<double> shifted;
  for (int i = 0; i < 2000; ++i) {
    times.push_back(50.0 * i);
    shifted.push_back(50.0 * i + (i < 1000 ? 7.0 : 0.0));
  }
  setsOf(times, shifted, &views);
  EXPECT_EQ(views.problem(), "");
}

TEST(SynchronisedViews, CamerasMayLagBehindEachOther) {
  SynchronisedViews views(2);
  for (int i = 0; i < 20; ++i) {
    TimedView view;
    view.stamp_ns = i;
    EXPECT_FALSE(views.add(0, view));
  }
  for (int i = 0; i < 20; ++i) {
    TimedView view;
    view.stamp_ns = i;
    EXPECT_TRUE(views.add(1, view));
  }
}

TEST(SynchronisedViews, TimeMayJumpBack) {
  SynchronisedViews views(2);
  EXPECT_EQ(setsOf({500, 550, 600}, {500}, &views).size(), 1u);
  EXPECT_EQ(setsOf({0, 50}, {0, 50}, &views), (std::vector<double>{0, 50}));
}

}  // namespace
}  // namespace camera_self_calibration
