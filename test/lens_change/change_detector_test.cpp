#include "camera_self_calibration/lens_change/change_detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "lens_change/change_samples.h"

namespace camera_self_calibration {
namespace {

using Kind = ChangeVerdict::Kind;

constexpr double kRate = 1.0;       // false alarms per hour
constexpr double kSigmaPx = 0.3;    // that tracks state
constexpr double kErrorPx = 0.03;   // that they have: so small that no outcome is left to chance
constexpr double kIntervalS = 0.3;  // between keyframes, at most

const Camera kLens = ordinaryCameras()[1];

Camera sameLens(int) { return kLens; }

Segment seenThrough(const Camera& lens, std::uint64_t seed, double sigma_px = kSigmaPx,
                    double error_px = kErrorPx) {
  SegmentOptions options;
  options.camera = lens;
  options.tracks.max_features = 60;
  options.tracks.pixel_sigma = error_px;
  options.tracks.reported_sigma = sigma_px;
  return makeSegment(options, seed).segment;
}

// As the map hands it over at a time.
Segment handedOver(const Segment& seen, double at_s) {
  Segment window = perturbed(seen, {}, 1);
  for (Keyframe& keyframe : window.keyframes) {
    keyframe.stamp_ns += static_cast<std::int64_t>(1e9 * at_s);
  }
  window.sequence = static_cast<std::int64_t>(at_s);
  return window;
}

Segment windowAt(double at_s, const Camera& lens) {
  return handedOver(seenThrough(lens, 100 + static_cast<std::uint64_t>(at_s / 10.0) % 4), at_s);
}

Candidate solved(const Segment& window) {
  return evaluateCandidate(CandidateOptions(), window, kLens);
}

// A segment every ten seconds, `lens` by its number.
SegmentQueue queueOf(int segments, const std::function<Camera(int)>& lens) {
  std::vector<Candidate> candidates;
  for (int i = 0; i < segments; ++i) candidates.push_back(solved(windowAt(10.0 * i, lens(i))));
  SegmentQueue queue = roomyQueue();
  EXPECT_EQ(queue.offer(candidates, {kLens}), segments);
  return queue;
}

// Its window alone, without a suspicion.
ChangeVerdict examine(const Segment& window, const SegmentQueue& queue, ChangeDetector* detector) {
  return detector->examine(window, solved(window), 0, queue);
}

double distance(const Camera& a, const Camera& b) { return pixelDistance(a, b).rms; }

TEST(ChangeDetector, TheSameLensIsNoChange) {
  ChangeDetector detector(kRate);
  const ChangeVerdict verdict = examine(windowAt(40.0, kLens), queueOf(4, sameLens), &detector);
  EXPECT_EQ(verdict.kind, Kind::kSame);
  EXPECT_GT(verdict.p_value, 0.1);
  EXPECT_TRUE(detector.hasNews());
}

// Errors five times as large as the tracks say, as no lens makes them.
TEST(ChangeDetector, WhatFitsNoLensIsBadData) {
  ChangeDetector detector(kRate);
  const Segment rough = handedOver(seenThrough(kLens, 100, kSigmaPx, 5.0 * kSigmaPx), 40.0);
  const ChangeVerdict verdict = examine(rough, queueOf(4, sameLens), &detector);
  EXPECT_EQ(verdict.kind, Kind::kBadData);
  EXPECT_FALSE(verdict.reason.empty());
  EXPECT_FALSE(detector.hasNews());  // says nothing of the lens later on either
}

// The window slides over the change: two keyframes after it are too few, and what four of them
// find has to be found once more.
TEST(ChangeDetector, ASuspicionBecomesADoubtAndThenAChange) {
  const Camera after = zoomed(kLens, 1.02);
  const SegmentQueue queue = queueOf(4, sameLens);
  const Segment scene = seenThrough(kLens, 4, 0.5, 0.05);
  ChangeDetector detector(kRate);
  const auto examineWith = [&](int earlier, double at_s) {
    const Segment window = handedOver(withChange(scene, kLens, after, earlier), at_s);
    return detector.examine(window, Candidate(), window.keyframes[earlier].stamp_ns, queue);
  };
  EXPECT_EQ(examineWith(8, 40.0).kind, Kind::kDoubt);

  const ChangeVerdict found = examineWith(6, 40.5);
  EXPECT_EQ(found.kind, Kind::kDoubt);
  EXPECT_LT(found.p_value, detector.limit());
  EXPECT_LT(found.excess, 1.0);

  const ChangeVerdict change = examineWith(5, 40.75);
  ASSERT_EQ(change.kind, Kind::kChange) << change.reason;
  EXPECT_LT(change.p_value, detector.limit());
  const std::int64_t onset_ns = handedOver(scene, 40.75).keyframes[5].stamp_ns;
  EXPECT_NEAR(toSeconds(change.onset_ns), toSeconds(onset_ns), kIntervalS);
  EXPECT_LT(distance(change.camera, after), 0.2 * distance(kLens, after));
  EXPECT_FALSE(change.segment.landmarks.empty());
}

TEST(ChangeDetector, ASuspicionWithoutACauseEnds) {
  ChangeDetector detector(kRate);
  const Segment window = windowAt(40.0, kLens);
  const ChangeVerdict verdict =
      detector.examine(window, Candidate(), window.keyframes[5].stamp_ns, queueOf(4, sameLens));
  EXPECT_EQ(verdict.kind, Kind::kSame);
  EXPECT_GT(verdict.p_value, 0.1);
}

// That it differs from two segments that agree proves no change where none was seen to happen;
// where one was, it does, as long as the doubt lasts.
TEST(ChangeDetector, ADifferenceFromFewSegmentsNeedsASuspicion) {
  const SegmentQueue queue = queueOf(2, sameLens);
  const Segment window = windowAt(40.0, zoomed(kLens, 1.05));
  ChangeDetector detector(kRate);
  const ChangeVerdict differs = examine(window, queue, &detector);
  EXPECT_EQ(differs.kind, Kind::kDoubt);
  EXPECT_GT(differs.p_value, detector.limit());

  ChangeDetector warned(kRate);
  const auto suspected = warned.examine(window, solved(window), window.beginNs(), queue);
  EXPECT_LT(suspected.p_value, warned.limit());
  const ChangeVerdict again = examine(handedOver(window, 0.5), queue, &warned);
  EXPECT_EQ(again.kind, Kind::kChange) << again.reason;
  EXPECT_LT(again.p_value, warned.limit());
}

// The queue took segments of both lenses in, so that no window contradicts it.
TEST(ChangeDetector, AllSegmentsTogetherFindAStep) {
  const Camera after = zoomed(kLens, 1.03);
  const SegmentQueue queue = queueOf(8, [&](int i) { return i < 4 ? kLens : after; });
  ChangeDetector detector(kRate);
  const ChangeVerdict change = examine(windowAt(80.0, after), queue, &detector);
  ASSERT_EQ(change.kind, Kind::kChange) << change.reason;
  EXPECT_EQ(change.onset_ns, queue.candidates()[4].segment.beginNs());
  EXPECT_EQ(change.recent.size(), 5u);
  EXPECT_LT(distance(change.camera, after), 0.2 * distance(kLens, after));
}

TEST(ChangeDetector, ADriftMakesOldSegmentsStale) {
  const auto lensOf = [](int i) { return zoomed(kLens, 1.0 + 0.005 * i); };
  const SegmentQueue queue = queueOf(8, lensOf);
  ChangeDetector detector(kRate);
  const ChangeVerdict drift = examine(windowAt(80.0, lensOf(8)), queue, &detector);
  ASSERT_EQ(drift.kind, Kind::kDrift) << drift.reason;
  EXPECT_EQ(std::count(drift.stale.begin(), drift.stale.end(), 0), 1);  // the oldest
  EXPECT_EQ(drift.recent.size(), 1u);
  EXPECT_LT(distance(drift.camera, lensOf(8)), distance(queue.solution().camera, lensOf(8)));
  const LensDrift drifting = detector.drift(queue, windowAt(80.0, kLens).endNs());
  EXPECT_TRUE(drifting.told);
  // Until the next segment that shares nothing with it, whatever windows say meanwhile.
  const Segment overlapping = windowAt(80.5, kLens);
  ASSERT_LT(overlapping.beginNs(), windowAt(80.0, kLens).endNs());
  examine(overlapping, queue, &detector);
  EXPECT_TRUE(detector.drift(queue, overlapping.endNs()).told);

  // The queue alone shows it as well, but is no new segment to ask.
  detector.reset();
  const LensDrift likely = detector.drift(queue, windowAt(80.0, kLens).endNs());
  EXPECT_TRUE(likely.significant);
  EXPECT_FALSE(likely.told);
}

// Segments that end later than now have the stamps of a clock that was set back since. Taken for
// the newest, they would say that the lens went back to what it was.
TEST(ChangeDetector, SegmentsOfAnotherClockDoNotCountInTheAccount) {
  const Camera other = zoomed(kLens, 1.03);
  const SegmentQueue queue = queueOf(8, [&](int i) { return i < 4 ? kLens : other; });
  const ChangeDetector detector(kRate);
  const auto driftAt = [&](int segment) {
    return detector.drift(queue, queue.candidates()[segment].segment.endNs());
  };
  EXPECT_TRUE(driftAt(7).significant) << "all of one clock";
  EXPECT_FALSE(driftAt(3).significant);
}

// The same of those that are remembered beside the queue.
TEST(ChangeDetector, WhatIsRememberedOfAnotherClockDoesNotCountEither) {
  const Camera other = zoomed(kLens, 1.03);
  const SegmentQueue queue = queueOf(4, sameLens);
  ChangeDetector detector(kRate);
  for (int i = 4; i < 8; ++i) examine(windowAt(10.0 * i, other), queue, &detector);
  EXPECT_TRUE(detector.drift(queue, windowAt(70.0, other).endNs()).significant);
  EXPECT_FALSE(detector.drift(queue, windowAt(30.0, kLens).endNs()).significant);
}

TEST(ChangeDetector, ASegmentThatAllOthersContradictIsWrong) {
  const ChangeDetector detector(kRate);
  const auto wrongIn = [&](const SegmentQueue& queue) {
    return detector.wrongSegment(queue, queue.candidates().back().segment.endNs());
  };
  const SegmentQueue torn = queueOf(4, [](int i) { return i == 1 ? zoomed(kLens, 1.05) : kLens; });
  EXPECT_EQ(wrongIn(torn), torn.candidates()[1].segment.sequence);
  EXPECT_FALSE(wrongIn(queueOf(4, sameLens)));
  // Of two nobody knows which.
  EXPECT_FALSE(wrongIn(queueOf(2, [](int i) { return i == 1 ? zoomed(kLens, 1.05) : kLens; })));
}

// However clearly a window or all segments speak of another lens.
TEST(ChangeDetector, ARateOfZeroRaisesNoAlarm) {
  ChangeDetector off(0.0);
  EXPECT_EQ(off.limit(), 0.0);
  const SegmentQueue queue = queueOf(4, sameLens);
  for (const double at_s : {40.0, 50.0}) {
    const ChangeVerdict verdict = examine(windowAt(at_s, zoomed(kLens, 1.10)), queue, &off);
    EXPECT_EQ(verdict.kind, Kind::kDoubt) << at_s;
    EXPECT_LT(verdict.p_value, 1e-2) << at_s;
  }
  const Camera after = zoomed(kLens, 1.03);
  const SegmentQueue mixed = queueOf(8, [&](int i) { return i < 4 ? kLens : after; });
  ChangeDetector off_too(0.0);
  EXPECT_NE(examine(windowAt(80.0, after), mixed, &off_too).kind, Kind::kChange);
}

}  // namespace
}  // namespace camera_self_calibration
