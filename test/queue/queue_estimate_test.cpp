#include "camera_self_calibration/queue/queue_estimate.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "estimation/sample_segments.h"

namespace camera_self_calibration {
namespace {

Candidate candidateOf(const Camera& truth, std::uint64_t seed,
                      MotionKind motion = MotionKind::kHandheld) {
  SegmentOptions options;
  options.motion = motion;
  options.camera = truth;
  options.tracks.max_features = 60;
  options.tracks.pixel_sigma = 0.3;
  const SimulatedSegment made = makeSegment(options, seed);
  return evaluateCandidate(CandidateOptions(), perturbed(made.segment, {}, seed),
                           perturbedCamera(truth, seed));
}

double mahalanobis(const Camera& a, const Camera& b, const IntrinsicsMatrix& information) {
  const Eigen::VectorXd difference = a.parameters() - b.parameters();
  return difference.dot(information * difference);
}

TEST(QueueEstimate, JoinsWhatSegmentsTell) {
  for (const Camera& truth : ordinaryCameras()) {
    QueueEstimate estimate(2);
    IntrinsicsMatrix sum = IntrinsicsMatrix::Zero(truth.estimatedCount(), truth.estimatedCount());
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      estimate.add(candidateOf(truth, seed));
      ASSERT_TRUE(estimate.candidates().back().well_posed);
      sum += estimate.candidates().back().information;
    }
    const QueueSolution solution = estimate.solve(perturbedCamera(truth, 1, 0.3));
    ASSERT_TRUE(solution.usable);
    EXPECT_LT(solution.scatter.inflation(), 1.7);
    // Nearly the sum of the marginals at the segments' own optima.
    const IntrinsicsMatrix raw =
        solution.information * solution.scatter.inflation() * solution.scatter.inflation();
    for (int i = 0; i < truth.estimatedCount(); ++i) EXPECT_NEAR(raw(i, i) / sum(i, i), 1.0, 0.3);
    // Chi-square with n_c degrees, 1 in 10000.
    EXPECT_LT(mahalanobis(solution.camera, truth, solution.information), 35.0);
  }
}

TEST(QueueEstimate, OfOneSegmentIsThatSegments) {
  const Camera truth = ordinaryCameras()[1];
  QueueEstimate estimate(1);
  const Candidate candidate = candidateOf(truth, 7);
  estimate.add(candidate);
  const QueueSolution solution = estimate.solve(candidate.camera);
  ASSERT_TRUE(solution.usable);
  EXPECT_EQ(solution.scatter.inflation(), 1.0);
  EXPECT_LT(mahalanobis(solution.camera, candidate.camera, candidate.information), 0.01);
}

// Segments of two different lenses cannot both be right: the uncertainty says so.
TEST(QueueEstimate, InflatesWhenSegmentsDisagree) {
  const Camera truth = ordinaryCameras()[1];
  Intrinsics other = truth.parameters();
  other.head<2>() *= 1.03;
  QueueEstimate agreeing(1), torn(1);
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    agreeing.add(candidateOf(truth, seed));
    torn.add(candidateOf(seed % 2 == 0 ? truth : withParameters(truth, other), seed));
  }
  const QueueSolution good = agreeing.solve(truth);
  const QueueSolution bad = torn.solve(truth);
  EXPECT_LT(good.scatter.inflation(), 1.7);
  EXPECT_GT(bad.scatter.inflation(), 3.0);
  EXPECT_LT(bad.information(0, 0), 0.3 * good.information(0, 0));
}

// Rotation on the spot tells neither translations nor depths; they must not be lost on the way of
// the intrinsics, which would look like disagreement.
TEST(QueueEstimate, SegmentsOfRotationAgree) {
  for (const int c : {0, 1, 3}) {
    const Camera truth = ordinaryCameras()[c];
    QueueEstimate estimate(1);
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      estimate.add(candidateOf(truth, seed, MotionKind::kRotationOnly));
    }
    QueueSolution solution;
    for (const double factor : {0.8, 1.3, 1.0}) {
      Intrinsics start = truth.parameters();
      start.head<2>() *= factor;
      solution = estimate.solve(withParameters(truth, start));
    }
    ASSERT_TRUE(solution.usable);
    EXPECT_LT(solution.scatter.inflation(), 2.0) << toString(truth.model());
    EXPECT_LT(mahalanobis(solution.camera, truth, solution.information), 35.0);
    for (const Candidate& candidate : estimate.candidates()) {
      Candidate copy = candidate;
      SegmentBlock block = freeBlock(&copy.segment, solution.camera);
      block.sigma_scale = copy.sigma_scale;
      EXPECT_LT(robustCost(block, solution.camera, 2.0), 1.1 * copy.cost + 20.0);
    }
  }
}

TEST(QueueEstimate, IsTheSameForAnyNumberOfThreads) {
  const Camera truth = ordinaryCameras()[2];
  std::vector<QueueSolution> solutions;
  for (const int threads : {1, 2, 3}) {
    QueueEstimate estimate(threads);
    for (std::uint64_t seed = 0; seed < 4; ++seed) estimate.add(candidateOf(truth, seed));
    solutions.push_back(estimate.solve(perturbedCamera(truth, 1, 0.3)));
  }
  for (int i = 1; i < 3; ++i) {
    EXPECT_EQ(solutions[0].camera.parameters(), solutions[i].camera.parameters());
    EXPECT_EQ(solutions[0].information, solutions[i].information);
    EXPECT_EQ(solutions[0].scatter.inflation(), solutions[i].scatter.inflation());
  }
}

TEST(QueueEstimate, RemovesBySequence) {
  const Camera truth = ordinaryCameras()[0];
  QueueEstimate estimate(1);
  EXPECT_FALSE(estimate.solve(truth).usable);
  for (std::uint64_t seed = 0; seed < 3; ++seed) estimate.add(candidateOf(truth, seed));
  estimate.remove({1, 99});
  ASSERT_EQ(estimate.candidates().size(), 2u);
  EXPECT_EQ(estimate.candidates()[0].segment.sequence, 0);
  EXPECT_EQ(estimate.candidates()[1].segment.sequence, 2);
  estimate.clear();
  EXPECT_TRUE(estimate.candidates().empty());
}

}  // namespace
}  // namespace camera_self_calibration
