#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/fleet/segment_store.h"
#include "camera_self_calibration/pipeline/bag_record.h"

namespace camera_self_calibration {

/// What state files hold, without their segments: a kilobyte or two a bag.
struct StateCollection {
  std::vector<BagRecord> records;
  SegmentStore store;
  std::vector<std::string> problems;  ///< Files that are left out, and why.
};

/// Reads state files, of single bags or merged ones, one after the other. One that was learnt live
/// is a bag of its own, and names the camera by its file name.
StateCollection readStates(const std::vector<std::string>& paths);

}  // namespace camera_self_calibration
