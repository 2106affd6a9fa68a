#include "camera_self_calibration/queue/queue_policy.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/entropy.h"
#include "camera_self_calibration/estimation/marginal.h"

namespace camera_self_calibration {
namespace {

bool overlap(const SegmentScore& a, const SegmentScore& b) {
  return a.begin_ns <= b.end_ns && b.begin_ns <= a.end_ns;
}

// Both kinds as a logarithm, so that a better one is smaller by a fixed amount.
double scoreOf(ScoreKind kind, const SegmentScore& segment) {
  return kind == ScoreKind::kPixel ? std::log(segment.pixel_rms) : segment.entropy;
}

// The share of the candidate's length that replacing `overlapping` would leave unused.
double shareLeftUnused(const SegmentScore& candidate,
                       const std::vector<const SegmentScore*>& overlapping) {
  const auto length = [](std::int64_t begin_ns, std::int64_t end_ns) {
    return static_cast<double>(std::max<std::int64_t>(0, end_ns - begin_ns));
  };
  double unused = 0.0;
  for (const SegmentScore* one : overlapping) {
    unused +=
        length(one->begin_ns, one->end_ns) - length(std::max(one->begin_ns, candidate.begin_ns),
                                                    std::min(one->end_ns, candidate.end_ns));
  }
  return unused / std::max(1.0, length(candidate.begin_ns, candidate.end_ns));
}

double jointScore(ScoreKind kind, const IntrinsicsMatrix& information, const Camera& camera) {
  const auto covariance = covarianceFromInformation(information);
  if (!covariance) return INFINITY;
  return kind == ScoreKind::kPixel ? std::log(pixelUncertainty(camera, *covariance).rms)
                                   : entropy(camera, *covariance);
}

std::string compare(ScoreKind kind, bool accepted, double candidate, const char* with,
                    double limit) {
  const bool pixel = kind == ScoreKind::kPixel;
  return formatted("%s: %s %.*f (needed: %.*f, to replace %s)", accepted ? "accepted" : "refused",
                   pixel ? "pixel error [px]" : "entropy", pixel ? 4 : 2,
                   pixel ? std::exp(candidate) : candidate, pixel ? 4 : 2,
                   pixel ? std::exp(limit) : limit, with);
}

// The score that a candidate would have to undercut, and the segments that it would replace.
struct Rival {
  double score = 0.0;
  std::vector<std::int64_t> sequences;
  const char* name = "";
};

Rival overlappingRival(ScoreKind kind, const std::vector<const SegmentScore*>& overlapping,
                       const Camera& camera) {
  Rival rival;
  if (overlapping.size() == 1) {
    return {scoreOf(kind, *overlapping.front()),
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
  rival.score = jointScore(kind, information, camera);
  return rival;
}

Rival worstRival(ScoreKind kind, const std::vector<SegmentScore>& segments) {
  const auto worst = std::max_element(segments.begin(), segments.end(),
                                      [kind](const SegmentScore& a, const SegmentScore& b) {
                                        return scoreOf(kind, a) < scoreOf(kind, b);
                                      });
  return {scoreOf(kind, *worst), {worst->sequence}, "the queue's worst segment"};
}

}  // namespace

QueueDecision QueuePolicy::consider(const SegmentScore& candidate,
                                    const std::vector<SegmentScore>& segments, const Camera& camera,
                                    bool filling) const {
  QueueDecision decision;
  const double score = scoreOf(kind_, candidate);
  if (!candidate.well_posed || !std::isfinite(score)) {
    decision.reason = "refused: this segment alone does not determine the lens";
    return decision;
  }
  std::vector<const SegmentScore*> overlapping;
  for (const SegmentScore& segment : segments) {
    if (overlap(candidate, segment)) overlapping.push_back(&segment);
  }
  if (overlapping.empty() && static_cast<int>(segments.size()) < capacity_) {
    decision.accepted = true;
    decision.reason = "accepted: the queue has room, and no segment overlaps";
    return decision;
  }
  if (overlapping.size() > 1 && overlapping.size() == segments.size()) {
    decision.reason = "refused: it overlaps all segments, and one alone cannot be checked";
    return decision;
  }
  const Rival rival = overlapping.empty() ? worstRival(kind_, segments)
                                          : overlappingRival(kind_, overlapping, camera);
  // The entropy is the sum of the logarithms of as many sigmas as there are intrinsics.
  const double sigmas =
      kind_ == ScoreKind::kPixel ? 1.0 : static_cast<double>(candidate.information.rows());
  double margin = std::log(1.0 / alpha_);
  // Time that is left unused is information that is lost: variances add up inversely.
  if (filling && static_cast<int>(segments.size()) < capacity_)
    margin = std::max(margin, 0.5 * std::log1p(shareLeftUnused(candidate, overlapping)));
  const double limit = rival.score - sigmas * margin;
  decision.accepted = score < limit;
  if (decision.accepted) decision.replaced = rival.sequences;
  decision.reason = compare(kind_, decision.accepted, score, rival.name, limit);
  return decision;
}

}  // namespace camera_self_calibration
