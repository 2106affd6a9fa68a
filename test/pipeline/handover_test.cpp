// Startup batch against queue: which of them knows the lens better, and when the queue takes over.

#include "camera_self_calibration/pipeline/handover.h"

#include <gtest/gtest.h>

#include <limits>

#include "camera_self_calibration/estimation/entropy.h"
#include "lens_change/change_samples.h"

namespace camera_self_calibration {
namespace {

const Camera& lens() {
  static const Camera lens = ordinaryCameras()[1];
  return lens;
}

// A queue of segments that were seen through these lenses, one after the other.
SegmentQueue queueOf(const std::vector<Camera>& lenses) {
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < lenses.size(); ++i) {
    candidates.push_back(candidateOf(lenses[i], lenses[i], i + 1));
  }
  SegmentQueue queue = roomyQueue();
  EXPECT_EQ(queue.offer(candidates, {lens()}), static_cast<int>(lenses.size()));
  return queue;
}

// A batch that says this of the lens.
Startup startupThatSays(const Camera& camera, const IntrinsicsMatrix& information) {
  Startup startup(StartupOptions(), lens());
  startup.resume(camera, information, candidateOf(camera, camera, 9).segment, {});
  return startup;
}

const Startup& nothing() {
  static const Startup startup(StartupOptions(), lens());
  return startup;
}

TEST(Handover, AQueueIsDoubtedUntilSeparateSegmentsAgree) {
  const ImageField whole;
  const auto doubt = [&](const std::vector<Camera>& lenses) {
    return queueStanding(nothing(), queueOf(lenses), whole).doubt;
  };
  const Camera other = zoomed(lens(), 1.06);
  EXPECT_NE(doubt({}).find("are needed"), std::string::npos);
  EXPECT_NE(doubt({lens()}).find("are needed"), std::string::npos);
  EXPECT_EQ(doubt({lens(), lens()}), "");
  EXPECT_NE(doubt({lens(), other}).find("a third will decide"), std::string::npos);
  EXPECT_NE(doubt({lens(), other, lens(), other}).find("disagree by"), std::string::npos);
}

TEST(Handover, AQueueThatContradictsTheBatchIsDoubted) {
  const SegmentQueue queue = queueOf({lens(), lens(), lens()});
  const IntrinsicsMatrix& information = queue.solution().information;
  const QueueStanding agreeing =
      queueStanding(startupThatSays(lens(), information), queue, ImageField());
  EXPECT_FALSE(agreeing.contradicts_startup);
  EXPECT_EQ(agreeing.doubt, "");
  const QueueStanding contradicting =
      queueStanding(startupThatSays(zoomed(lens(), 1.1), information), queue, ImageField());
  EXPECT_TRUE(contradicting.contradicts_startup);
  EXPECT_NE(contradicting.doubt.find("startup batch disagree by"), std::string::npos);
  // A batch that says as much, but is not sure of it, contradicts nothing.
  const QueueStanding vague =
      queueStanding(startupThatSays(zoomed(lens(), 1.02), 1e-4 * information), queue, ImageField());
  EXPECT_FALSE(vague.contradicts_startup);
}

TEST(Handover, TheBetterEstimateLeads) {
  const SegmentQueue queue = queueOf({lens(), lens(), lens()});
  const IntrinsicsMatrix& information = queue.solution().information;
  double limit_px = 2.0;
  const auto leader = [&](const Startup& startup, const SegmentQueue& seen) {
    return betterEstimate(startup, queueStanding(startup, seen, ImageField()), {limit_px, -100.0});
  };
  const Startup better = startupThatSays(queue.solution().camera, 9.0 * information);
  const Startup worse = startupThatSays(queue.solution().camera, information / 9.0);
  EXPECT_EQ(leader(better, queue), PhaseTrigger::kStartupBetter);
  EXPECT_EQ(leader(worse, queue), PhaseTrigger::kQueueBetter);
  EXPECT_EQ(leader(nothing(), queue), PhaseTrigger::kQueueBetter);
  EXPECT_EQ(leader(worse, roomyQueue()), PhaseTrigger::kStartupBetter);
  EXPECT_EQ(leader(nothing(), roomyQueue()), PhaseTrigger::kUninformed);
  const Startup useless = startupThatSays(lens(), 1e-8 * information);
  ASSERT_TRUE(useless.usable());
  EXPECT_EQ(leader(useless, roomyQueue()), PhaseTrigger::kUninformed);
  // One segment is enough where the batch tells nothing, unless another contradicts it.
  const SegmentQueue one = queueOf({lens()});
  EXPECT_EQ(leader(nothing(), one), PhaseTrigger::kQueueBetter);
  EXPECT_EQ(leader(useless, one), PhaseTrigger::kQueueBetter);
  EXPECT_EQ(leader(worse, one), PhaseTrigger::kStartupBetter);
  limit_px = 0.5 * pixelUncertainty(lens(), one.solution().covariance, ImageField()).rms;
  EXPECT_EQ(leader(nothing(), one), PhaseTrigger::kUninformed);
  limit_px = 2.0;
  EXPECT_EQ(leader(nothing(), queueOf({lens(), zoomed(lens(), 1.06)})), PhaseTrigger::kUninformed);
}

TEST(Handover, NeedsPixelsOrEntropy) {
  const SegmentQueue queue = queueOf({lens(), lens()});
  const QueueSolution& solution = queue.solution();
  const QueueStanding standing = queueStanding(nothing(), queue, ImageField());
  const double rms = standing.uncertainty.rms;
  const double nats = entropy(solution.camera, solution.covariance);
  constexpr double kNever = -std::numeric_limits<double>::infinity();
  EXPECT_EQ(shortfall(standing, solution, {1.01 * rms, kNever}), "");
  EXPECT_NE(shortfall(standing, solution, {0.99 * rms, kNever}).find("(needed: "),
            std::string::npos);
  EXPECT_EQ(shortfall(standing, solution, {0.99 * rms, nats + 0.01}), "");
  EXPECT_NE(shortfall(standing, solution, {0.99 * rms, nats - 0.01}), "");
}

TEST(Handover, ABatchThatIsNotUsableHasNoUncertainty) {
  EXPECT_FALSE(startupUncertainty(nothing(), ImageField()).rms < 1e9);
}

}  // namespace
}  // namespace camera_self_calibration
