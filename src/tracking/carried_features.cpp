#include "camera_self_calibration/tracking/carried_features.h"

#include <algorithm>
#include <bitset>
#include <utility>

#include "camera_self_calibration/camera/image_size.h"

namespace camera_self_calibration {
namespace {

// [longer sides of the image] The scene's motion is looked at in steps of this length: far beyond
// the errors of tracks, and short enough that most tracks live through several.
constexpr double kStep = 0.01;
constexpr double kStillShare = 0.01;  // Of the scene's motion.
constexpr double kSigmas = 3.0;
constexpr double kMemory = 100.0;  // Of the scene's motion that it took to find a feature out.
// Cells by which it is measured what covers most of the image.
constexpr int kColumns = 8;
constexpr int kRows = 6;

std::size_t cellOf(const Eigen::Vector2d& pixel, const TrackedFrame& frame) {
  const int x = std::clamp(static_cast<int>(pixel.x() * kColumns / frame.width), 0, kColumns - 1);
  const int y = std::clamp(static_cast<int>(pixel.y() * kRows / frame.height), 0, kRows - 1);
  return static_cast<std::size_t>(y * kColumns + x);
}

cv::Point2f toPoint(const Eigen::Vector2d& pixel) {
  return {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}

Eigen::Vector2d centreOf(const TrackedFrame& frame) {
  return 0.5 * Eigen::Vector2d(frame.width, frame.height);
}

}  // namespace

CarriedFeatures::History* CarriedFeatures::historyOf(const Track& track) {
  const auto found =
      std::lower_bound(histories_.begin(), histories_.end(), track.id,
                       [](const History& history, std::int64_t id) { return history.id < id; });
  return found != histories_.end() && found->id == track.id ? &*found : nullptr;
}

void CarriedFeatures::findSteps(const TrackedFrame& frame) {
  steps_.clear();
  for (const Track& track : frame.tracks) {
    History* history = historyOf(track);
    if (history == nullptr) continue;
    const double length = (track.pixel - history->begin).norm();
    steps_.push_back({&track, history, length >= kStep * longerSide(frame.width, frame.height)});
  }
}

void CarriedFeatures::beginStep(const TrackedFrame& frame) {
  next_.clear();
  for (const Track& track : frame.tracks) {
    const History* known = historyOf(track);
    next_.push_back(known != nullptr ? *known : History());
    next_.back().id = track.id;
    next_.back().begin = track.pixel;
  }
  std::sort(next_.begin(), next_.end(),
            [](const History& a, const History& b) { return a.id < b.id; });
  std::swap(histories_, next_);
}

// More than half of the cells that hold tracks hold one that moved.
bool CarriedFeatures::sceneMoved(const TrackedFrame& frame) const {
  std::bitset<kColumns * kRows> with_tracks;
  std::bitset<kColumns * kRows> with_motion;
  for (const Step& step : steps_) {
    const std::size_t cell = cellOf(step.track->pixel, frame);
    with_tracks.set(cell);
    if (step.moved) with_motion.set(cell);
  }
  return 2 * with_motion.count() > with_tracks.count();
}

// About the image's centre, from the tracks that moved.
LocalMotion::Motion CarriedFeatures::sceneMotion(const TrackedFrame& frame) {
  from_.clear();
  to_.clear();
  for (const Step& step : steps_) {
    if (!step.moved) continue;
    from_.push_back(toPoint(step.history->begin));
    to_.push_back(toPoint(step.track->pixel));
  }
  motion_.fit(
      from_, to_, [](std::size_t) { return true; }, longerSide(frame.width, frame.height));
  return motion_.at(centreOf(frame));
}

std::vector<std::int64_t> CarriedFeatures::add(const TrackedFrame& frame) {
  std::vector<std::int64_t> carried;
  findSteps(frame);
  if (!sceneMoved(frame)) {
    // Of the tracks that the step began with too few are left to go on with.
    if (2 * steps_.size() <= histories_.size()) beginStep(frame);
    return carried;
  }
  const LocalMotion::Motion motion = sceneMotion(frame);
  double length = 0.0;
  for (const Step& step : steps_) {
    const Track& track = *step.track;
    History& history = *step.history;
    const Eigen::Vector2d scene =
        motion.pixel + motion.linear * (history.begin - centreOf(frame)) - history.begin;
    length = std::max(length, scene.norm());
    history.scene += scene;
    history.scene_extent = std::max(history.scene_extent, history.scene.norm());
    history.own_extent = std::max(history.own_extent, (track.pixel - track.reference_pixel).norm());
    const double may_have_moved = history.own_extent + kSigmas * track.sigma;
    if (may_have_moved > kStillShare * history.scene_extent) continue;
    carried.push_back(track.id);
    places_.push_back({track.pixel, path_ + kMemory * history.scene_extent});
  }
  path_ += length;
  places_.erase(std::remove_if(places_.begin(), places_.end(),
                               [this](const Place& place) { return place.expires < path_; }),
                places_.end());
  beginStep(frame);
  return carried;
}

bool CarriedFeatures::near(const Eigen::Vector2d& pixel, double distance) const {
  return std::any_of(places_.begin(), places_.end(), [&](const Place& place) {
    return (place.pixel - pixel).squaredNorm() < distance * distance;
  });
}

void CarriedFeatures::clear() {
  histories_.clear();
  places_.clear();
  path_ = 0.0;
}

}  // namespace camera_self_calibration
