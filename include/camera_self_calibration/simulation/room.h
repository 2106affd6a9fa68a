#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "camera_self_calibration/simulation/world.h"

namespace camera_self_calibration {

struct RoomOptions {
  std::uint64_t seed = 1;
  Eigen::Vector3d size = Eigen::Vector3d(6.0, 5.0, 3.0);  ///< Along x, y and z [m].
  bool furnished = true;        ///< Tables, shelves, crates, pillars, lamps.
  double texture_detail = 1.0;  ///< Factor on the texels per metre of every surface.

  /// Every violated bound in one sentence each; empty if all is well.
  std::vector<std::string> problems() const;
};

/// A furnished room with posters on its walls. The floor's centre is the origin; the furniture
/// stands along the walls or stays below the free space in the middle.
/// Throws std::invalid_argument that lists options.problems().
World makeRoom(const RoomOptions& options);

}  // namespace camera_self_calibration
