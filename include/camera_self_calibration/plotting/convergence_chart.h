#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>

#include "camera_self_calibration/plotting/convergence_history.h"
#include "camera_self_calibration/plotting/palette.h"

namespace camera_self_calibration {

struct ConvergenceStyle {
  int width = 760;   ///< [px], at least 400.
  int height = 720;  ///< [px], at least 400.
  Theme theme = Theme::kLight;
  /// A known calibration of the same model, drawn as a dashed line.
  std::optional<Camera> truth;
  double threshold_px = 0.0;  ///< Where CONVERGED begins, drawn if positive [px rms].
};

/// The chart of a run: state, sentence and checks; every parameter over time with its band of 3
/// sigma; the expected error in pixels; the queue's segments, coloured by score. The vertical lines
/// are the hand-over (dashed) and the beginning of an epoch. BGR, 8 bits. Without any report the
/// chart says that it waits for one.
cv::Mat drawConvergence(const ConvergenceHistory& history, const ConvergenceStyle& style = {});

/// The checks behind a verdict, for pictures: "halves of the video agree, lens model fits, features
/// in 96 % of the image". Empty before there are any.
std::string checksInWords(const CalibrationReport& report);

/// Share of a segment's score between the best (0) and the worst (1) entropy of a queue; 0 if all
/// are the same.
double scoreShare(const SegmentReport& segment, const QueueReport& queue);

}  // namespace camera_self_calibration
