#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/pipeline/back_end.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/reference/trajectory_batch.h"
#include "camera_self_calibration/tools/json.h"

namespace camera_self_calibration {

/// What a queue of another size makes of the same keyframes.
struct QueueSizeRun {
  int segments = 0;
  std::vector<CalibrationReport> reports;  ///< One a keyframe.
};

/// A run beside its whole-trajectory batch (section III).
struct BatchComparison {
  /// At intervals, the last one over all keyframes with the present lens.
  std::vector<BatchEstimate> batch;
  std::size_t present_lens = 0;  ///< The first estimate of it among them.
  std::uint64_t changes = 0;     ///< Of the lens, before it.
  int solved_keyframes = 0;      ///< In the last estimate.
  std::vector<QueueSizeRun> sizes;
};

/// The batch of all keyframes with the present lens, if there is one whose parameters are those of
/// the queue.
const BatchEstimate* comparable(const CalibrationReport& queue, const BatchComparison& comparison);

/// Watches a run: solves the whole trajectory (after a change of the lens, what came since) at
/// intervals that grow with its length, and runs further back ends, with queues of 5, 10, 15 and 20
/// segments, on the same keyframes.
class BatchComparer {
 public:
  explicit BatchComparer(const Options& options) : options_(options) {}

  /// A keyframe on its way to the back end; `first` is the camera that the run started from.
  void add(const KeyframeMessage& message, const Camera& first);

  /// The run's own report on the same keyframe.
  void add(const CalibrationReport& report);

  /// Solves once more if keyframes came since the last solution.
  BatchComparison finish();

 private:
  struct OtherSize {
    std::unique_ptr<BackEnd> back_end;
    QueueSizeRun run;
  };

  void startOthers(const Camera& first);
  void solve();

  Options options_;
  TrajectoryBatch trajectory_;
  int solved_ = 0;  // keyframes in the trajectory at the last solution
  CalibrationReport newest_;
  BatchComparison result_;
  std::vector<OtherSize> others_;
};

/// Queue against batch in a table: parameter, both estimates with sigma, and their difference over
/// sqrt(diag(C_queue - C_batch)), which an efficient estimator's differences have as their sigma.
/// Says what it covers where the lens changed. Empty without a batch estimate of the present lens
/// of as many parameters.
std::string batchText(const CalibrationReport& queue, const BatchComparison& comparison);

/// For summary.json; null where batchText is empty.
Json batchJson(const CalibrationReport& queue, const BatchComparison& comparison);

/// Writes fig4_parameters.png (every parameter with 3-sigma bounds for queue and batch, and the
/// determinant), fig5_focal_length.png and fig7_queue_sizes.png into a folder: the paper's figures
/// for this run. A `reference` of the same model is drawn as a line. Throws std::runtime_error if a
/// file cannot be written.
void writeBatchFigures(const std::string& folder, const std::vector<CalibrationReport>& reports,
                       const BatchComparison& comparison, const std::optional<Camera>& reference);

}  // namespace camera_self_calibration
