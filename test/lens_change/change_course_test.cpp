#include "camera_self_calibration/lens_change/change_course.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera_self_calibration/simulation/random.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

constexpr int kSegments = 12;
constexpr double kSigma = 0.3;  // [px] of each parameter, per segment

// Segments of 3 s whose fx is off by `offset(time)` from the reference.
template <typename Offset>
std::vector<QuadraticLikelihood> segmentsWith(const Camera& lens, const Offset& offset,
                                              std::uint64_t seed) {
  Random random(seed);
  std::vector<QuadraticLikelihood> segments;
  for (int i = 0; i < kSegments; ++i) {
    QuadraticLikelihood segment;
    segment.begin_ns = i * 3000000000LL;
    segment.end_ns = segment.begin_ns + 2000000000LL;
    segment.point = lens.parameters();
    segment.information = IntrinsicsMatrix::Identity(4, 4) / (kSigma * kSigma);
    Intrinsics difference = Intrinsics::Zero(4);
    difference(0) = offset(3.0 * i + 1.0);
    difference.head<2>() += kSigma * random.normal2();
    segment.gradient = segment.information * difference;
    segments.push_back(segment);
  }
  return segments;
}

class ChangeCourseTest : public testing::Test {
 protected:
  const Camera lens_ = ordinaryCameras()[0];
  const Reference reference_{lens_, IntrinsicsMatrix::Identity(4, 4) * 1e4, Scatter()};
  double focal(const ChangeCourse& course) const {
    return course.camera.parameters()(0) - lens_.parameters()(0);
  }
};

TEST_F(ChangeCourseTest, AStepIsDatedAndMeasured) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto course =
        courseOfChange(segmentsWith(
                           lens_, [](double t) { return t > 20.0 ? 3.0 : 0.0; }, seed),
                       reference_);
    EXPECT_FALSE(course.gradual) << seed;
    EXPECT_EQ(course.first, 7u) << seed;
    EXPECT_NEAR(focal(course), 3.0, 4.0 * kSigma / std::sqrt(5.0));
    EXPECT_NEAR(course.information(0, 0), 5.0 / (kSigma * kSigma), 1e-6);
  }
}

TEST_F(ChangeCourseTest, ARampIsTold) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto course = courseOfChange(segmentsWith(
                                           lens_, [](double t) { return 0.2 * t; }, seed),
                                       reference_);
    EXPECT_TRUE(course.gradual) << seed;
    EXPECT_NEAR(focal(course), 0.2 * 34.0, 5.0 * std::sqrt(1.0 / course.information(0, 0)));
  }
}

TEST_F(ChangeCourseTest, OfOneSegmentIsAStep) {
  auto segments = segmentsWith(
      lens_, [](double) { return 2.0; }, 1);
  segments.resize(2);
  const auto course = courseOfChange(segments, reference_);
  EXPECT_FALSE(course.gradual);
  EXPECT_NEAR(focal(course), 2.0, 4.0 * kSigma);
}

}  // namespace
}  // namespace camera_self_calibration
