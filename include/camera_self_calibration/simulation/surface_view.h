#pragma once

#include <Eigen/Core>
#include <vector>

#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/simulation/painted_world.h"
#include "camera_self_calibration/simulation/ray_tiles.h"

namespace camera_self_calibration {

/// A surface as seen from one pose: along a ray d of the camera its inverse distance is
/// `inverse_distance.d` and its texture position `(x.d, y.d) / (inverse_distance.d)`, all linear
/// in d. The ray meets the surface where all five `borders.d` are positive.
struct SurfaceView {
  const Texture* texture = nullptr;  ///< Null if the surface turns its back to the camera.
  Eigen::Vector3f x = Eigen::Vector3f::Zero();                 ///< [texel/m]
  Eigen::Vector3f y = Eigen::Vector3f::Zero();                 ///< [texel/m]
  Eigen::Vector3f inverse_distance = Eigen::Vector3f::Zero();  ///< [1/m]
  /// Unit normals of the planes through the eye and the four edges, and of that parallel to the
  /// surface, all pointing to the surface's side.
  Eigen::Matrix<float, 3, 5> borders = Eigen::Matrix<float, 3, 5>::Zero();

  enum class Cover { kNone, kPart, kAll };
  /// How much of a cone of rays may meet the surface: kNone and kAll are certain.
  Cover cover(const RayCone& cone) const;
  bool meets(const Eigen::Vector3f& ray) const;
};

/// One view per surface of the world and of its bodies at a time [s], in the order of its textures.
std::vector<SurfaceView> viewsFrom(const PaintedWorld& world, const Rigid3& world_from_camera,
                                   double time_s);

}  // namespace camera_self_calibration
