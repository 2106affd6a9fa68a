#include "camera_self_calibration/lens_change/innovation_monitor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kFrameNs = 50000000;

// Residual scales as a median over some 100 tracks gives them.
double usual(Random* random) { return 1.2 * std::exp(0.08 * random->normal2().x()); }

TEST(InnovationMonitor, RaisesASuspicionWithinFramesAndDatesIt) {
  for (const double factor : {1.6, 2.5, 20.0}) {
    Random random(3);
    InnovationMonitor monitor;
    std::int64_t stamp = 0;
    for (int i = 0; i < 300; ++i) monitor.add(stamp += kFrameNs, usual(&random));
    ASSERT_FALSE(monitor.suspicious());
    const std::int64_t onset = stamp + kFrameNs;
    int frames = 0;
    while (!monitor.suspicious() && frames < 50) {
      monitor.add(stamp += kFrameNs, factor * usual(&random));
      ++frames;
    }
    ASSERT_TRUE(monitor.suspicious()) << factor;
    EXPECT_LE(frames, factor > 2.0 ? 2 : 6) << factor;
    EXPECT_LE(monitor.onsetNs(), onset);
    EXPECT_GE(monitor.onsetNs(), onset - 4 * kFrameNs);
  }
}

TEST(InnovationMonitor, IsSeldomSuspiciousWithoutACause) {
  Random random(5);
  InnovationMonitor monitor;
  int suspicions = 0;
  for (int i = 0; i < 72000; ++i) {  // an hour at 20 Hz
    if (!monitor.add(i * kFrameNs, usual(&random))) continue;
    ++suspicions;
    monitor.reset();
  }
  EXPECT_LT(suspicions, 20);
}

TEST(InnovationMonitor, OneBadFrameIsNoSuspicion) {
  Random random(7);
  InnovationMonitor monitor;
  for (int i = 0; i < 400; ++i) {
    EXPECT_FALSE(monitor.add(i * kFrameNs, i % 100 == 99 ? 50.0 : usual(&random))) << i;
  }
  EXPECT_FALSE(monitor.add(0, std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace
}  // namespace camera_self_calibration
