#include "camera_self_calibration/queue/agreement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera_self_calibration/base/distributions.h"
#include "lens_change/change_samples.h"

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kEver = 1LL << 62;

SegmentQueue filledQueue(const Camera& lens, int segments, std::uint64_t first_seed) {
  std::vector<Candidate> candidates;
  for (int i = 0; i < segments; ++i) {
    candidates.push_back(candidateOf(lens, perturbedCamera(lens, 1), first_seed + i));
  }
  SegmentQueue queue = roomyQueue();
  EXPECT_EQ(queue.offer(candidates, {lens}), segments);
  return queue;
}

TEST(Agreement, OfTheSameLensIsNoLargerThanChance) {
  double sum = 0.0;
  int count = 0;
  for (const Camera& lens : ordinaryCameras()) {
    const SegmentQueue queue = filledQueue(lens, 3, 100);
    const auto reference = referenceWithout(kEver, kEver, queue);
    ASSERT_TRUE(reference);
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      const Candidate candidate = candidateOf(lens, lens, seed);
      const auto likelihood =
          likelihoodAt(reference->camera, candidate.segment, candidate.sigma_scale);
      ASSERT_TRUE(likelihood);
      const Agreement result = agreement({*likelihood}, *reference);
      EXPECT_GT(result.p_value, 1e-4);
      sum += result.statistic;
      count += lens.estimatedCount();
    }
  }
  // At most the degrees of freedom, by four standard deviations; stated covariances are cautious.
  EXPECT_LT(sum / count, 1.0 + 4.0 * std::sqrt(2.0 / count));
  EXPECT_GT(sum / count, 0.2);
}

TEST(Agreement, OfAnotherLensFails) {
  for (const Camera& lens : ordinaryCameras()) {
    const SegmentQueue queue = filledQueue(lens, 3, 100);
    const auto reference = referenceWithout(kEver, kEver, queue);
    ASSERT_TRUE(reference);
    const Candidate candidate = candidateOf(zoomed(lens, 1.08), lens, 1);
    const auto likelihood =
        likelihoodAt(reference->camera, candidate.segment, candidate.sigma_scale);
    ASSERT_TRUE(likelihood);
    EXPECT_LT(agreement({*likelihood}, *reference).p_value, 1e-6) << toString(lens.model());
    const Intrinsics between = compromise({*likelihood}, *reference);
    EXPECT_GT(between(0), reference->camera.parameters()(0)) << toString(lens.model());
  }
}

TEST(Agreement, ReferenceWithoutASegmentIsTheEstimateOfTheOthers) {
  for (const Camera& lens : ordinaryCameras()) {
    SegmentQueue all = filledQueue(lens, 4, 100);
    const Segment out = all.candidates()[1].segment;
    const auto reference = referenceWithout(out.beginNs(), out.endNs(), all);
    ASSERT_TRUE(reference);
    EXPECT_FALSE(referenceWithout(0, kEver, all));
    all.exchange({out.sequence}, {}, {lens});
    const QueueSolution& others = all.solution();
    for (int i = 0; i < lens.estimatedCount(); ++i) {
      const double sigma = std::sqrt(others.covariance(i, i));
      EXPECT_NEAR(reference->camera.parameters()(i), others.camera.parameters()(i), 0.15 * sigma)
          << toString(lens.model()) << " " << i;
    }
    EXPECT_EQ(reference->scatter.freedom, others.scatter.freedom);
    EXPECT_NEAR(reference->scatter.birgeRatio(), others.scatter.birgeRatio(), 0.2);
  }
}

// What entered the queue before it told enough must not hide what it says when it does.
TEST(Agreement, WhatOverlapsIsNoMeasureOfScatter) {
  const Camera lens = ordinaryCameras()[1];
  SegmentQueue torn = filledQueue(lens, 3, 100);
  const Candidate other = candidateOf(zoomed(lens, 1.08), lens, 1);
  ASSERT_TRUE(torn.offer(other, {lens}).accepted);
  ASSERT_GT(torn.solution().scatter.birgeRatio(), 3.0);
  const Segment& segment = other.segment;
  const auto reference = referenceWithout(segment.beginNs(), segment.endNs(), torn);
  ASSERT_TRUE(reference);
  EXPECT_LT(reference->scatter.birgeRatio(), 1.7);
  const auto likelihood = likelihoodAt(reference->camera, segment, other.sigma_scale);
  ASSERT_TRUE(likelihood);
  EXPECT_LT(agreement({*likelihood}, *reference).p_value, 1e-6);
}

TEST(Agreement, ScatterByChanceIsNoVariance) {
  EXPECT_EQ(Scatter().birgeRatio(), 1.0);
  EXPECT_EQ(Scatter().birgeFreedom(), 0);
  const Scatter chance{18.0, 10}, more{90.0, 10};  // 18.3: one in twenty
  EXPECT_NEAR(chance.birgeRatio(), std::sqrt(1.8), 1e-12);
  EXPECT_EQ(chance.birgeFreedom(), 0);
  EXPECT_NEAR(more.birgeRatio(), 3.0, 1e-12);
  EXPECT_EQ(more.birgeFreedom(), 10);
}

// A direction that the segment does not determine says nothing, however far its estimate is.
TEST(Agreement, UndeterminedDirectionsDoNotCount) {
  const Camera lens = ordinaryCameras()[0];
  QuadraticLikelihood likelihood;
  likelihood.point = lens.parameters();
  likelihood.gradient = Intrinsics::Zero(4);
  likelihood.information = IntrinsicsMatrix::Zero(4, 4);
  likelihood.information(0, 0) = 4.0;
  likelihood.gradient(0) = 4.0 * 1.0;  // fx one pixel larger, sigma 1/2
  const Reference reference{lens, IntrinsicsMatrix::Identity(4, 4) * 4.0, Scatter()};
  EXPECT_NEAR(agreement({likelihood}, reference).statistic, 1.0 / (0.25 + 0.25), 1e-9);
  EXPECT_NEAR(compromise({likelihood}, reference)(0), lens.parameters()(0) + 0.5, 1e-9);
}

// What scatters by nothing but its sigmas proves them right, the sooner the more of it there is.
TEST(Agreement, ToACautiousReferenceFewSegmentsThatAgreeProveLittle) {
  const Camera lens = ordinaryCameras()[0];
  const auto p = [&](int freedom, bool cautious) {
    const Scatter as_stated{static_cast<double>(freedom), freedom};
    return pValue(60.0, {lens, IntrinsicsMatrix::Identity(4, 4), as_stated, cautious});
  };
  const double known = chiSquareExceedance(60.0, 4);
  EXPECT_EQ(p(4, false), known);
  EXPECT_GT(p(4, true), 1e-4);
  EXPECT_LT(p(36, true), p(4, true));
  EXPECT_NEAR(std::log(p(100000, true)), std::log(known), 0.1);
  EXPECT_EQ(p(0, true), known) << "what was not estimated";
}

// Two segments that scatter by more than chance tell their variance but roughly.
TEST(Agreement, ScatterOfTwoSegmentsHidesNoLargeChange) {
  const Camera lens = ordinaryCameras()[0];
  const Reference reference{lens, IntrinsicsMatrix::Identity(4, 4), Scatter{20.0, 4}};
  EXPECT_GT(fExceedance(60.0, 4, 4), 1e-4);
  EXPECT_LT(pValue(4.0 * 60.0, reference), 1e-6);
  EXPECT_GT(pValue(4.0 * 2.0, reference), 0.03);
}

}  // namespace
}  // namespace camera_self_calibration
