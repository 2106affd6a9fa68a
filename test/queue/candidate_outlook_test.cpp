#include "camera_self_calibration/queue/candidate_outlook.h"

#include <gtest/gtest.h>

#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/lens_change/change_detector.h"
#include "lens_change/change_samples.h"

namespace camera_self_calibration {
namespace {

// Poses and depths that explain a window with this lens best, as the sliding window finds them.
Segment solvedWith(const Camera& lens, const Segment& window) {
  Segment solved = window;
  Camera held = lens;
  solve({&held, false, {freeBlock(&solved, held)}}, SolverOptions());
  return solved;
}

Segment laterWindow(const Camera& lens, std::uint64_t seed) {
  Segment window = candidateOf(lens, lens, seed).observed;
  for (Keyframe& keyframe : window.keyframes) {
    keyframe.stamp_ns += static_cast<std::int64_t>(seed) * 10000000000;
  }
  window.sequence = static_cast<std::int64_t>(seed);
  return window;
}

TEST(CandidateOutlook, IsNoWorseThanTheCandidateAndNearIt) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const Camera lens = ordinaryCameras()[seed % 4];
    const Segment window = solvedWith(lens, laterWindow(lens, seed));
    const Candidate candidate = evaluateCandidate(CandidateOptions(), window, lens);
    const CandidateOutlook outlook = outlookOf(window, lens);
    ASSERT_TRUE(outlook.usable);
    ASSERT_TRUE(candidate.well_posed) << candidate.reason;
    EXPECT_LT(outlook.best.entropy, candidate.entropy) << seed;
    EXPECT_LT(outlook.best.pixel_rms, candidate.uncertainty.rms) << seed;
    // Sigmas are right here, and no track is an outlier.
    EXPECT_GT(outlook.best.entropy, candidate.entropy - 0.3 * lens.estimatedCount()) << seed;
    EXPECT_EQ(outlook.best.begin_ns, window.beginNs());
    EXPECT_EQ(outlook.best.end_ns, window.endNs());
  }
}

TEST(CandidateOutlook, OfNothingIsNotUsable) {
  EXPECT_FALSE(outlookOf(Segment(), ordinaryCameras()[1]).usable);
}

TEST(CandidateOutlook, FitsAsUsualOnlyWhereItHasSettled) {
  const Camera lens = ordinaryCameras()[1];
  SegmentQueue queue = roomyQueue();
  ASSERT_TRUE(queue.offer(candidateOf(lens, lens, 100), {lens}).accepted);
  for (std::uint64_t seed = 1; seed < 4; ++seed) {
    const Segment window = laterWindow(lens, seed);  // perturbed, not solved
    EXPECT_FALSE(fitsAsUsual(outlookOf(window, lens).sigma_scale, queue)) << seed;
    EXPECT_TRUE(fitsAsUsual(outlookOf(solvedWith(lens, window), lens).sigma_scale, queue)) << seed;
  }
}

// A queue, and a detector that remembers the window of seed 1.
struct Watched {
  explicit Watched(const Camera& lens) {
    std::vector<Candidate> candidates;
    for (std::uint64_t seed = 100; seed < 103; ++seed) {
      candidates.push_back(candidateOf(lens, lens, seed));
    }
    EXPECT_EQ(queue.offer(candidates, {lens}), 3);
    const Segment window = solvedWith(lens, laterWindow(lens, 1));
    Candidate candidate = evaluateCandidate(CandidateOptions(), window, lens);
    EXPECT_EQ(detector.examine(window, candidate, 0, queue).kind, ChangeVerdict::Kind::kSame);
  }
  // Of a window at the time of the one that is remembered.
  std::optional<double> ask(const Camera& lens, std::uint64_t seed, std::int64_t onset_ns = 0) {
    const Camera& known = queue.solution().camera;
    Segment window = solvedWith(known, laterWindow(lens, seed));
    for (Keyframe& keyframe : window.keyframes) {
      keyframe.stamp_ns -= static_cast<std::int64_t>(seed - 1) * 10000000000;
    }
    return detector.clearlySame(outlookOf(window, known), onset_ns, queue);
  }
  SegmentQueue queue = roomyQueue();
  ChangeDetector detector{0.1};
};

TEST(CandidateOutlook, OfTheSameLensNeedsNoCloserLook) {
  int clear = 0;
  for (const Camera& lens : ordinaryCameras()) {
    Watched watched(lens);
    for (std::uint64_t seed = 2; seed < 6; ++seed) {
      const auto p_value = watched.ask(lens, seed);
      clear += p_value.has_value();
      EXPECT_GT(p_value.value_or(1.0), 0.1);
    }
  }
  EXPECT_GE(clear, 12);  // of 16: one in ten looks different by chance
}

TEST(CandidateOutlook, OfAnotherLensIsLookedInto) {
  for (const Camera& lens : ordinaryCameras()) {
    Watched watched(lens);
    for (std::uint64_t seed = 2; seed < 5; ++seed) {
      EXPECT_FALSE(watched.ask(zoomed(lens, 1.03), seed)) << toString(lens.model()) << seed;
    }
  }
}

TEST(CandidateOutlook, SuspicionsAndNewWindowsAreLookedInto) {
  const Camera lens = ordinaryCameras()[1];
  Watched watched(lens);
  ASSERT_TRUE(watched.ask(lens, 2));
  EXPECT_FALSE(watched.ask(lens, 2, 5));
  const Segment later = solvedWith(lens, laterWindow(lens, 2));
  EXPECT_FALSE(watched.detector.clearlySame(outlookOf(later, lens), 0, watched.queue));
}

}  // namespace
}  // namespace camera_self_calibration
