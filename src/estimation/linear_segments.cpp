#include "camera_self_calibration/estimation/linear_segments.h"

#include <utility>

namespace camera_self_calibration {
namespace {

std::vector<LinearSegment>& spareOnes() {
  thread_local std::vector<LinearSegment> spare;
  return spare;
}

}  // namespace

LinearSegments::LinearSegments(std::size_t count) {
  std::vector<LinearSegment>& spare = spareOnes();
  segments_.reserve(count);
  while (segments_.size() < count && !spare.empty()) {
    segments_.push_back(std::move(spare.back()));
    spare.pop_back();
  }
  segments_.resize(count);
}

LinearSegments::~LinearSegments() {
  std::vector<LinearSegment>& spare = spareOnes();
  for (LinearSegment& segment : segments_) spare.push_back(std::move(segment));
}

}  // namespace camera_self_calibration
