#include "camera_self_calibration/plotting/convergence_history.h"

#include <cmath>
#include <limits>

#include "camera_self_calibration/base/stamp.h"

namespace camera_self_calibration {
namespace {

Intrinsics sigmasOf(const CalibrationReport& report) {
  const Eigen::Index estimated = report.covariance.rows();
  Intrinsics sigmas =
      Intrinsics::Constant(report.camera.parameterCount(),
                           estimated == 0 ? std::numeric_limits<double>::quiet_NaN() : 0.0);
  for (Eigen::Index i = 0; i < estimated; ++i) sigmas[i] = std::sqrt(report.covariance(i, i));
  return sigmas;
}

ConvergencePoint toPoint(const CalibrationReport& report, double seconds) {
  ConvergencePoint point;
  point.seconds = seconds;
  point.state = report.state;
  point.model = report.camera.model();
  point.epoch = report.epoch;
  point.handed_over = report.handed_over;
  point.values = report.camera.parameters();
  point.sigmas = sigmasOf(report);
  point.pixel_rms = report.covariance.size() > 0 ? report.uncertainty.rms
                                                 : std::numeric_limits<double>::infinity();
  return point;
}

}  // namespace

void ConvergenceHistory::add(const CalibrationReport& report) {
  if (!newest_) {
    axis_begin_ns_ = report.stamp_ns;
  } else if (report.stamp_ns < latest_.stamp_ns) {
    axis_begin_ns_ += report.stamp_ns - latest_.stamp_ns;
  }
  latest_ = report;
  newest_ = toPoint(report, toSeconds(report.stamp_ns - axis_begin_ns_));
  rememberSpans();
  if (seen_++ % stride_ != 0) return;
  if (points_.size() >= max_points_) thinOut();
  points_.push_back(*newest_);
}

std::vector<ConvergencePoint> ConvergenceHistory::points() const {
  std::vector<ConvergencePoint> all = points_;
  if (newest_ && all.back().seconds != newest_->seconds) all.push_back(*newest_);
  return all;
}

std::optional<ConvergenceHistory::Span> ConvergenceHistory::span(std::int64_t sequence) const {
  const auto found = spans_.find(sequence);
  return found == spans_.end() ? std::nullopt : std::optional<Span>(found->second);
}

// A span is placed when its segment enters the queue: later the clock may have jumped.
void ConvergenceHistory::rememberSpans() {
  std::map<std::int64_t, Span> kept;
  for (const SegmentReport& segment : latest_.queue.segments) {
    const auto known = spans_.find(segment.sequence);
    kept[segment.sequence] = known != spans_.end()
                                 ? known->second
                                 : Span{toSeconds(segment.begin_ns - axis_begin_ns_),
                                        toSeconds(segment.end_ns - axis_begin_ns_)};
  }
  spans_.swap(kept);
}

void ConvergenceHistory::thinOut() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points_.size(); i += 2) points_[kept++] = points_[i];
  points_.resize(kept);
  stride_ *= 2;
}

}  // namespace camera_self_calibration
