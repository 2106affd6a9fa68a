#include "camera_self_calibration/calibration/place_recognition.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "camera_self_calibration/estimation/pose_solver.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

constexpr std::size_t kMinSeen = 15;
constexpr double kMinShare = 0.35;          // of the matches
constexpr double kTolerance = 3.0 / 640.0;  // [image widths] A corner is not found twice at a spot.
constexpr double kMaxPoseSigma = 0.05;      // [median depths]
constexpr int kMaxSamples = 150;
constexpr double kMissed = 1e-3;  // probability that no sample was free of wrong matches
constexpr int kSampleSize = 4;
constexpr double kHuber = 2.0;

PointView viewOf(const SeenAgain& seen, double sigma) {
  return {seen.point.direction, seen.point.origin, seen.point.inverse_depth, seen.pixel, sigma};
}

// The pose at the place's own position that turns the points' rays to where they are seen: where
// the search from a sample begins.
Rigid3 turnedTo(const Place& place, const std::vector<SeenAgain>& sample, const Camera& camera) {
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (const SeenAgain& seen : sample) {
    const auto ray = camera.unproject(seen.pixel);
    if (!ray) continue;
    correlation += directionFrom(seen.point, place.world_from_camera.translation).normalized() *
                   ray->transpose();
  }
  return {Eigen::Quaterniond(nearestRotation(correlation)), place.world_from_camera.translation};
}

std::vector<SeenAgain> agreeing(const std::vector<SeenAgain>& matches, const Rigid3& pose,
                                const Camera& camera) {
  const double limit = kTolerance * camera.width();
  std::vector<SeenAgain> result;
  for (const SeenAgain& seen : matches) {
    Eigen::Vector2d pixel;
    const Eigen::Vector3d ray =
        pose.rotation.conjugate() * directionFrom(seen.point, pose.translation);
    if (camera.project(ray, &pixel) && (pixel - seen.pixel).norm() < limit) result.push_back(seen);
  }
  return result;
}

PoseEstimate poseFrom(const std::vector<SeenAgain>& seen, const Rigid3& guess,
                      const Camera& camera) {
  std::vector<PointView> views;
  for (const SeenAgain& one : seen) views.push_back(viewOf(one, kTolerance / 3.0 * camera.width()));
  return solvePose(camera, views, guess, kHuber, 15);
}

// Matches that agree with a pose found from a few of them: the largest such set.
std::vector<SeenAgain> largestAgreement(const Place& place, const std::vector<SeenAgain>& matches,
                                        const Camera& camera) {
  std::mt19937 random(1);
  std::vector<SeenAgain> best;
  std::vector<SeenAgain> shuffled = matches;
  for (int i = 0; i < kMaxSamples; ++i) {
    for (int k = 0; k < kSampleSize; ++k) {
      std::swap(shuffled[k], shuffled[k + random() % (shuffled.size() - k)]);
    }
    const std::vector<SeenAgain> sample(shuffled.begin(), shuffled.begin() + kSampleSize);
    const PoseEstimate pose = poseFrom(sample, turnedTo(place, sample, camera), camera);
    std::vector<SeenAgain> seen = agreeing(matches, pose.world_from_camera, camera);
    if (seen.size() > best.size()) best = std::move(seen);
    const double share = static_cast<double>(best.size()) / static_cast<double>(matches.size());
    if (std::pow(1.0 - std::pow(share, kSampleSize), i + 1) < kMissed) break;
  }
  return best;
}

}  // namespace

std::vector<SeenAgain> matchPlace(const Place& place, const std::vector<Appearance>& appearances) {
  std::vector<Descriptor> now;
  for (const Appearance& appearance : appearances) now.push_back(appearance.descriptor);
  std::vector<SeenAgain> matches;
  for (const auto& [a, p] : matchAppearances(now, place.descriptors)) {
    const Appearance& appearance = appearances[static_cast<std::size_t>(a)];
    const PlacePoint& point = place.points[static_cast<std::size_t>(p)];
    if (point.known) matches.push_back({appearance.track_id, point, appearance.pixel});
  }
  return matches;
}

std::optional<RecognizedPlace> recognize(const Place& place, const std::vector<SeenAgain>& matches,
                                         const Camera& camera) {
  if (matches.size() < kMinSeen) return std::nullopt;
  RecognizedPlace result;
  result.map_id = place.map_id;
  result.seen = largestAgreement(place, matches, camera);
  PoseEstimate pose;
  pose.world_from_camera = place.world_from_camera;
  for (int pass = 0; pass < 2; ++pass) {
    if (result.seen.size() < kMinSeen) return std::nullopt;
    const Rigid3 guess = pass == 0 ? turnedTo(place, result.seen, camera) : pose.world_from_camera;
    pose = poseFrom(result.seen, guess, camera);
    result.seen = agreeing(matches, pose.world_from_camera, camera);
  }
  const double sigma = std::sqrt(pose.covariance.topLeftCorner<3, 3>().trace());
  if (!pose.usable || sigma * place.inverse_depth > kMaxPoseSigma) return std::nullopt;
  if (result.seen.size() < std::max<double>(kMinSeen, kMinShare * matches.size())) {
    return std::nullopt;
  }
  result.old_from_camera = pose.world_from_camera;
  return result;
}

}  // namespace camera_self_calibration
