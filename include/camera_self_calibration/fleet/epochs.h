#pragma once

#include <cstddef>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/fleet/spread.h"

namespace camera_self_calibration {

/// What bags said of one camera, in the order of time.
struct EstimateSeries {
  Camera lens;  ///< Any near them: what a pixel is.
  std::vector<Estimate> estimates;
};

/// What is found to have happened between estimates, or to one of them.
struct EpochBoundary {
  std::size_t first = 0;  ///< Of the estimates after it.
  double p_value = 1.0;   ///< Before any correction for the number of tests.
};

struct EpochSplit {
  /// Of each estimate, counted from 0 in the order of time; -1: stray, it contradicts those before
  /// and after it, which agree.
  std::vector<int> epoch;
  std::vector<EpochBoundary> changes;  ///< In the order of time.

  int epochs() const { return static_cast<int>(changes.size()) + 1; }
};

/// Splits each series into periods of one lens. Between any two neighbours the lens may have
/// changed, and any but the first and last may be a stray one: as many hypotheses, over all series,
/// of which the likeliest to be false is rejected, and the next looked for in what is left, as long
/// as Holm's limit allows. Of fleets in which nothing ever changed, the share `level` shows a
/// change.
std::vector<EpochSplit> findEpochs(const std::vector<EstimateSeries>& cameras, double level);

}  // namespace camera_self_calibration
