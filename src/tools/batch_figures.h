#pragma once

#include <optional>
#include <vector>

#include "camera_self_calibration/plotting/sheet.h"
#include "camera_self_calibration/tools/batch_comparison.h"

namespace camera_self_calibration {

/// The paper's figures 4, 5 and 7 for a run, over the number of keyframes. With no batch estimates
/// the queue stands alone. There must be reports.
Sheet drawParameterFigure(const std::vector<CalibrationReport>& reports,
                          const BatchComparison& comparison,
                          const std::optional<Camera>& reference);
Sheet drawFocalLengthFigure(const std::vector<CalibrationReport>& reports,
                            const BatchComparison& comparison,
                            const std::optional<Camera>& reference);
Sheet drawQueueSizeFigure(const BatchComparison& comparison, const std::optional<Camera>& reference,
                          int width);

/// The panels of drawParameterFigure, one by one.
std::vector<Sheet> drawParameterPanels(const std::vector<CalibrationReport>& reports,
                                       const BatchComparison& comparison,
                                       const std::optional<Camera>& reference, int width);

}  // namespace camera_self_calibration
