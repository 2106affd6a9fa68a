#include "camera_self_calibration/tracking/keyframe_rule.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/camera/image_size.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

constexpr std::size_t kMinTracks = 8;  // For the first keyframe, and to judge motion by rays.
constexpr int kReweightings = 6;
// Share of min_parallax by which tracks must have moved before lost ones count: a person who walks
// past a still camera takes tracks away, too.
constexpr double kMovedShare = 0.25;
// Share of the last keyframe's tracks below which new ones have to start even if nothing moves:
// with the last tracks the pose would be lost.
constexpr double kNearlyAllLost = 0.3;

// A track in the last keyframe and now.
struct Pair {
  Eigen::Vector2d before;
  Eigen::Vector2d now;
};

std::vector<Pair> commonTracks(const TrackedFrame& last, const TrackedFrame& frame) {
  std::unordered_map<std::int64_t, Eigen::Vector2d> before;
  for (const Track& track : last.tracks) before.emplace(track.id, track.pixel);
  std::vector<Pair> pairs;
  for (const Track& track : frame.tracks) {
    const auto found = before.find(track.id);
    if (found != before.end()) pairs.push_back({found->second, track.pixel});
  }
  return pairs;
}

double medianFlow(const std::vector<Pair>& pairs) {
  std::vector<double> lengths;
  lengths.reserve(pairs.size());
  for (const Pair& pair : pairs) lengths.push_back((pair.now - pair.before).norm());
  return median(std::move(lengths), 0.0);
}

struct RayPair {
  Eigen::Vector3d before;
  Eigen::Vector3d now;
};

std::vector<RayPair> unproject(const std::vector<Pair>& pairs, const Camera& camera) {
  std::vector<RayPair> rays;
  for (const Pair& pair : pairs) {
    const std::optional<Eigen::Vector3d> before = camera.unproject(pair.before);
    const std::optional<Eigen::Vector3d> now = camera.unproject(pair.now);
    if (before && now) rays.push_back({*before, *now});
  }
  return rays;
}

// The rotation that minimises sum w |now - R before|^2.
Eigen::Matrix3d alignRays(const std::vector<RayPair>& rays, const std::vector<double>& weights) {
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    correlation += weights[i] * rays[i].now * rays[i].before.transpose();
  }
  return nearestRotation(correlation);
}

Eigen::Matrix3d robustRotation(const std::vector<RayPair>& rays) {
  std::vector<double> weights(rays.size(), 1.0);
  Eigen::Matrix3d rotation = alignRays(rays, weights);
  for (int k = 0; k < kReweightings; ++k) {
    std::vector<double> errors;
    errors.reserve(rays.size());
    for (const RayPair& ray : rays) errors.push_back((ray.now - rotation * ray.before).norm());
    const double scale = 1.5 * median(errors, 0.0) + 1e-9;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      weights[i] = 1.0 / (1.0 + errors[i] * errors[i] / (scale * scale));
    }
    rotation = alignRays(rays, weights);
  }
  return rotation;
}

struct Motion {
  double parallax = 0.0;  // [px] Median displacement beyond rotation.
  double rotation = 0.0;  // [rad]
};

Motion measureMotion(const std::vector<Pair>& pairs, const Camera& camera) {
  const std::vector<RayPair> rays = unproject(pairs, camera);
  // Without rays nothing tells rotation from translation: all that moves counts.
  if (rays.size() < kMinTracks) return {medianFlow(pairs), 0.0};
  const Eigen::Matrix3d rotation = robustRotation(rays);
  std::vector<double> residuals;
  for (const RayPair& ray : rays) {
    Eigen::Vector2d expected, now;
    if (camera.project(rotation * ray.before, &expected) && camera.project(ray.now, &now)) {
      residuals.push_back((now - expected).norm());
    }
  }
  const double cosine = 0.5 * (rotation.trace() - 1.0);
  return {median(std::move(residuals), 0.0), std::acos(std::clamp(cosine, -1.0, 1.0))};
}

}  // namespace

bool KeyframeRule::isKeyframe(const TrackedFrame& frame, const Camera& camera,
                              double spacing) const {
  if (last_.tracks.empty()) return frame.tracks.size() >= kMinTracks;
  const std::vector<Pair> pairs = commonTracks(last_, frame);
  if (pairs.empty() || frame.width <= 0) return false;
  const double min_parallax =
      spacing * options_.min_parallax * longerSide(frame.width, frame.height);  // [px]
  const double min_rotation = spacing * options_.min_rotation_deg * kDegree;
  const Motion motion = measureMotion(pairs, camera);
  if (motion.parallax >= min_parallax) return true;
  if (motion.rotation >= min_rotation) return true;
  const double share = static_cast<double>(pairs.size()) / static_cast<double>(last_.tracks.size());
  if (share < std::min(kNearlyAllLost, options_.min_tracked_share)) return true;
  return share < options_.min_tracked_share && medianFlow(pairs) >= kMovedShare * min_parallax;
}

}  // namespace camera_self_calibration
