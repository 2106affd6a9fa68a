#include "camera_self_calibration/queue/queue_policy.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/entropy.h"

namespace camera_self_calibration {
namespace {

const Camera kCamera = camera640(CameraModel::kPinhole, {320, 320, 319.5, 239.5});
constexpr double kAlpha = 0.95;
const double kMargin = 4.0 * std::log(1.0 / kAlpha);  // n_c ln(1 / alpha)

// A made-up segment whose sigmas are `spread` times the normalisation's.
SegmentScore score(std::int64_t sequence, std::int64_t begin, std::int64_t end, double spread) {
  SegmentScore result;
  result.sequence = sequence;
  result.begin_ns = begin;
  result.end_ns = end;
  const IntrinsicsMatrix covariance =
      (spread * normalizationSigmas(kCamera)).cwiseAbs2().asDiagonal();
  result.information = covariance.inverse();
  result.entropy = entropy(kCamera, covariance);
  return result;
}

SegmentScore withEntropy(std::int64_t sequence, std::int64_t begin, std::int64_t end,
                         double entropy) {
  SegmentScore result = score(sequence, begin, end, 1.0);
  result.entropy = entropy;
  return result;
}

// A queue that does what the policy says.
class Queue {
 public:
  Queue(int capacity, double alpha, ScoreKind kind = ScoreKind::kEntropy)
      : policy_(capacity, alpha, kind) {}
  QueueDecision consider(const SegmentScore& candidate, const Camera& camera,
                         bool filling = false) const {
    return policy_.consider(candidate, segments_, camera, filling);
  }
  QueueDecision offer(const SegmentScore& candidate, const Camera& camera) {
    const QueueDecision decision = consider(candidate, camera);
    if (!decision.accepted) return decision;
    const auto leaves = [&](const SegmentScore& segment) {
      return std::count(decision.replaced.begin(), decision.replaced.end(), segment.sequence) > 0;
    };
    segments_.erase(std::remove_if(segments_.begin(), segments_.end(), leaves), segments_.end());
    segments_.push_back(candidate);
    return decision;
  }
  const std::vector<SegmentScore>& segments() const { return segments_; }

 private:
  QueuePolicy policy_;
  std::vector<SegmentScore> segments_;
};

std::vector<std::int64_t> sequences(const Queue& queue) {
  std::vector<std::int64_t> list;
  for (const SegmentScore& segment : queue.segments()) list.push_back(segment.sequence);
  return list;
}

using Ids = std::vector<std::int64_t>;

TEST(QueuePolicy, TakesWhatDoesNotOverlapWhileThereIsRoom) {
  Queue queue(3, kAlpha);
  EXPECT_TRUE(queue.offer(withEntropy(1, 0, 10, 5.0), kCamera).accepted);
  EXPECT_TRUE(queue.offer(withEntropy(2, 11, 20, 500.0), kCamera).accepted);  // however bad
  EXPECT_TRUE(queue.offer(withEntropy(3, 21, 30, -5.0), kCamera).accepted);
  EXPECT_EQ(sequences(queue), (Ids{1, 2, 3}));
}

TEST(QueuePolicy, FullItReplacesTheWorst) {
  Queue queue(3, kAlpha);
  queue.offer(withEntropy(1, 0, 10, 5.0), kCamera);
  queue.offer(withEntropy(2, 20, 30, 7.0), kCamera);
  queue.offer(withEntropy(3, 40, 50, 6.0), kCamera);
  EXPECT_FALSE(queue.offer(withEntropy(4, 60, 70, 7.0 - kMargin + 1e-9), kCamera).accepted);
  const QueueDecision decision = queue.offer(withEntropy(5, 60, 70, 7.0 - kMargin - 1e-9), kCamera);
  EXPECT_TRUE(decision.accepted);
  EXPECT_EQ(decision.replaced, Ids{2});
  EXPECT_FALSE(decision.reason.empty());
  EXPECT_EQ(sequences(queue), (Ids{1, 3, 5}));
}

// The margin lowers the limit whatever the sign: the paper's `alpha max h` would raise it.
TEST(QueuePolicy, NegativeEntropiesNeedTheSameMargin) {
  for (const double level : {-30.0, -0.1, 0.0, 0.1, 30.0}) {
    Queue queue(1, kAlpha);
    queue.offer(withEntropy(1, 0, 10, level), kCamera);
    EXPECT_FALSE(queue.consider(withEntropy(2, 20, 30, level), kCamera).accepted) << level;
    EXPECT_FALSE(queue.consider(withEntropy(2, 20, 30, level + 0.01), kCamera).accepted);
    EXPECT_FALSE(queue.consider(withEntropy(2, 20, 30, level - 0.9 * kMargin), kCamera).accepted);
    EXPECT_TRUE(queue.consider(withEntropy(2, 20, 30, level - 1.1 * kMargin), kCamera).accepted);
  }
}

// 5 % off the geometric-mean sigma, independent of the number of parameters.
TEST(QueuePolicy, AlphaIsTheShareOfTheSigmas) {
  for (const double alpha : {0.5, 0.95, 0.99}) {
    Queue queue(1, alpha);
    queue.offer(score(1, 0, 10, 1.0), kCamera);
    EXPECT_TRUE(queue.consider(score(2, 20, 30, alpha - 1e-6), kCamera).accepted);
    EXPECT_FALSE(queue.consider(score(2, 20, 30, alpha + 1e-6), kCamera).accepted);
  }
}

TEST(QueuePolicy, ACandidateThatOverlapsOneIsComparedWithThatAlone) {
  Queue queue(3, kAlpha);
  queue.offer(withEntropy(1, 0, 10, 5.0), kCamera);
  queue.offer(withEntropy(2, 20, 30, 50.0), kCamera);
  // Far better than the worst, and there is room, but not better than the one it overlaps.
  EXPECT_FALSE(queue.offer(withEntropy(3, 10, 15, 4.9), kCamera).accepted);  // a shared moment
  EXPECT_FALSE(queue.offer(withEntropy(4, -5, 100, 5.0), kCamera).accepted);
  // Worse than another of the queue, but better than the one it overlaps.
  const QueueDecision decision = queue.offer(withEntropy(5, 25, 35, 40.0), kCamera);
  EXPECT_TRUE(decision.accepted);
  EXPECT_EQ(decision.replaced, Ids{2});
  EXPECT_EQ(sequences(queue), (Ids{1, 5}));
}

TEST(QueuePolicy, ACandidateThatOverlapsSeveralMustBeatThemTogether) {
  Queue queue(3, kAlpha);
  queue.offer(score(1, 0, 10, 1.0), kCamera);
  queue.offer(score(2, 20, 30, 1.0), kCamera);
  queue.offer(score(3, 40, 50, 1.0), kCamera);
  // Two equal informations added: sigmas smaller by sqrt(2).
  const double joint = 1.0 / std::sqrt(2.0);
  EXPECT_FALSE(queue.consider(score(4, 5, 25, 1.01 * kAlpha * joint), kCamera).accepted);
  EXPECT_FALSE(queue.consider(score(4, 5, 25, 0.9), kCamera).accepted);
  const QueueDecision decision = queue.offer(score(4, 5, 25, 0.99 * kAlpha * joint), kCamera);
  EXPECT_TRUE(decision.accepted);
  EXPECT_EQ(decision.replaced, (Ids{1, 2}));
  EXPECT_EQ(sequences(queue), (Ids{3, 4}));
}

TEST(QueuePolicy, NoSegmentReplacesAllOfSeveral) {
  Queue queue(3, kAlpha);
  queue.offer(score(1, 0, 10, 1.0), kCamera);
  queue.offer(score(2, 20, 30, 1.0), kCamera);
  EXPECT_FALSE(queue.consider(score(3, 5, 25, 0.01), kCamera).accepted);
  EXPECT_TRUE(queue.consider(score(3, 5, 15, 0.01), kCamera).accepted);
}

TEST(QueuePolicy, RefusesIllPosedCandidates) {
  Queue queue(3, kAlpha);
  SegmentScore bad = withEntropy(1, 0, 10, -100.0);
  bad.well_posed = false;
  EXPECT_FALSE(queue.offer(bad, kCamera).accepted);
  EXPECT_FALSE(queue.offer(withEntropy(1, 0, 10, INFINITY), kCamera).accepted);
  EXPECT_FALSE(queue.offer(withEntropy(1, 0, 10, -INFINITY), kCamera).accepted);
  const QueueDecision decision = queue.offer(withEntropy(1, 0, 10, NAN), kCamera);
  EXPECT_FALSE(decision.accepted);
  EXPECT_FALSE(decision.reason.empty());
  EXPECT_TRUE(queue.segments().empty());
}

// A bag played in a loop offers the same moments again, under new sequence numbers.
TEST(QueuePolicy, CountsAPieceOfTimeOnce) {
  Queue queue(5, kAlpha);
  queue.offer(score(1, 0, 10, 1.0), kCamera);
  queue.offer(score(2, 20, 30, 1.2), kCamera);
  for (int round = 1; round < 20; ++round) {
    queue.offer(score(100 * round + 1, 0, 10, 1.0), kCamera);
    queue.offer(score(100 * round + 2, 20, 30, 1.2), kCamera);
    queue.offer(score(100 * round + 3, 2, 12, 0.999), kCamera);
  }
  EXPECT_EQ(sequences(queue), (Ids{1, 2}));
  // Nor do gains below the margin creep in one after the other.
  EXPECT_FALSE(queue.consider(score(9, 0, 10, 0.96), kCamera).accepted);
}

SegmentScore withPixelError(std::int64_t sequence, std::int64_t begin, std::int64_t end,
                            double pixel_rms, double entropy) {
  SegmentScore result = withEntropy(sequence, begin, end, entropy);
  result.pixel_rms = pixel_rms;
  return result;
}

TEST(QueuePolicy, ByPixelErrorTheEntropyDoesNotCount) {
  Queue queue(2, kAlpha, ScoreKind::kPixel);
  queue.offer(withPixelError(1, 0, 10, 0.2, 30.0), kCamera);
  queue.offer(withPixelError(2, 20, 30, 0.4, -30.0), kCamera);
  EXPECT_FALSE(
      queue.offer(withPixelError(3, 40, 50, 1.01 * kAlpha * 0.4, -99.0), kCamera).accepted);
  const QueueDecision decision =
      queue.offer(withPixelError(4, 40, 50, 0.99 * kAlpha * 0.4, 99.0), kCamera);
  EXPECT_TRUE(decision.accepted);
  EXPECT_EQ(decision.replaced, Ids{2});
  EXPECT_FALSE(queue.offer(withPixelError(5, 60, 70, NAN, 0.0), kCamera).accepted);
  EXPECT_FALSE(queue.offer(withPixelError(5, 60, 70, INFINITY, 0.0), kCamera).accepted);
}

TEST(QueuePolicy, ByPixelErrorSeveralCountTogether) {
  Queue queue(3, kAlpha, ScoreKind::kPixel);
  const auto scored = [](std::int64_t sequence, std::int64_t begin, std::int64_t end,
                         double spread) {
    SegmentScore result = score(sequence, begin, end, spread);
    const IntrinsicsMatrix covariance = result.information.inverse();
    result.pixel_rms = pixelUncertainty(kCamera, covariance).rms;
    return result;
  };
  queue.offer(scored(1, 0, 10, 1.0), kCamera);
  queue.offer(scored(2, 20, 30, 1.0), kCamera);
  queue.offer(scored(4, 40, 50, 1.0), kCamera);
  const double joint = 1.0 / std::sqrt(2.0);
  EXPECT_FALSE(queue.consider(scored(3, 5, 25, 1.01 * kAlpha * joint), kCamera).accepted);
  EXPECT_TRUE(queue.consider(scored(3, 5, 25, 0.99 * kAlpha * joint), kCamera).accepted);
}

// What would be left unused is half as long as the candidate, and could have told half as much.
TEST(QueuePolicy, WhileItFillsTimeLeftUnusedIsLost) {
  const double lost = 4.0 * 0.5 * std::log(1.5);
  const auto isTaken = [](int capacity, double entropy) {
    Queue queue(capacity, kAlpha);
    queue.offer(withEntropy(1, 0, 10, 5.0), kCamera);
    return queue.consider(withEntropy(2, 5, 15, entropy), kCamera, true).accepted;
  };
  EXPECT_TRUE(isTaken(1, 5.0 - kMargin - 0.01));
  EXPECT_FALSE(isTaken(2, 5.0 - kMargin - 0.01));
  EXPECT_FALSE(isTaken(2, 5.0 - lost + 0.01));
  EXPECT_TRUE(isTaken(2, 5.0 - lost - 0.01));
}

TEST(QueuePolicy, ScoresHaveNames) {
  for (const ScoreKind kind : {ScoreKind::kEntropy, ScoreKind::kPixel}) {
    EXPECT_EQ(scoreKindFromString(toString(kind)), kind);
  }
  EXPECT_FALSE(scoreKindFromString("determinant"));
}

TEST(QueuePolicy, ConsideringChangesNothing) {
  Queue queue(1, kAlpha);
  EXPECT_TRUE(queue.consider(withEntropy(1, 0, 10, 5.0), kCamera).accepted);
  EXPECT_TRUE(queue.segments().empty());
  queue.offer(withEntropy(1, 0, 10, 5.0), kCamera);
  EXPECT_TRUE(queue.consider(withEntropy(2, 20, 30, 0.0), kCamera).accepted);
  EXPECT_EQ(sequences(queue), Ids{1});
}

}  // namespace
}  // namespace camera_self_calibration
