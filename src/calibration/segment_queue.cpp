#include "camera_self_calibration/calibration/segment_queue.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "camera_self_calibration/estimation/entropy.h"
#include "camera_self_calibration/estimation/marginal.h"

namespace camera_self_calibration {
namespace {

bool overlap(const SegmentScore& a, const SegmentScore& b) {
  return a.begin_ns <= b.end_ns && b.begin_ns <= a.end_ns;
}

std::string compare(const char* outcome, double candidate, const char* with, double limit) {
  char buffer[200];
  std::snprintf(buffer, sizeof(buffer), "%s: entropy %.2f against %.2f needed to beat %s", outcome,
                candidate, limit, with);
  return buffer;
}

// The entropy that a candidate would have to undercut, and the segments that it would replace.
struct Rival {
  double entropy = 0.0;
  std::vector<std::int64_t> sequences;
  const char* name = "";
};

Rival overlappingRival(const std::vector<const SegmentScore*>& overlapping, const Camera& camera) {
  Rival rival;
  if (overlapping.size() == 1) {
    return {overlapping.front()->entropy,
            {overlapping.front()->sequence},
            "the segment that it overlaps"};
  }
  rival.name = "the segments that it overlaps, together";
  IntrinsicsMatrix information = overlapping.front()->information;
  rival.sequences = {overlapping.front()->sequence};
  for (std::size_t i = 1; i < overlapping.size(); ++i) {
    information += overlapping[i]->information;
    rival.sequences.push_back(overlapping[i]->sequence);
  }
  const auto covariance = covarianceFromInformation(information);
  rival.entropy = covariance ? entropy(camera, *covariance) : INFINITY;
  return rival;
}

Rival worstRival(const std::vector<SegmentScore>& segments) {
  const auto worst = std::max_element(
      segments.begin(), segments.end(),
      [](const SegmentScore& a, const SegmentScore& b) { return a.entropy < b.entropy; });
  return {worst->entropy, {worst->sequence}, "the queue's worst segment"};
}

}  // namespace

QueueDecision SegmentQueue::consider(const SegmentScore& candidate, const Camera& camera) const {
  QueueDecision decision;
  if (!candidate.well_posed || !std::isfinite(candidate.entropy)) {
    decision.reason = "refused: ill posed";
    return decision;
  }
  std::vector<const SegmentScore*> overlapping;
  for (const SegmentScore& segment : segments_) {
    if (overlap(candidate, segment)) overlapping.push_back(&segment);
  }
  if (overlapping.empty() && static_cast<int>(segments_.size()) < capacity_) {
    decision.accepted = true;
    decision.reason = "accepted: the queue has room and it overlaps no segment";
    return decision;
  }
  const Rival rival =
      overlapping.empty() ? worstRival(segments_) : overlappingRival(overlapping, camera);
  const auto count = static_cast<double>(candidate.information.rows());
  const double limit = rival.entropy - count * std::log(1.0 / alpha_);
  decision.accepted = candidate.entropy < limit;
  if (decision.accepted) decision.replaced = rival.sequences;
  decision.reason =
      compare(decision.accepted ? "accepted" : "refused", candidate.entropy, rival.name, limit);
  return decision;
}

QueueDecision SegmentQueue::offer(const SegmentScore& candidate, const Camera& camera) {
  const QueueDecision decision = consider(candidate, camera);
  if (!decision.accepted) return decision;
  const auto leaves = [&](const SegmentScore& segment) {
    return std::find(decision.replaced.begin(), decision.replaced.end(), segment.sequence) !=
           decision.replaced.end();
  };
  segments_.erase(std::remove_if(segments_.begin(), segments_.end(), leaves), segments_.end());
  segments_.push_back(candidate);
  return decision;
}

}  // namespace camera_self_calibration
