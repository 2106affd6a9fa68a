#pragma once

#include <functional>
#include <string>
#include <vector>

#include "camera_self_calibration/pipeline/self_calibrator.h"

namespace camera_self_calibration {

struct PipelineRunOptions {
  SelfCalibrator::Mode mode = SelfCalibrator::Mode::kInline;
  CameraModel model = CameraModel::kFov;
  double rate_hz = 0.0;        ///< Live; 0: as fast as it goes.
  bool count_startup = false;  ///< Whether images before hand-over count in frame_ms.
};

/// The whole system over a sequence, timed.
struct PipelineRun {
  int frames = 0;
  double fps = 0.0;
  double cpu_seconds = 0.0;  ///< Of all threads.
  double wall_seconds = 0.0;
  long keyframes = 0;
  long dropped = 0;              ///< Images.
  std::vector<double> frame_ms;  ///< Of each image.
  CalibrationReport report;      ///< At the end.
};

/// `frame_at` is called for 0 .. frames - 1 in order.
PipelineRun runPipeline(const PipelineRunOptions& options, int frames,
                        const std::function<ImageView(int)>& frame_at);

/// One JSON object.
void printRun(const std::string& name, const PipelineRun& run);

}  // namespace camera_self_calibration
