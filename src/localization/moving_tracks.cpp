#include "camera_self_calibration/localization/moving_tracks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/estimation/gate.h"

namespace camera_self_calibration {
namespace {

constexpr std::size_t kMinKnown = 15;
constexpr double kMedianNorm = 1.1774;  // of two standard normal coordinates
constexpr int kDepthSteps = 6;
constexpr double kParallaxStep = 1e-6;  // [rad] of numeric derivatives, in any unit of the map

// Eq. (1); false where the point cannot be seen.
bool predict(const Camera& camera, const Rigid3& world_from_camera, const PointView& view,
             double inverse_depth, Eigen::Vector2d* pixel) {
  const Eigen::Vector3d ray =
      view.direction + inverse_depth * (view.origin - world_from_camera.translation);
  return camera.project(world_from_camera.rotation.conjugate() * ray, pixel);
}

double residualPx(const Camera& camera, const Rigid3& pose, const PointView& view,
                  double inverse_depth) {
  Eigen::Vector2d pixel;
  if (!predict(camera, pose, view, inverse_depth, &pixel)) {
    return std::numeric_limits<double>::infinity();
  }
  return (view.pixel - pixel).norm();
}

// The least residual over all depths in front of the reference, by Gauss-Newton in the inverse
// depth from the guess.
double residualAtAnyDepthPx(const Camera& camera, const Rigid3& pose, const PointView& view) {
  const double delta = kParallaxStep / (view.origin - pose.translation).norm();
  double inverse_depth = view.inverse_depth;
  double least =
      std::min(residualPx(camera, pose, view, inverse_depth), residualPx(camera, pose, view, 0));
  for (int i = 0; i < kDepthSteps; ++i) {
    Eigen::Vector2d pixel;
    Eigen::Vector2d beside;
    if (!predict(camera, pose, view, inverse_depth, &pixel) ||
        !predict(camera, pose, view, inverse_depth + delta, &beside)) {
      break;
    }
    const Eigen::Vector2d slope = (beside - pixel) / delta;
    if (!(slope.squaredNorm() > 0.0) || !slope.allFinite()) break;
    inverse_depth =
        std::max(0.0, inverse_depth + slope.dot(view.pixel - pixel) / slope.squaredNorm());
    least = std::min(least, residualPx(camera, pose, view, inverse_depth));
  }
  return least;
}

}  // namespace

std::vector<std::int64_t> movingTracks(const Camera& camera, const Rigid3& world_from_camera,
                                       const std::vector<TrackedPoint>& points, double min_px) {
  std::vector<std::int64_t> moving;
  std::vector<double> residuals;
  std::vector<double> known;
  for (const TrackedPoint& point : points) {
    residuals.push_back(
        point.depth_known
            ? residualPx(camera, world_from_camera, point.view, point.view.inverse_depth)
            : residualAtAnyDepthPx(camera, world_from_camera, point.view));
    if (point.depth_known) known.push_back(residuals.back() / point.view.sigma);
  }
  if (known.size() < kMinKnown) return moving;
  const double scale = std::max(1.0, median(std::move(known), 1.0) / kMedianNorm);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double limit = std::max(min_px, kGrossSigmas * scale * points[i].view.sigma);
    if (!(residuals[i] <= limit)) moving.push_back(points[i].track_id);
  }
  return moving;
}

}  // namespace camera_self_calibration
