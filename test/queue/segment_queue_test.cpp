#include "camera_self_calibration/queue/segment_queue.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "estimation/sample_segments.h"
#include "lens_change/change_samples.h"

namespace camera_self_calibration {
namespace {

std::vector<Candidate> candidatesOf(const Camera& truth, int count,
                                    MotionKind motion = MotionKind::kHandheld) {
  std::vector<Candidate> candidates;
  for (int seed = 0; seed < count; ++seed) {
    candidates.push_back(candidateOf(truth, perturbedCamera(truth, seed), seed, motion));
    EXPECT_TRUE(candidates.back().well_posed) << candidates.back().reason;
  }
  return candidates;
}

double mahalanobis(const Camera& a, const Camera& b, const IntrinsicsMatrix& information) {
  const Eigen::VectorXd difference = a.parameters() - b.parameters();
  return difference.dot(information * difference);
}

std::vector<std::int64_t> sequences(const SegmentQueue& queue) {
  std::vector<std::int64_t> list;
  for (const Candidate& candidate : queue.candidates()) list.push_back(candidate.segment.sequence);
  return list;
}

using Ids = std::vector<std::int64_t>;

// That the solution is the one of the segments: each has its share, and the queue would not move
// by a tenth of a sigma if it were solved once more.
void expectInStep(const SegmentQueue& queue) {
  const QueueSolution& solution = queue.solution();
  if (queue.candidates().empty()) {
    EXPECT_FALSE(solution.usable);
    return;
  }
  ASSERT_TRUE(solution.usable);
  EXPECT_EQ(solution.shares.size(), queue.candidates().size());
  SegmentQueue again = queue;
  again.exchange({}, {}, {solution.camera});
  EXPECT_LT(mahalanobis(again.solution().camera, solution.camera, solution.information), 0.01);
  for (const Candidate& a : queue.candidates()) {
    for (const Candidate& b : queue.candidates()) {
      const bool apart =
          a.segment.endNs() < b.segment.beginNs() || b.segment.endNs() < a.segment.beginNs();
      EXPECT_TRUE(&a == &b || apart) << a.segment.sequence << " " << b.segment.sequence;
    }
  }
}

TEST(SegmentQueue, SegmentsAndSolutionStayInStep) {
  const Camera truth = ordinaryCameras()[1];
  const std::vector<Candidate> candidates = candidatesOf(truth, 5);
  SegmentQueue queue(QueuePolicy(3, 0.95), 1);
  expectInStep(queue);
  for (const Candidate& candidate : candidates) {
    queue.offer(candidate, {truth});
    expectInStep(queue);
  }
  EXPECT_EQ(queue.candidates().size(), 3u) << "bounded";
  const Ids before = sequences(queue);
  queue.exchange({before[1], 99}, {}, {truth});
  EXPECT_EQ(sequences(queue), (Ids{before[0], before[2]}));
  expectInStep(queue);
  queue.exchange({before[0]}, {candidates[before[1]]}, {truth});
  EXPECT_EQ(sequences(queue), (Ids{before[2], before[1]}));
  expectInStep(queue);
  queue.exchange(before, {}, {truth});
  expectInStep(queue);
  EXPECT_EQ(queue.rebuild({candidates[0], candidates[1], candidates[0]}, {truth}), 2);
  expectInStep(queue);
  queue.clear();
  EXPECT_TRUE(queue.candidates().empty());
  expectInStep(queue);
}

TEST(SegmentQueue, RefusesWithTheReasonAndStaysAsItIs) {
  const Camera truth = ordinaryCameras()[1];
  std::vector<Candidate> candidates = candidatesOf(truth, 2);
  SegmentQueue queue(QueuePolicy(3, 0.95), 1);
  ASSERT_TRUE(queue.offer(candidates[0], {truth}).accepted);
  const Camera before = queue.solution().camera;
  EXPECT_FALSE(queue.offer(candidates[0], {truth}).accepted) << "the same moments";
  candidates[1].well_posed = false;
  candidates[1].reason = "made up";
  const QueueDecision decision = queue.offer(candidates[1], {truth});
  EXPECT_FALSE(decision.accepted);
  EXPECT_EQ(decision.reason, "refused: made up");
  EXPECT_EQ(queue.offer(candidates, {truth}), 0);
  EXPECT_EQ(queue.solution().camera.parameters(), before.parameters());
  EXPECT_EQ(sequences(queue), Ids{0});
}

// What is known of the line delay makes the covariance larger along the way that it moves the
// intrinsics, and nothing else.
TEST(SegmentQueue, ALineDelayInDoubtAddsUncertainty) {
  const Camera truth = ordinaryCameras()[1];
  const std::vector<Candidate> candidates = candidatesOf(truth, 3);
  SegmentQueue exact(QueuePolicy(3, 0.95), 1), vague = exact;
  exact.offer(candidates, {truth});
  QueueStart start{truth};
  start.line_delay.usable = true;
  start.line_delay.slope = Intrinsics::Constant(truth.estimatedCount(), 2.0);
  start.line_delay_doubt_s = 0.5;
  vague.offer(candidates, start);
  const IntrinsicsMatrix added = vague.solution().covariance - exact.solution().covariance;
  EXPECT_LT((added.array() - 1.0).abs().maxCoeff(), 1e-9);
  EXPECT_EQ(vague.solution().information, exact.solution().information);
}

TEST(SegmentQueue, DriftLastsUntilTheNextEstimate) {
  const Camera truth = ordinaryCameras()[1];
  SegmentQueue queue(QueuePolicy(3, 0.95), 1);
  queue.offer(candidatesOf(truth, 2), {truth});
  LensDrift drift;
  drift.significant = true;
  drift.offset = Intrinsics::Constant(truth.estimatedCount(), 0.01);
  drift.covariance = queue.solution().covariance;
  queue.setDrift(drift);
  EXPECT_NEAR(queue.solution().present().parameters()(0),
              queue.solution().camera.parameters()(0) + 0.01, 1e-12);
  queue.exchange({}, {}, {queue.solution().camera});
  EXPECT_FALSE(queue.solution().drift.significant);
}

TEST(SegmentQueue, JoinsWhatSegmentsTell) {
  for (const Camera& truth : ordinaryCameras()) {
    const std::vector<Candidate> candidates = candidatesOf(truth, 4);
    IntrinsicsMatrix sum = IntrinsicsMatrix::Zero(truth.estimatedCount(), truth.estimatedCount());
    for (const Candidate& candidate : candidates) sum += candidate.information;
    SegmentQueue queue = roomyQueue(2);
    ASSERT_EQ(queue.offer(candidates, {perturbedCamera(truth, 1, 0.3)}), 4);
    const QueueSolution& solution = queue.solution();
    ASSERT_TRUE(solution.usable);
    EXPECT_LT(solution.scatter.birgeRatio(), 1.7);
    // Nearly the sum of the marginals at the segments' own optima.
    const IntrinsicsMatrix raw =
        solution.information * solution.scatter.birgeRatio() * solution.scatter.birgeRatio();
    for (int i = 0; i < truth.estimatedCount(); ++i) EXPECT_NEAR(raw(i, i) / sum(i, i), 1.0, 0.3);
    // Chi-square with n_c degrees, 1 in 10000.
    EXPECT_LT(mahalanobis(solution.camera, truth, solution.information), 35.0);
  }
}

TEST(SegmentQueue, OfOneSegmentIsThatSegments) {
  const Camera truth = ordinaryCameras()[1];
  const Candidate candidate = candidateOf(truth, perturbedCamera(truth, 7), 7);
  SegmentQueue queue = roomyQueue();
  ASSERT_TRUE(queue.offer(candidate, {candidate.camera}).accepted);
  ASSERT_TRUE(queue.solution().usable);
  EXPECT_EQ(queue.solution().scatter.birgeRatio(), 1.0);
  EXPECT_LT(mahalanobis(queue.solution().camera, candidate.camera, candidate.information), 0.01);
}

// Segments of two different lenses cannot both be right: the uncertainty says so.
TEST(SegmentQueue, InflatesWhenSegmentsDisagree) {
  const Camera truth = ordinaryCameras()[1];
  std::vector<Candidate> candidates = candidatesOf(truth, 4);
  SegmentQueue agreeing = roomyQueue(), torn = roomyQueue();
  agreeing.offer(candidates, {truth});
  for (const int i : {1, 3}) {
    candidates[i] = candidateOf(zoomed(truth, 1.03), perturbedCamera(truth, i), i);
  }
  torn.offer(candidates, {truth});
  EXPECT_LT(agreeing.solution().scatter.birgeRatio(), 1.7);
  EXPECT_GT(torn.solution().scatter.birgeRatio(), 3.0);
  EXPECT_LT(torn.solution().information(0, 0), 0.3 * agreeing.solution().information(0, 0));
}

// Rotation on the spot tells neither translations nor depths; they must not be lost on the way of
// the intrinsics, which would look like disagreement.
TEST(SegmentQueue, SegmentsOfRotationAgree) {
  for (const int c : {0, 1, 3}) {
    const Camera truth = ordinaryCameras()[c];
    SegmentQueue queue = roomyQueue();
    ASSERT_EQ(queue.offer(candidatesOf(truth, 4, MotionKind::kRotationOnly), {zoomed(truth, 0.8)}),
              4);
    queue.exchange({}, {}, {zoomed(truth, 1.3)});
    queue.exchange({}, {}, {truth});
    const QueueSolution& solution = queue.solution();
    ASSERT_TRUE(solution.usable);
    EXPECT_LT(solution.scatter.birgeRatio(), 2.0) << toString(truth.model());
    EXPECT_LT(mahalanobis(solution.camera, truth, solution.information), 35.0);
    for (const Candidate& candidate : queue.candidates()) {
      Candidate copy = candidate;
      SegmentBlock block = freeBlock(&copy.segment, solution.camera);
      block.sigma_scale = copy.sigma_scale;
      EXPECT_LT(robustCost(block, solution.camera, 2.0), 1.1 * copy.cost + 20.0);
    }
  }
}

TEST(SegmentQueue, IsTheSameForAnyNumberOfThreads) {
  const Camera truth = ordinaryCameras()[2];
  const std::vector<Candidate> candidates = candidatesOf(truth, 4);
  std::vector<QueueSolution> solutions;
  for (const int threads : {1, 2, 3}) {
    SegmentQueue queue = roomyQueue(threads);
    queue.offer(candidates, {perturbedCamera(truth, 1, 0.3)});
    solutions.push_back(queue.solution());
  }
  for (int i = 1; i < 3; ++i) {
    EXPECT_EQ(solutions[0].camera.parameters(), solutions[i].camera.parameters());
    EXPECT_EQ(solutions[0].information, solutions[i].information);
    EXPECT_EQ(solutions[0].scatter.birgeRatio(), solutions[i].scatter.birgeRatio());
  }
}

}  // namespace
}  // namespace camera_self_calibration
