#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "camera_self_calibration/queue/segment_queue.h"
#include "camera_self_calibration/simulation/segment_maker.h"

namespace camera_self_calibration {

/// Segments of one trajectory seen through `truth`, one after the other, that share nothing; noise
/// of 0.2 px.
inline std::vector<Segment> separateSegments(const Camera& truth, int count,
                                             std::uint64_t seed = 3) {
  std::vector<Segment> segments;
  for (int i = 0; i < count; ++i) {
    SegmentOptions options;
    options.camera = truth;
    options.start_s = 1.0 + 5.0 * i;
    options.tracks.max_features = 60;
    options.tracks.pixel_sigma = 0.2;
    segments.push_back(makeSegment(options, seed).segment);
    segments.back().sequence = i;
  }
  return segments;
}

/// A queue of these segments: scored, and then solved together, from `start`, whose model is
/// fitted.
inline SegmentQueue solvedQueue(const std::vector<Segment>& segments, const Camera& start) {
  std::vector<Candidate> candidates;
  for (const Segment& segment : segments) {
    candidates.push_back(evaluateCandidate(CandidateOptions(), segment, start));
  }
  SegmentQueue queue(QueuePolicy(10, 0.95), 1);
  EXPECT_EQ(queue.offer(candidates, {start}), static_cast<int>(segments.size()));
  return queue;
}

}  // namespace camera_self_calibration
