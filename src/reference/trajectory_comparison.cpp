#include "camera_self_calibration/reference/trajectory_comparison.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kMaxGapNs = 250000000;
constexpr std::int64_t kIntervalNs = 1000000000;
// Two stamps so near to an interval apart make a pair for the relative error: one of the two that
// lie around it always is where the poses have no gap.
constexpr std::int64_t kIntervalToleranceNs = kMaxGapNs / 2;
constexpr std::size_t kMinPoses = 3;

struct Pair {
  StampedCameraPose estimate;
  Rigid3 reference;
};
using Pairs = std::vector<Pair>;

std::optional<StampedCameraPose> poseAt(const std::vector<StampedCameraPose>& poses,
                                        std::int64_t stamp_ns) {
  const auto after = std::lower_bound(
      poses.begin(), poses.end(), stamp_ns,
      [](const StampedCameraPose& pose, std::int64_t stamp) { return pose.stamp_ns < stamp; });
  if (after == poses.end()) return std::nullopt;
  if (after->stamp_ns == stamp_ns) return *after;
  if (after == poses.begin()) return std::nullopt;
  const StampedCameraPose& before = *std::prev(after);
  const std::int64_t gap = after->stamp_ns - before.stamp_ns;
  if (gap > kMaxGapNs || before.map_id != after->map_id) return std::nullopt;
  const double share = static_cast<double>(stamp_ns - before.stamp_ns) / static_cast<double>(gap);
  StampedCameraPose pose = before;
  pose.stamp_ns = stamp_ns;
  pose.world_from_camera.translation +=
      share * (after->world_from_camera.translation - before.world_from_camera.translation);
  pose.world_from_camera.rotation =
      before.world_from_camera.rotation.slerp(share, after->world_from_camera.rotation);
  return pose;
}

// Poses that can be compared, by the pair of maps that they belong to.
std::vector<Pairs> pairsOf(const std::vector<StampedCameraPose>& estimate,
                           const std::vector<StampedCameraPose>& reference) {
  std::map<std::pair<std::uint64_t, std::uint64_t>, Pairs> by_maps;
  for (const StampedCameraPose& pose : estimate) {
    const auto partner = poseAt(reference, pose.stamp_ns);
    if (!partner) continue;
    by_maps[{pose.map_id, partner->map_id}].push_back({pose, partner->world_from_camera});
  }
  std::vector<Pairs> all;
  for (auto& [maps, pairs] : by_maps) {
    if (pairs.size() >= kMinPoses) all.push_back(std::move(pairs));
  }
  return all;
}

struct Similarity {
  double scale = 1.0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Rigid3 operator*(const Rigid3& pose) const {
    return {Eigen::Quaterniond(rotation) * pose.rotation,
            scale * (rotation * pose.translation) + translation};
  }
};

Similarity alignment(const Pairs& pairs) {
  Eigen::Matrix3Xd from(3, pairs.size());
  Eigen::Matrix3Xd to(3, pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = pairs[i].estimate.world_from_camera.translation;
    to.col(static_cast<Eigen::Index>(i)) = pairs[i].reference.translation;
  }
  Similarity similarity;
  // A camera that turned on the spot has no scale.
  const Eigen::Vector3d centre = from.rowwise().mean();
  if (!((from.colwise() - centre).norm() > 1e-12)) return similarity;
  const Eigen::Matrix4d transform = Eigen::umeyama(from, to, true);
  const Eigen::Matrix3d scaled = transform.topLeftCorner<3, 3>();
  similarity.scale = std::cbrt(scaled.determinant());
  if (!(similarity.scale > 0.0)) return Similarity();
  similarity.rotation = scaled / similarity.scale;
  similarity.translation = transform.topRightCorner<3, 1>();
  return similarity;
}

struct RelativeError {
  int count = 0;
  double translation_squares = 0.0;
  double rotation_squares = 0.0;  // [rad^2]
};

void addRelativeError(const Pair& begin, const Pair& end, double scale, RelativeError* error) {
  Rigid3 motion = begin.estimate.world_from_camera.inverse() * end.estimate.world_from_camera;
  motion.translation *= scale;
  const Rigid3 difference = (begin.reference.inverse() * end.reference).inverse() * motion;
  ++error->count;
  error->translation_squares += difference.translation.squaredNorm();
  error->rotation_squares += logSo3(difference.rotation).squaredNorm();
}

void addRelativeErrors(const Pairs& pairs, double scale, RelativeError* error) {
  std::size_t after = 0;
  for (const Pair& begin : pairs) {
    const std::int64_t wanted = begin.estimate.stamp_ns + kIntervalNs;
    while (after < pairs.size() && pairs[after].estimate.stamp_ns < wanted) ++after;
    if (after == pairs.size()) return;
    const auto from_wanted = [wanted](const Pair& pair) {
      return std::abs(pair.estimate.stamp_ns - wanted);
    };
    const bool earlier = from_wanted(pairs[after - 1]) < from_wanted(pairs[after]);
    const Pair& end = pairs[earlier ? after - 1 : after];
    if (from_wanted(end) <= kIntervalToleranceNs) addRelativeError(begin, end, scale, error);
  }
}

}  // namespace

std::optional<TrajectoryDifference> compareTrajectories(
    const std::vector<StampedCameraPose>& estimate,
    const std::vector<StampedCameraPose>& reference) {
  TrajectoryDifference result;
  RelativeError relative;
  double sum = 0.0;
  double squares = 0.0;
  std::size_t most = 0;
  for (const Pairs& pairs : pairsOf(estimate, reference)) {
    const Similarity similarity = alignment(pairs);
    if (pairs.size() > most) result.scale = similarity.scale;
    most = std::max(most, pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Rigid3 moved = similarity * pairs[i].estimate.world_from_camera;
      const double distance = (moved.translation - pairs[i].reference.translation).norm();
      ++result.poses;
      sum += distance;
      squares += distance * distance;
      result.max = std::max(result.max, distance);
      if (i == 0) continue;
      result.travelled +=
          (pairs[i].reference.translation - pairs[i - 1].reference.translation).norm();
    }
    addRelativeErrors(pairs, similarity.scale, &relative);
  }
  if (result.poses == 0) return std::nullopt;
  result.mean = sum / result.poses;
  result.rms = std::sqrt(squares / result.poses);
  result.interval_s = toSeconds(kIntervalNs);
  if (relative.count == 0) return result;
  result.relative_translation = std::sqrt(relative.translation_squares / relative.count);
  result.relative_rotation_deg = std::sqrt(relative.rotation_squares / relative.count) / kDegree;
  return result;
}

std::vector<StampedCameraPose> between(const std::vector<StampedCameraPose>& poses,
                                       std::int64_t begin_ns, std::int64_t end_ns) {
  std::vector<StampedCameraPose> result;
  for (const StampedCameraPose& pose : poses) {
    if (pose.stamp_ns >= begin_ns && pose.stamp_ns < end_ns) result.push_back(pose);
  }
  return result;
}

std::vector<StampedCameraPose> alignedTo(const std::vector<StampedCameraPose>& reference,
                                         const std::vector<StampedCameraPose>& estimate) {
  std::vector<StampedCameraPose> result;
  for (const Pairs& pairs : pairsOf(estimate, reference)) {
    const Similarity similarity = alignment(pairs);
    for (const Pair& pair : pairs) {
      result.push_back(pair.estimate);
      result.back().world_from_camera = similarity * pair.estimate.world_from_camera;
    }
  }
  std::sort(result.begin(), result.end(),
            [](const StampedCameraPose& a, const StampedCameraPose& b) {
              return a.stamp_ns < b.stamp_ns;
            });
  return result;
}

}  // namespace camera_self_calibration
