#pragma once

#include <functional>
#include <vector>

#include "camera_self_calibration/map/segment.h"
#include "queue/sample_queues.h"

namespace camera_self_calibration {

/// Where a pixel of a lens is seen that goes beyond its model [px].
using Displace = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

inline Segment displaced(Segment segment, const Displace& displace) {
  for (Landmark& landmark : segment.landmarks) {
    landmark.reference_pixel = displace(landmark.reference_pixel);
  }
  for (Observation& observation : segment.observations) {
    observation.pixel = displace(observation.pixel);
  }
  return segment;
}

/// separateSegments() of a lens that goes beyond its model.
inline std::vector<Segment> displacedSegments(const Camera& truth, const Displace& displace,
                                              int count, std::uint64_t seed = 3) {
  std::vector<Segment> segments = separateSegments(truth, count, seed);
  for (Segment& segment : segments) segment = displaced(segment, displace);
  return segments;
}

}  // namespace camera_self_calibration
