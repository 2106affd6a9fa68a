#include "camera_self_calibration/camera/field_of_view.h"

#include <cmath>
#include <limits>

#include "camera_self_calibration/base/angle.h"

namespace camera_self_calibration {
namespace {

double angleBetween(const Camera& camera, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const auto one = camera.unproject(a);
  const auto other = camera.unproject(b);
  if (!one || !other) return std::numeric_limits<double>::quiet_NaN();
  // From the optical axis to each, so that more than 180 degrees are possible.
  const auto fromAxis = [](const Eigen::Vector3d& ray) {
    return std::atan2(ray.head<2>().norm(), ray.z());
  };
  return (fromAxis(*one) + fromAxis(*other)) / kDegree;
}

}  // namespace

FieldOfView fieldOfView(const Camera& camera) {
  const double right = camera.width() - 1.0;
  const double bottom = camera.height() - 1.0;
  const Eigen::Vector2d centre = camera.parameters().segment<2>(2);
  return {angleBetween(camera, {0.0, centre.y()}, {right, centre.y()}),
          angleBetween(camera, {centre.x(), 0.0}, {centre.x(), bottom}),
          angleBetween(camera, {0.0, 0.0}, {right, bottom})};
}

}  // namespace camera_self_calibration
