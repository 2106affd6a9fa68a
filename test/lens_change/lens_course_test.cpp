#include "camera_self_calibration/lens_change/lens_course.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera_self_calibration/simulation/random.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kNowNs = 61000000000LL;
constexpr int kSegments = 12;
constexpr double kSigma = 0.5;   // [px] of fx and fy, per segment; of cx and cy a half
constexpr double kLimit = 3e-5;  // what 0.1 false alarms an hour leave to a segment's test
constexpr double kStrong = 10.0;

Camera lens() { return ordinaryCameras()[0]; }

struct Scene {
  double sigmas = 1.0;     // errors, in stated ones
  double centre_px = 0.0;  // a step of the centre at 30 s
};

// Segments of 2 s, one every 5 s, whose focal length is off by the share `change(seconds)` from
// that of lens().
template <typename Change>
std::vector<QuadraticLikelihood> segmentsWith(const Change& change, std::uint64_t seed,
                                              const Scene& scene = {}) {
  Random random(seed);
  std::vector<QuadraticLikelihood> segments;
  for (int i = 0; i < kSegments; ++i) {
    QuadraticLikelihood segment;
    segment.begin_ns = i * 5000000000LL;
    segment.end_ns = segment.begin_ns + 2000000000LL;
    segment.point = lens().parameters();
    segment.point.head<2>() *= 1.0 + change(5.0 * i + 1.0);
    segment.point.head<2>() += scene.sigmas * kSigma * random.normal2();
    segment.point.tail<2>() += scene.sigmas * 0.5 * kSigma * random.normal2();
    if (i >= 6) segment.point(2) += scene.centre_px;
    segment.gradient = Intrinsics::Zero(4);
    segment.information = IntrinsicsMatrix::Identity(4, 4) / (kSigma * kSigma);
    segment.information.bottomRightCorner<2, 2>() *= 4.0;
    segments.push_back(segment);
  }
  return segments;
}

template <typename Change>
LensCourse courseWith(const Change& change, std::uint64_t seed, const Scene& scene = {}) {
  return courseOfLens(segmentsWith(change, seed, scene), lens(), kNowNs);
}

double none(double) { return 0.0; }

bool isFound(const LensCourse& course) { return course.pValue() < kLimit && course.exceeds(100.0); }

template <typename Change>
int found(const Change& change, int trials, const Scene& scene = {}) {
  int count = 0;
  for (int seed = 1; seed <= trials; ++seed) {
    count += isFound(courseWith(change, static_cast<std::uint64_t>(seed), scene));
  }
  return count;
}

// Two segments after it, and as many as before.
TEST(LensCourse, AStepIsFoundDatedAndTold) {
  for (const int before : {6, 10}) {
    int count = 0, dated = 0, told = 0;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
      const LensCourse course =
          courseWith([&](double t) { return t > 5.0 * before ? 0.01 : 0.0; }, seed);
      count += isFound(course);
      dated += course.onset_ns == before * 5000000000LL;
      told += course.step > course.drift + std::log(kStrong);
      const double after = kSegments - before;
      EXPECT_NEAR(course.now(0), 1.01 * lens().parameters()(0), 6.0 * kSigma / std::sqrt(after));
    }
    EXPECT_GE(count, 99) << before;
    EXPECT_GE(dated, 97) << before;
    EXPECT_GE(told, 95) << before;
  }
}

TEST(LensCourse, ASmallStepOfTheCentreIsFound) { EXPECT_GE(found(none, 50, {1.0, 2.0}), 48); }

// The order in which segments are given is not that of time.
TEST(LensCourse, DoesNotDependOnTheOrder) {
  auto segments = segmentsWith([](double t) { return t > 30.0 ? 0.01 : 0.0; }, 1);
  const LensCourse course = courseOfLens(segments, lens(), kNowNs);
  std::swap(segments[1], segments[9]);
  const LensCourse again = courseOfLens(segments, lens(), kNowNs);
  EXPECT_EQ(course.onset_ns, again.onset_ns);
  EXPECT_NEAR(course.step, again.step, 1e-6);
  EXPECT_NEAR(course.drift, again.drift, 1e-6);
}

// From its beginning on, and from the middle on.
TEST(LensCourse, ADriftIsFoundAndTold) {
  for (const double begin : {0.0, 30.0}) {
    int count = 0, told = 0;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
      const LensCourse course =
          courseWith([&](double t) { return 0.02 * std::max(0.0, t - begin) / 60.0; }, seed);
      count += isFound(course);
      told += course.drift > course.step;
    }
    EXPECT_GE(count, 98) << begin;
    EXPECT_GE(told, 98) << begin;
  }
}

// The mean of all segments is half a minute old, and 2 px off.
TEST(LensCourse, ADriftingLensIsWhereItIsNow) {
  double squares = 0.0;
  int inside = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const LensCourse course = courseWith([](double t) { return 0.01 * (t - 61.0) / 60.0; }, seed);
    EXPECT_TRUE(course.exceeds(kStrong)) << seed;
    const double sigma = std::sqrt(course.covariance(0, 0));
    const double error = course.now(0) - lens().parameters()(0);
    squares += error * error;
    inside += std::abs(error) < 3.0 * sigma;
    EXPECT_LT(sigma, 1.0) << seed;
    EXPECT_NEAR(std::log(course.rate), std::log(0.01), 2.0) << seed;
  }
  EXPECT_GE(inside, 98);
  EXPECT_LT(std::sqrt(squares / 100.0), 0.7);
}

// Expectation 1: seldom large, whether the stated errors are right or not.
TEST(LensCourse, TheEvidenceOfAConstantLensIsBounded) {
  for (const double sigmas : {1.0, 2.0}) {
    double sum = 0.0;
    int above = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
      const LensCourse course = courseWith(none, seed, {sigmas});
      sum += std::exp(course.moved());
      above += course.exceeds(kStrong);
    }
    EXPECT_LT(sum, 400.0) << sigmas;
    EXPECT_LE(above, 400 / static_cast<int>(kStrong)) << sigmas;
    EXPECT_EQ(found(none, 400, {sigmas}), 0) << sigmas;
  }
}

// In the newest segment as in any other: one that shows something that moves.
TEST(LensCourse, NoSingleSegmentDecides) {
  for (const double when : {1.0, 31.0, 56.0}) {
    EXPECT_EQ(found([&](double t) { return std::abs(t - when) < 1.0 ? 0.03 : 0.0; }, 100), 0);
  }
}

// Whichever of four segments shows something that moves, but for the newest, which may be the first
// after a step. No other is taken for it.
TEST(LensCourse, AWrongSegmentIsNamed) {
  for (const int wrong : {0, 1, 2, 3}) {
    int named = 0;
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
      auto segments =
          segmentsWith([&](double t) { return int(t / 5.0) == wrong ? 0.05 : 0.0; }, seed);
      segments.resize(4);
      const LensCourse course = courseOfLens(segments, lens(), segments.back().end_ns);
      if (!(course.wrong > std::log(kStrong))) continue;
      EXPECT_EQ(course.wrong_begin_ns, segments[wrong].begin_ns) << wrong;
      ++named;
    }
    EXPECT_EQ(named, wrong < 3 ? 50 : 0) << wrong;
  }
}

TEST(LensCourse, NoSegmentOfAConstantOrSteppingLensIsWrong) {
  for (const double after : {0.0, 0.03}) {
    int named = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
      const auto step = [&](double t) { return t > 30.0 ? after : 0.0; };
      named += courseWith(step, seed).wrong > std::log(kStrong);
    }
    EXPECT_LE(named, 2) << after;
  }
}

TEST(LensCourse, ManyJumpsAreNoDrift) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(mixSeed(seed, 1));
    const LensCourse course = courseWith([&](double) { return random.uniform(-0.15, 0.15); }, seed);
    EXPECT_FALSE(isFound(course) && course.drift > course.step);
  }
}

TEST(LensCourse, TooFewSegmentsSayNothing) {
  auto segments = segmentsWith([](double t) { return t > 5.0 ? 0.05 : 0.0; }, 1);
  segments.resize(3);
  EXPECT_FALSE(courseOfLens(segments, lens(), kNowNs).exceeds(kStrong));
  for (QuadraticLikelihood& segment : segments) {  // of another model
    segment.point = segment.gradient = Intrinsics::Zero(5);
    segment.information = IntrinsicsMatrix::Identity(5, 5);
  }
  EXPECT_FALSE(courseOfLens(segments, lens(), kNowNs).exceeds(kStrong));
  EXPECT_FALSE(courseOfLens({}, lens(), kNowNs).exceeds(kStrong));
}

}  // namespace
}  // namespace camera_self_calibration
