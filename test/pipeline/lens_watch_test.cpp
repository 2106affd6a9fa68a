#include "camera_self_calibration/pipeline/lens_watch.h"

#include <gtest/gtest.h>

#include "lens_change/change_samples.h"

namespace camera_self_calibration {
namespace {

constexpr double kConvergedRms = 1.0;

const Camera& lens() {
  static const Camera lens = ordinaryCameras()[1];
  return lens;
}

SegmentQueue queueOf(const Camera& camera) {
  std::vector<Candidate> candidates;
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    candidates.push_back(candidateOf(camera, camera, seed));
  }
  SegmentQueue queue = roomyQueue();
  EXPECT_EQ(queue.offer(candidates, {camera}), 3);
  return queue;
}

const SegmentQueue& queue() {
  static const SegmentQueue queue = queueOf(lens());
  return queue;
}

// A batch that knows the lens as well as the queue does.
Startup knowing() {
  Startup startup(StartupOptions(), lens());
  startup.resume(queue().solution().camera, queue().solution().information,
                 queue().candidates()[0].segment, {});
  return startup;
}

// A window with its candidate, in time after those of the queue.
struct Seen {
  KeyframeMessage message;
  Candidate candidate;
};

Seen seenThrough(const Camera& camera, std::uint64_t seed) {
  Seen seen;
  seen.message.candidate = perturbed(windowOf(camera, seed).segment, {}, seed);
  for (Keyframe& keyframe : seen.message.candidate.keyframes) {
    keyframe.stamp_ns += static_cast<std::int64_t>(seed) * 10000000000;
  }
  seen.message.candidate.sequence = static_cast<std::int64_t>(seed);
  seen.candidate = evaluateCandidate(CandidateOptions(), seen.message.candidate, camera);
  return seen;
}

ChangeVerdict::Kind verdictOn(LensWatch* watch, const Seen& seen, bool handed_over) {
  return watch->examine(seen.message, seen.candidate, queue(), handed_over).kind;
}

TEST(LensWatch, HoldsWindowsAgainstTheQueueAfterHandover) {
  LensWatch watch(0.1);
  EXPECT_EQ(verdictOn(&watch, seenThrough(lens(), 10), true), ChangeVerdict::Kind::kSame);
  const Camera other = zoomed(lens(), 1.1);
  verdictOn(&watch, seenThrough(other, 11), true);
  EXPECT_EQ(verdictOn(&watch, seenThrough(other, 12), true), ChangeVerdict::Kind::kChange);
}

TEST(LensWatch, BeforeHandoverHoldsThemAgainstWhatTheBatchSaidBefore) {
  const Camera other = zoomed(lens(), 1.1);
  const Seen first = seenThrough(other, 12);
  LensWatch watch(0.1);
  EXPECT_EQ(verdictOn(&watch, first, false), ChangeVerdict::Kind::kSame) << "nothing is known";
  const Startup startup = knowing();
  const std::int64_t late_ns = first.message.candidate.beginNs();
  watch.remember(late_ns, startup, {0.1, 0.2}, kConvergedRms);
  EXPECT_EQ(verdictOn(&watch, first, false), ChangeVerdict::Kind::kSame) << "it was in that batch";
  watch.remember(late_ns - 1, startup, {0.1, 0.2}, kConvergedRms);
  EXPECT_EQ(verdictOn(&watch, first, false), ChangeVerdict::Kind::kDoubt);
  EXPECT_EQ(verdictOn(&watch, first, false), ChangeVerdict::Kind::kChange) << "it says so again";
  watch.forgetStartup();
  EXPECT_EQ(verdictOn(&watch, first, false), ChangeVerdict::Kind::kSame);
}

// Of the first lens a batch may be too sure of itself.
TEST(LensWatch, RemembersOnlyABatchThatIsGoodEnough) {
  const Seen first = seenThrough(zoomed(lens(), 1.1), 11);
  const auto notices = [&](LensWatch* watch, double rms) {
    watch->forgetStartup();
    watch->remember(1, knowing(), {rms, rms}, kConvergedRms);
    return verdictOn(watch, first, false) != ChangeVerdict::Kind::kSame;
  };
  LensWatch watch(0.1);
  EXPECT_TRUE(notices(&watch, 0.4));
  EXPECT_FALSE(notices(&watch, 0.6));
  watch.beginLens(0, std::nullopt);
  EXPECT_TRUE(notices(&watch, 1.9));
  EXPECT_FALSE(notices(&watch, 2.1));
}

TEST(LensWatch, ANewLensBeginsAtItsOnset) {
  LensWatch watch(0.1);
  const Seen seen = seenThrough(lens(), 10);
  const std::int64_t begin_ns = seen.message.candidate.beginNs();
  EXPECT_FALSE(watch.straddlesChange(seen.message.candidate));
  EXPECT_EQ(watch.onsetNs(), 0);
  watch.remember(1, knowing(), {0.1, 0.2}, kConvergedRms);
  watch.beginLens(begin_ns + 1, queue().solution().scatter);
  EXPECT_TRUE(watch.straddlesChange(seen.message.candidate));
  EXPECT_EQ(watch.onsetNs(), begin_ns + 1);
  EXPECT_EQ(verdictOn(&watch, seenThrough(zoomed(lens(), 1.1), 11), false),
            ChangeVerdict::Kind::kSame)
      << "what was known of the old lens is no measure of the new one";
  watch.beginLens(begin_ns, std::nullopt);
  EXPECT_FALSE(watch.straddlesChange(seen.message.candidate));
}

TEST(LensWatch, AWindowNeedNotBeSolvedWhereNothingSpeaksAgainstTheLens) {
  LensWatch watch(0.1);
  const KeyframeMessage message = seenThrough(lens(), 10).message;
  CandidateOutlook outlook = outlookOf(queue().candidates()[0].segment, lens());
  ASSERT_TRUE(outlook.usable);
  outlook.sigma_scale = 1.0;
  EXPECT_EQ(watch.clearlySame(message, outlook, queue(), false), 1.0);
  outlook.sigma_scale = 5.0;
  EXPECT_FALSE(watch.clearlySame(message, outlook, queue(), false)) << "fits badly";
  outlook.sigma_scale = 1.0;
  watch.remember(1, knowing(), {0.1, 0.2}, kConvergedRms);
  EXPECT_FALSE(watch.clearlySame(message, outlook, queue(), false)) << "is compared with the batch";
}

TEST(LensWatch, AConstantLensDoesNotDrift) {
  const LensWatch watch(0.1);
  EXPECT_FALSE(watch.drift(queue(), queue().candidates().back().segment.endNs()).significant);
}

}  // namespace
}  // namespace camera_self_calibration
