#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "camera_self_calibration/pipeline/results.h"

namespace camera_self_calibration {

/// What a chart needs of one CalibrationReport.
struct ConvergencePoint {
  double seconds = 0.0;  ///< Since the first report; never goes back.
  CalibrationState state = CalibrationState::kWaitingForMotion;
  CameraModel model = CameraModel::kPinhole;
  std::uint64_t epoch = 0;
  bool handed_over = false;
  Intrinsics values;
  /// Standard deviations, as long as `values`: not a number without an estimate, 0 of a value held
  /// fixed.
  Intrinsics sigmas;
  double pixel_rms = 0.0;  ///< Expected error over the image [px]; infinite without an estimate.
};

/// The reports of a run in bounded memory: when it is full every second point goes, and from then
/// on only every second report comes in.
class ConvergenceHistory {
 public:
  /// When a segment of the queue was recorded, on the time axis of the points [s].
  struct Span {
    double begin = 0.0;
    double end = 0.0;
  };

  explicit ConvergenceHistory(std::size_t max_points = 1000) : max_points_(max_points) {}

  /// Reports in the order in which they came. Where their stamps jump back (a bag in a loop) the
  /// time axis goes on from its end.
  void add(const CalibrationReport& report);

  /// Thinned out; the newest report's point is always the last.
  std::vector<ConvergencePoint> points() const;
  bool empty() const { return !newest_; }
  /// The newest report; only if not empty().
  const CalibrationReport& latest() const { return latest_; }
  /// Of a segment in the latest report's queue.
  std::optional<Span> span(std::int64_t sequence) const;

 private:
  void rememberSpans();
  void thinOut();

  std::size_t max_points_;
  std::vector<ConvergencePoint> points_;
  std::optional<ConvergencePoint> newest_;
  CalibrationReport latest_;
  std::map<std::int64_t, Span> spans_;  // by sequence
  std::int64_t axis_begin_ns_ = 0;      // stamp at 0 s of the axis, in the clock of the newest
  std::uint64_t seen_ = 0;
  std::uint64_t stride_ = 1;
};

}  // namespace camera_self_calibration
