#include "camera_self_calibration/localization/place_recognition.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/estimation/pose_solver.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/map/inverse_depth.h"

namespace camera_self_calibration {
namespace {

constexpr std::size_t kFewest = 8;          // that a pose is computed from
constexpr double kMinFound = 0.25;          // of what a place showed and is in view
constexpr double kTolerance = 3.0 / 640.0;  // [longer sides] A corner is not found twice at a spot.
constexpr double kReach = 10.0 / 640.0;     // [longer sides] Of a prediction.
constexpr double kBorder = 24.0 / 640.0;    // [longer sides] Where few corners are found.
constexpr double kMaxPoseSigma = 0.05;      // [median depths]
constexpr int kMaxSamples = 150;
constexpr double kMissed = 1e-3;  // probability that no sample was free of wrong matches
constexpr int kSampleSize = 4;
// A pose has six degrees of freedom: it can be made to agree with three features, whatever these
// are.
constexpr int kFitted = 3;
// Wrong recognitions, where the images show other places than those that are known: those that one
// is willing to bear, and the poses that are put to the test at five keyframes a second.
constexpr double kFalseAlarmsPerHour = 1e-3;
constexpr double kPosesPerHour = 3.0 * 5.0 * 3600.0;

// The point of a map that a feature looks most like.
struct Nearest {
  int bits = kMaxDifferingBits + 1;
  const PlacePoint* point = nullptr;
};

// Finds the features near a pixel.
class FeaturesByRow {
 public:
  explicit FeaturesByRow(const std::vector<Appearance>& features) {
    for (std::size_t i = 0; i < features.size(); ++i) rows_.emplace_back(features[i].pixel.y(), i);
    std::sort(rows_.begin(), rows_.end());
  }

  // Calls visit(index) for each feature whose row is that near, and no other.
  template <typename Visit>
  void visitNear(double row, double reach, const Visit& visit) const {
    const auto first = std::make_pair(row - reach, std::size_t{0});
    for (auto next = std::lower_bound(rows_.begin(), rows_.end(), first);
         next != rows_.end() && next->first <= row + reach; ++next) {
      visit(next->second);
    }
  }

 private:
  std::vector<std::pair<double, std::size_t>> rows_;
};

std::optional<Eigen::Vector2d> seenFrom(const Rigid3& pose, const PlacePoint& point,
                                        const Camera& camera) {
  Eigen::Vector2d pixel;
  const Eigen::Vector3d ray = pose.rotation.conjugate() * directionFrom(point, pose.translation);
  if (!point.known || !camera.project(ray, &pixel)) return std::nullopt;
  return pixel;
}

PointView viewOf(const SeenAgain& seen, double sigma) { return {seen.point, seen.pixel, sigma}; }

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
  const double limit = kTolerance * camera.longerSide();
  std::vector<SeenAgain> result;
  for (const SeenAgain& seen : matches) {
    const auto pixel = seenFrom(pose, seen.point, camera);
    if (pixel && (*pixel - seen.pixel).norm() < limit) result.push_back(seen);
  }
  return result;
}

PoseEstimate poseFrom(const std::vector<SeenAgain>& seen, const Rigid3& guess,
                      const Camera& camera) {
  std::vector<PointView> views;
  const double sigma = kTolerance / 3.0 * camera.longerSide();
  for (const SeenAgain& one : seen) views.push_back(viewOf(one, sigma));
  return solvePose(camera, views, guess, kHuberThreshold, 15);
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

// Whether so many matches agree with a pose that fewer than `alarms` of `tests` wrong poses would
// do as well (a contrario: Moisan & Stival 2004). `fitted` of them agree with any pose made from
// them.
bool agreeBeyondChance(double tests, double alarms, std::size_t seen, std::size_t matches,
                       int fitted, double by_chance) {
  return falseAlarms(tests, static_cast<int>(seen) - fitted, static_cast<int>(matches) - fitted,
                     by_chance) < alarms;
}

// Whether enough is found again of what one place showed. A wall that merely repeats some of
// another one's picture leaves most of its points unexplained.
bool showsAPlace(const RecognizedPlace& recognized, const std::vector<Place>& places,
                 const Camera& camera) {
  std::set<std::int64_t> found_ids;
  for (const SeenAgain& seen : recognized.seen) found_ids.insert(seen.point.track_id);
  return std::any_of(places.begin(), places.end(), [&](const Place& place) {
    if (place.map_id != recognized.map_id) return false;
    std::size_t in_view = 0, found = 0;
    for (const PlacePoint& point : place.points) {
      const auto pixel = seenFrom(recognized.old_from_camera, point, camera);
      if (!pixel || !camera.inImage(*pixel, kBorder * camera.longerSide())) continue;
      ++in_view;
      found += found_ids.count(point.track_id);
    }
    return found >= kFewest && found >= kMinFound * static_cast<double>(in_view);
  });
}

double typicalInverseDepthOf(const RecognizedPlace& place) {
  std::vector<WorldPoint> points;
  for (const SeenAgain& seen : place.seen) points.push_back(seen.point);
  return typicalInverseDepthFrom(place.old_from_camera.translation, points);
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

std::vector<SeenAgain> matchNear(const std::vector<Place>& places, std::uint64_t map_id,
                                 const Rigid3& old_from_camera,
                                 const std::vector<Appearance>& appearances, const Camera& camera) {
  std::vector<Nearest> nearest(appearances.size());
  std::map<std::int64_t, int> bits_of_point;  // by track id: the least with any feature
  const double reach = kReach * camera.longerSide();
  const FeaturesByRow features(appearances);
  for (const Place& place : places) {
    if (place.map_id != map_id) continue;
    for (std::size_t p = 0; p < place.points.size(); ++p) {
      const PlacePoint& point = place.points[p];
      const auto pixel = seenFrom(old_from_camera, point, camera);
      if (!pixel) continue;
      features.visitNear(pixel->y(), reach, [&](std::size_t i) {
        if ((appearances[i].pixel - *pixel).squaredNorm() > reach * reach) return;
        const int bits = differingBits(appearances[i].descriptor, place.descriptors[p]);
        int& least = bits_of_point.try_emplace(point.track_id, kMaxDifferingBits + 1).first->second;
        least = std::min(least, bits);
        if (bits < nearest[i].bits) nearest[i] = {bits, &point};
      });
    }
  }
  std::vector<SeenAgain> matches;
  for (std::size_t i = 0; i < appearances.size(); ++i) {
    const PlacePoint* point = nearest[i].point;
    if (point == nullptr || nearest[i].bits > bits_of_point.at(point->track_id)) continue;
    matches.push_back({appearances[i].track_id, *point, appearances[i].pixel});
  }
  return matches;
}

std::optional<Rigid3> poseAtPlace(const Place& place, const std::vector<SeenAgain>& matches,
                                  const Camera& camera) {
  if (matches.size() < kFewest) return std::nullopt;
  const std::vector<SeenAgain> seen = largestAgreement(place, matches, camera);
  if (seen.size() < kFewest) return std::nullopt;
  // Where nothing belongs together a match is anywhere in the image. Less than one such pose of all
  // that were tried is good enough for a guess that confirmPose looks into.
  const double reach = kTolerance * camera.longerSide();
  const double by_chance = M_PI * reach * reach / (camera.width() * camera.height());
  if (!agreeBeyondChance(kMaxSamples, 1.0, seen.size(), matches.size(), kSampleSize, by_chance)) {
    return std::nullopt;
  }
  const PoseEstimate pose = poseFrom(seen, turnedTo(place, seen, camera), camera);
  return pose.usable ? std::make_optional(pose.world_from_camera) : std::nullopt;
}

std::optional<RecognizedPlace> confirmPose(const std::vector<Place>& places, std::uint64_t map_id,
                                           const Rigid3& old_from_camera,
                                           const std::vector<Appearance>& appearances,
                                           const Camera& camera) {
  RecognizedPlace result;
  result.map_id = map_id;
  result.old_from_camera = old_from_camera;
  std::vector<SeenAgain> matches;
  PoseEstimate pose;
  for (int pass = 0; pass < 2; ++pass) {
    matches = matchNear(places, map_id, result.old_from_camera, appearances, camera);
    result.seen = agreeing(matches, result.old_from_camera, camera);
    if (result.seen.size() < kFewest) result.seen = matches;
    if (result.seen.size() < kFewest) return std::nullopt;
    pose = poseFrom(result.seen, result.old_from_camera, camera);
    if (!pose.usable) return std::nullopt;
    result.old_from_camera = pose.world_from_camera;
    result.seen = agreeing(matches, result.old_from_camera, camera);
  }
  // At a wrong pose, what is near enough to be matched is anywhere in its reach.
  constexpr double kByChance = kTolerance * kTolerance / (kReach * kReach);
  if (!agreeBeyondChance(kPosesPerHour, kFalseAlarmsPerHour, result.seen.size(), matches.size(),
                         kFitted, kByChance)) {
    return std::nullopt;
  }
  if (!showsAPlace(result, places, camera)) return std::nullopt;
  const double sigma = std::sqrt(pose.covariance.topLeftCorner<3, 3>().trace());
  if (!(sigma * typicalInverseDepthOf(result) < kMaxPoseSigma)) return std::nullopt;
  return result;
}

}  // namespace camera_self_calibration
