#include "camera_self_calibration/lens_change/lens_drift.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera_self_calibration/simulation/random.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kNowNs = 61000000000LL;
constexpr double kSigma = 0.5;  // [px] of fx and fy, per segment; of cx and cy a half

Camera lens() { return ordinaryCameras()[0]; }

// Twelve segments of 2 s over one minute, whose focal length is off by the share `drift(minutes
// ago)` from that of lens(); every second one stands in the queue.
template <typename Drift>
LensDrift driftOf(const Drift& drift, std::uint64_t seed, double centre_sigma = 0.5 * kSigma) {
  Random random(seed);
  std::vector<QuadraticLikelihood> queue, others;
  for (int i = 0; i < 12; ++i) {
    QuadraticLikelihood segment;
    segment.begin_ns = i * 5000000000LL;
    segment.end_ns = segment.begin_ns + 2000000000LL;
    const double ago = 1e-9 / 60.0 * static_cast<double>(kNowNs - segment.begin_ns - 1000000000LL);
    segment.point = lens().parameters();
    segment.point.head<2>() *= 1.0 + drift(ago);
    segment.point.head<2>() += kSigma * random.normal2();
    segment.point.tail<2>() += centre_sigma * random.normal2();
    segment.gradient = Intrinsics::Zero(4);
    segment.information = IntrinsicsMatrix::Identity(4, 4) / (kSigma * kSigma);
    segment.information.bottomRightCorner<2, 2>() *= 4.0;
    (i % 2 == 0 ? queue : others).push_back(segment);
  }
  return estimateDrift(queue, others, lens(), kNowNs);
}

TEST(LensDrift, ALensThatStaysIsSeldomSaidToDrift) {
  int drifting = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    drifting += driftOf([](double) { return 0.0; }, seed).significant;
  }
  EXPECT_LE(drifting, 10);
}

// The queue alone, whose mean is half a minute old, would be 2 px off.
TEST(LensDrift, TheLensIsWhereItIsNow) {
  double squares = 0.0;
  int inside = 0, drifting = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const LensDrift drift = driftOf([](double minutes) { return -0.01 * minutes; }, seed);
    drifting += drift.significant;
    if (!drift.significant) continue;
    // The mean of the queue's six middles, 35 s ago.
    const double joint = -0.01 * 35.0 / 60.0 * lens().parameters()(0);
    const double error = joint + drift.offset(0);
    const double sigma = std::sqrt(drift.covariance(0, 0));
    squares += error * error;
    inside += std::abs(error) < 3.0 * std::hypot(sigma, kSigma / std::sqrt(6.0));
    EXPECT_LT(sigma, 1.0) << seed;
    EXPECT_GT(drift.rate, 5e-4) << seed;
  }
  EXPECT_GE(drifting, 95);
  EXPECT_GE(inside, drifting - 2);
  EXPECT_LT(std::sqrt(squares / drifting), 0.7);
}

// Segments that disagree in everything do so for another reason.
TEST(LensDrift, DisagreementInOtherParametersIsNoDrift) {
  int drifting = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    drifting += driftOf([](double) { return 0.0; }, seed, 5.0 * kSigma).significant;
  }
  EXPECT_LE(drifting, 3);
}

// A walk of the fastest drift comes nearer to jumps than a lens that stays does.
TEST(LensDrift, ManyJumpsAreNoDrift) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(mixSeed(seed, 1));
    EXPECT_FALSE(driftOf([&](double) { return random.uniform(-0.15, 0.15); }, seed).significant);
  }
}

TEST(LensDrift, TooFewSegmentsSayNothing) {
  EXPECT_FALSE(estimateDrift({}, {}, lens(), kNowNs).significant);
  QuadraticLikelihood segment;
  segment.point = lens().parameters();
  segment.gradient = Intrinsics::Zero(4);
  segment.information = IntrinsicsMatrix::Identity(4, 4);
  EXPECT_FALSE(estimateDrift({segment, segment}, {segment}, lens(), kNowNs).significant);
  // Of another model.
  segment.point = segment.gradient = Intrinsics::Zero(5);
  segment.information = IntrinsicsMatrix::Identity(5, 5);
  EXPECT_FALSE(estimateDrift({segment, segment, segment, segment}, {}, lens(), kNowNs).significant);
}

}  // namespace
}  // namespace camera_self_calibration
