#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "camera_self_calibration/fleet/epochs.h"
#include "camera_self_calibration/fleet/segment_store.h"
#include "camera_self_calibration/pipeline/bag_record.h"

namespace camera_self_calibration {

/// A bag of a camera.
struct HistoricBag {
  BagRecord record;  ///< As it came.
  /// The same with the model of the camera, where the bag itself chose another.
  BagRecord used;
  std::string problem;  ///< Why it cannot be compared with others, in words; empty if it can.
  int epoch = -1;       ///< From 0; -1: a stray one, or not comparable.
};

/// All that is known of a camera, before its queues are merged.
struct CameraHistory {
  std::string name;
  Camera lens;                         ///< Model and image size, and about the lens of most bags.
  std::vector<HistoricBag> bags;       ///< In the order of time.
  std::vector<EpochBoundary> changes;  ///< EpochBoundary::first counts in `bags`.

  int epochs() const { return static_cast<int>(changes.size()) + 1; }
};

/// The estimate of a bag for comparisons: what its lens model and the halves of its video leave
/// open beyond the noise counts too.
Estimate estimateOf(const BagRecord& record);

/// Sum over the bags of an epoch.
EstimateSum sumOf(const CameraHistory& history, int epoch);

/// Sorts records into cameras by name, orders each camera's in time, and finds their epochs
/// (findEpochs). The same bag (path and times) twice counts once. Within a camera one model is
/// used: the one that most bags chose, or else the richer one; bags with another one are solved
/// anew from their segments in `store`. Bags of another image size than most are left out with a
/// problem.
std::vector<CameraHistory> historiesOf(std::vector<BagRecord> records, const SegmentStore& store,
                                       double level);

}  // namespace camera_self_calibration
