#include "camera_self_calibration/queue/cross_validation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "estimation/sample_segments.h"
#include "queue/sample_queues.h"

namespace camera_self_calibration {
namespace {

const Camera kLens = ordinaryCameras()[2];

Camera zoomed(const Camera& camera, double factor) {
  Intrinsics parameters = camera.parameters();
  parameters.head<2>() *= factor;
  return withParameters(camera, parameters);
}

// A solution of four equally good segments, each at its own `offset` from the joint optimum, in the
// first parameter, with a standard deviation of one pixel.
QueueSolution solutionOf(const std::vector<double>& offsets) {
  QueueSolution solution;
  solution.usable = true;
  solution.camera = ordinaryCameras()[0];
  const IntrinsicsMatrix own = IntrinsicsMatrix::Identity(4, 4);
  for (const double offset : offsets) {
    Intrinsics off = Intrinsics::Zero(4);
    off(0) = offset;
    solution.shares.push_back({own, own * off});
  }
  solution.information = static_cast<double>(offsets.size()) * own;
  solution.covariance = solution.information.inverse();
  return solution;
}

TEST(CrossValidation, NeedsTwoHalves) {
  EXPECT_FALSE(crossValidate(QueueSolution(), {}).compared);
  const CrossValidation one = crossValidate(solutionOf({0.0}), {});
  EXPECT_FALSE(one.compared);
  EXPECT_EQ(one.inflation(), 1.0);
  EXPECT_TRUE(std::isinf(one.blindBelowPx()));
  EXPECT_EQ(one.sentence(), "");
}

TEST(CrossValidation, IsTheDistanceOfTheHalvesEstimates) {
  const QueueSolution solution = solutionOf({0.5, -0.5});
  const CrossValidation halves = crossValidate(solution, {});
  ASSERT_TRUE(halves.compared);
  const IntrinsicsMatrix metric = pixelMetric(solution.camera);
  EXPECT_NEAR(halves.difference_px, std::sqrt(metric(0, 0)), 1e-9);
  EXPECT_NEAR(halves.expected_px, std::sqrt(2.0 * metric.trace()), 1e-9);
  EXPECT_TRUE(halves.agrees());
  EXPECT_EQ(halves.sentence().rfind("two parts of the video that share no image agree on", 0), 0u)
      << halves.sentence();
}

// What the halves are expected to differ by follows the stated covariance.
TEST(CrossValidation, ALargerUncertaintyExplainsMore) {
  QueueSolution solution = solutionOf({20.0, -20.0, 20.0, -20.0});
  const double expected = crossValidate(solution, {}).expected_px;
  solution.covariance *= 9.0;
  EXPECT_NEAR(crossValidate(solution, {}).expected_px, 3.0 * expected, 1e-9);
}

TEST(CrossValidation, ADisagreementIsCoveredByTheUncertainty) {
  const CrossValidation halves = crossValidate(solutionOf({10.0, -10.0}), {});
  ASSERT_TRUE(halves.compared);
  EXPECT_FALSE(halves.agrees());
  EXPECT_LT(halves.p_value, 1e-3);
  EXPECT_NEAR(halves.inflation() * halves.expected_px, halves.difference_px, 1e-9);
  EXPECT_NE(halves.sentence().find("disagree"), std::string::npos) << halves.sentence();
}

// The first-order difference is that of the halves solved on their own.
TEST(CrossValidation, AgreesWithSolutionsOfTheHalves) {
  std::vector<Segment> segments = separateSegments(kLens, 2);
  const SegmentQueue queue = solvedQueue(segments, kLens);
  const CrossValidation halves = crossValidate(queue.solution(), {});
  ASSERT_TRUE(halves.compared);
  const SegmentQueue one = solvedQueue({segments[0]}, kLens);
  const SegmentQueue other = solvedQueue({segments[1]}, kLens);
  const double distance = pixelDistance(one.solution().camera, other.solution().camera).rms;
  EXPECT_NEAR(halves.difference_px, distance, 0.15 * distance);
}

TEST(CrossValidation, HalvesOfOneLensAgreeAndOfTwoLensesDoNot) {
  std::vector<double> ratios;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const SegmentQueue queue = solvedQueue(separateSegments(kLens, 2, seed), kLens);
    const CrossValidation halves = crossValidate(queue.solution(), {});
    ASSERT_TRUE(halves.compared) << seed;
    EXPECT_TRUE(halves.agrees()) << seed << ": " << halves.sentence();
    ratios.push_back(halves.difference_px / halves.expected_px);
  }
  double squares = 0.0;
  for (const double ratio : ratios) squares += ratio * ratio;
  // The expectation is one, of a chi-square of some two degrees of freedom a seed.
  EXPECT_GT(squares / ratios.size(), 0.3);
  EXPECT_LT(squares / ratios.size(), 2.0);

  std::vector<Segment> torn = separateSegments(kLens, 2);
  torn[1] = separateSegments(zoomed(kLens, 1.05), 2)[1];
  const CrossValidation halves = crossValidate(solvedQueue(torn, kLens).solution(), {});
  ASSERT_TRUE(halves.compared);
  EXPECT_GT(halves.difference_px, 3.0);
}

}  // namespace
}  // namespace camera_self_calibration
