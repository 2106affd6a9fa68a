#pragma once

#include <cstdint>
#include <vector>

#include "camera_self_calibration/queue/queue_estimate.h"
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

/// A queue of solved segments with their joint estimate.
struct SolvedQueue {
  QueueEstimate estimate{1};
  QueueSolution solution;

  /// All are scored, and then solved together, from `start`, whose model is fitted.
  SolvedQueue(const std::vector<Segment>& segments, const Camera& start) {
    for (const Segment& segment : segments) {
      estimate.add(evaluateCandidate(CandidateOptions(), segment, start));
    }
    solution = estimate.solve(start);
  }
};

}  // namespace camera_self_calibration
