#pragma once

#include <functional>
#include <string>

#include "camera_self_calibration/simulation/simulated_sequence.h"

namespace camera_self_calibration {

/// Writes `truth.yaml` (model, width, height, params; zoom_at [s] and zoom if there is one).
/// Throws std::runtime_error if it cannot.
void writeTruth(const std::string& path, const Lens& lens);

/// Writes a sequence as a folder, which is made if missing: `000000.png` ... (`extension` "png" or
/// "jpg"), `truth.yaml` and `ground_truth.tum` (world_from_camera, one line an image, stamps in
/// seconds). `progress`, if given, is called after each image with its index. Throws
/// std::runtime_error that names the file that cannot be written.
void writeSequence(const SimulatedSequence& sequence, const std::string& folder,
                   const std::string& extension = "png",
                   const std::function<void(int)>& progress = nullptr);

}  // namespace camera_self_calibration
