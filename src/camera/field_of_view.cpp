#include "camera_self_calibration/camera/field_of_view.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "camera_self_calibration/base/angle.h"

namespace camera_self_calibration {
namespace {

double angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

double angleBetween(const Camera& camera, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const auto one = camera.unproject(a);
  const auto middle = camera.unproject(0.5 * (a + b));
  const auto other = camera.unproject(b);
  if (!one || !middle || !other) return std::numeric_limits<double>::quiet_NaN();
  // By way of the middle, so that more than 180 degrees are possible.
  return angle(*one, *middle) + angle(*middle, *other);
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
