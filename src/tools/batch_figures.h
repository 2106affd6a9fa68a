#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "camera_self_calibration/tools/batch_comparison.h"

namespace camera_self_calibration {

/// The paper's figures 4, 5 and 7 for a run, over the number of keyframes. With no batch estimates
/// the queue stands alone. `fine`: twice as many pixels.
cv::Mat drawParameterFigure(const std::vector<CalibrationReport>& reports,
                            const BatchComparison& comparison,
                            const std::optional<Camera>& reference, bool fine);
cv::Mat drawFocalLengthFigure(const std::vector<CalibrationReport>& reports,
                              const BatchComparison& comparison,
                              const std::optional<Camera>& reference, bool fine);
cv::Mat drawQueueSizeFigure(const BatchComparison& comparison,
                            const std::optional<Camera>& reference, bool fine);

}  // namespace camera_self_calibration
