#include "camera_self_calibration/lens_change/lens_step.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera_self_calibration/simulation/random.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kNowNs = 61000000000LL;
constexpr int kSegments = 12;
constexpr double kSigma = 0.5;   // [px] of fx and fy, per segment; of cx and cy a half
constexpr double kLimit = 1e-6;  // what 0.1 false alarms an hour leave to one keyframe's test

Camera lens() { return ordinaryCameras()[0]; }

// Segments of 2 s, one every 5 s, whose focal length is off by the share `change(seconds)` from
// that of lens().
template <typename Change>
std::vector<QuadraticLikelihood> segmentsWith(const Change& change, std::uint64_t seed) {
  Random random(seed);
  std::vector<QuadraticLikelihood> segments;
  for (int i = 0; i < kSegments; ++i) {
    QuadraticLikelihood segment;
    segment.begin_ns = i * 5000000000LL;
    segment.end_ns = segment.begin_ns + 2000000000LL;
    segment.point = lens().parameters();
    segment.point.head<2>() *= 1.0 + change(5.0 * i + 1.0);
    segment.point.head<2>() += kSigma * random.normal2();
    segment.point.tail<2>() += 0.5 * kSigma * random.normal2();
    segment.gradient = Intrinsics::Zero(4);
    segment.information = IntrinsicsMatrix::Identity(4, 4) / (kSigma * kSigma);
    segment.information.bottomRightCorner<2, 2>() *= 4.0;
    segments.push_back(segment);
  }
  return segments;
}

template <typename Change>
int found(const Change& change, int trials, double limit = kLimit) {
  int count = 0;
  for (int seed = 1; seed <= trials; ++seed) {
    const auto segments = segmentsWith(change, static_cast<std::uint64_t>(seed));
    count += estimateStep(segments, lens(), kNowNs, limit).has_value();
  }
  return count;
}

// Two segments after it, and as many as before.
TEST(LensStep, IsFoundDatedAndMeasured) {
  for (const int before : {6, 10}) {
    int count = 0, dated = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      const auto change = [&](double t) { return t > 5.0 * before ? 0.01 : 0.0; };
      const auto step = estimateStep(segmentsWith(change, seed), lens(), kNowNs, kLimit);
      if (!step) continue;
      ++count;
      dated += step->onset_ns == before * 5000000000LL;
      const double after = kSegments - before;
      EXPECT_NEAR(step->camera.parameters()(0), 1.01 * lens().parameters()(0),
                  5.0 * kSigma / std::sqrt(after));
      EXPECT_LT(step->p_value, kLimit);
    }
    EXPECT_GE(count, 190) << before;
    EXPECT_GE(dated, count - 4) << before;
  }
}

// The order in which segments are given is not that of time.
TEST(LensStep, DoesNotDependOnTheOrder) {
  auto segments = segmentsWith([](double t) { return t > 30.0 ? 0.01 : 0.0; }, 1);
  const auto step = estimateStep(segments, lens(), kNowNs, kLimit);
  std::swap(segments[1], segments[9]);
  const auto again = estimateStep(segments, lens(), kNowNs, kLimit);
  ASSERT_TRUE(step && again);
  EXPECT_EQ(step->onset_ns, again->onset_ns);
  EXPECT_NEAR(std::log(step->p_value), std::log(again->p_value), 1e-6);
}

TEST(LensStep, ASlowDriftIsNone) {
  EXPECT_LE(found([](double t) { return 0.01 * t / 60.0; }, 300), 1);
  for (const double begin : {15.0, 30.0}) {
    EXPECT_LE(found([&](double t) { return 0.01 * std::max(0.0, t - begin) / 60.0; }, 300), 1);
  }
}

// The p-value is a bound.
TEST(LensStep, AConstantLensHasNone) {
  const auto none = [](double) { return 0.0; };
  EXPECT_EQ(found(none, 300), 0);
  EXPECT_LE(found(none, 300, 0.1), 30);
}

// In the newest segment as in any other: one that shows something that moves.
TEST(LensStep, NoSingleSegmentDecides) {
  for (const double when : {1.0, 31.0, 56.0}) {
    EXPECT_EQ(found([&](double t) { return std::abs(t - when) < 1.0 ? 0.03 : 0.0; }, 100), 0);
  }
}

// Trials of 200 that show a drift.
template <typename Change>
int drifting(const Change& change) {
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    count += showsDrift(segmentsWith(change, seed), lens(), kNowNs);
  }
  return count;
}

TEST(LensStep, IsToldFromADrift) {
  EXPECT_GE(drifting([](double t) { return 0.01 * t / 60.0; }), 190);
  EXPECT_GE(drifting([](double t) { return 0.02 * std::max(0.0, t - 30.0) / 60.0; }), 190);
  EXPECT_LE(drifting([](double) { return 0.0; }), 10);
  for (const double size : {0.01, 0.03}) {
    EXPECT_LE(drifting([&](double t) { return t > 30.0 ? size : 0.0; }), 10) << size;
  }
}

TEST(LensStep, TooFewSegmentsSayNothing) {
  auto segments = segmentsWith([](double t) { return t > 5.0 ? 0.01 : 0.0; }, 1);
  segments.resize(3);
  EXPECT_FALSE(estimateStep(segments, lens(), kNowNs, kLimit));
  for (QuadraticLikelihood& segment : segments) {  // of another model
    segment.point = segment.gradient = Intrinsics::Zero(5);
    segment.information = IntrinsicsMatrix::Identity(5, 5);
  }
  EXPECT_FALSE(estimateStep(segments, lens(), kNowNs, kLimit));
  EXPECT_FALSE(estimateStep({}, lens(), kNowNs, kLimit));
}

}  // namespace
}  // namespace camera_self_calibration
