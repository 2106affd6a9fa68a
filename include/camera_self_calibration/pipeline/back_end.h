#pragma once

#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/calibration/candidate_window.h"
#include "camera_self_calibration/calibration/health.h"
#include "camera_self_calibration/calibration/queue_estimate.h"
#include "camera_self_calibration/calibration/segment_queue.h"
#include "camera_self_calibration/calibration/startup.h"
#include "camera_self_calibration/pipeline/front_end.h"
#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/pipeline/results.h"

namespace camera_self_calibration {

struct BackEndOutput {
  CalibrationReport report;
  std::optional<CalibrationUpdate> update;
  std::vector<Event> events;
};

/// Thread 2: from keyframes to intrinsics. Startup batch first; the queue is filled meanwhile and
/// takes over when its estimate is good enough and its segments agree.
class BackEnd {
 public:
  BackEnd(const Options& options, const Camera& camera);

  BackEndOutput process(const KeyframeMessage& message);

 private:
  void runStartup(const KeyframeMessage& message);
  void clearQueue();
  void offerCandidate(const KeyframeMessage& message);
  void solveQueue();
  void adoptSolution();
  void considerHandover(std::int64_t stamp_ns, std::vector<Event>* events);
  void judge(std::int64_t stamp_ns, std::vector<Event>* events);
  void fillQueueReport();

  Options options_;
  Startup startup_;
  SegmentQueue queue_;
  QueueEstimate estimate_;
  QueueSolution solution_;
  bool handed_over_ = false;
  bool changed_ = false;  // the estimate, by the newest keyframe
  std::string obstacle_;  // to hand-over
  CalibrationReport report_;
};

}  // namespace camera_self_calibration
