#pragma once

#include <cstddef>
#include <vector>

#include "camera_self_calibration/estimation/linear_segment.h"

namespace camera_self_calibration {

/// One linearisation per block of a problem. Their memory is kept by the thread for its next
/// problem: it is large, and the system would hand it out and clear it page by page each time.
class LinearSegments {
 public:
  explicit LinearSegments(std::size_t count);
  ~LinearSegments();
  LinearSegments(const LinearSegments&) = delete;
  LinearSegments& operator=(const LinearSegments&) = delete;

  LinearSegment& operator[](std::size_t i) { return segments_[i]; }
  const LinearSegment& operator[](std::size_t i) const { return segments_[i]; }

 private:
  std::vector<LinearSegment> segments_;
};

}  // namespace camera_self_calibration
