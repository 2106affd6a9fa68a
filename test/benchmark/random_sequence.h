#pragma once

#include <cstdint>
#include <string>

#include "camera_self_calibration/simulation/simulated_sequence.h"

namespace camera_self_calibration {

/// A rendered sequence as a user may have it.
struct RandomSequence {
  SequenceOptions options;
  std::string motion;  ///< In words, for tables.
};

/// Lens (randomLens), size, furniture and textures of the room, gray noise, motion and its speed,
/// all drawn by the seed. Every third sequence moves along a recorded trajectory of the folder
/// `trajectories` (euroc_V1_01.tum, tumvi_room4.tum, euroc_MH_01.tum) from a random moment on; all
/// move hand-held if the folder's name is empty. 640 x 480 at 20 Hz.
/// Throws std::runtime_error if a recording cannot be read.
RandomSequence randomSequence(CameraModel model, double duration_s, std::uint64_t seed,
                              const std::string& trajectories);

}  // namespace camera_self_calibration
