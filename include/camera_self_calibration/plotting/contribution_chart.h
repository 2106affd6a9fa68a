#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/plotting/sheet.h"
#include "camera_self_calibration/queue/candidate_window.h"

namespace camera_self_calibration {

/// By how much the estimate's errors would grow without one segment of its queue.
struct SegmentContribution {
  double begin_s = 0.0;  ///< On the axis of the recording.
  double end_s = 0.0;
  int keyframes = 0;
  int landmarks = 0;
  int observations = 0;
  double image = 0.0;          ///< Share by which the pixel uncertainty (rms) would grow.
  std::vector<double> values;  ///< The same for the sigma of each estimated parameter.
};

/// By how much errors would grow without the part `own` of the information `all`; its times and
/// counts are left empty.
SegmentContribution contributionOf(const Camera& camera, const IntrinsicsMatrix& all,
                                   const IntrinsicsMatrix& own);

/// From the segments' own information: covariances of the sum with and without each. A segment that
/// alone makes the estimate possible has an infinite share. `origin_ns` is 0 s of the axis. In
/// the order of time.
std::vector<SegmentContribution> contributions(const std::vector<Candidate>& queue,
                                               const Camera& camera, std::int64_t origin_ns);

/// Which seconds were informative: one row a parameter, below a row for the image, over time; the
/// darker the more.
Sheet drawContributions(const std::vector<SegmentContribution>& segments,
                        const std::vector<std::string>& names, double duration_s, int width);

}  // namespace camera_self_calibration
