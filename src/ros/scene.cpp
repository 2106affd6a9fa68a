#include "camera_self_calibration/ros/scene.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/plotting/convergence_chart.h"

namespace camera_self_calibration {
namespace {

constexpr std::size_t kMaxKeyframes = 2000;
// The newest keyframes are all kept when the others are thinned out.
constexpr std::int64_t kNewest = 200;
constexpr std::size_t kMaxLandmarks = 6000;
// Landmarks further away than this many times the median are too uncertain to show.
constexpr double kFar = 8.0;
constexpr int kMinSightings = 4;

Eigen::Vector3d rayOf(const Landmark& landmark, const Camera& camera) {
  if (!landmark.anchored) return landmark.bearing;
  return camera.unproject(landmark.reference_pixel).value_or(Eigen::Vector3d::Zero());
}

struct Sightings {
  int count = 0;
  int last_keyframe = -1;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< In the last keyframe.
};

/// Of each landmark.
std::vector<Sightings> countSightings(const Segment& segment) {
  std::vector<Sightings> all(segment.landmarks.size());
  for (const Observation& observation : segment.observations) {
    Sightings& sightings = all[static_cast<std::size_t>(observation.landmark)];
    ++sightings.count;
    if (observation.keyframe <= sightings.last_keyframe) continue;
    sightings.last_keyframe = observation.keyframe;
    sightings.pixel = observation.pixel;
  }
  return all;
}

int brightnessAt(const ImageView& image, const Eigen::Vector2d& pixel) {
  const int x = std::clamp(static_cast<int>(std::lround(pixel.x())), 0, image.width - 1);
  const int y = std::clamp(static_cast<int>(std::lround(pixel.y())), 0, image.height - 1);
  return image.data[static_cast<std::ptrdiff_t>(y) * image.stride + x];
}

}  // namespace

void Scene::add(std::uint64_t map_id, const Segment& newest) {
  map_id_ = map_id;
  auto& keyframes = maps_.enter(map_id).keyframes;
  for (const Keyframe& keyframe : newest.keyframes) keyframes[keyframe.id] = keyframe;
  if (keyframes.size() > kMaxKeyframes) thinOut(&keyframes);
  measure(newest);
}

void Scene::add(const FrameResult& frame) {
  if (frame.moved) {
    maps_.join(frame.moved->from, frame.moved->to, [&](Content left, Content* into) {
      merge(frame.moved->to_from_from, std::move(left), into);
    });
    if (map_id_ == frame.moved->from) map_id_ = frame.moved->to;
  }
  if (frame.map_id == map_id_ && frame.state == TrackingState::kTracking) {
    maps_.present().world_from_camera = frame.world_from_camera;
  }
}

void Scene::add(const Event& event) {
  auto& events = maps_.present().events;
  events.push_back({event, worldFromCamera().translation});
  if (events.size() > kMaxEvents) events.pop_front();
}

// What both hold is newest in the map that goes on.
void Scene::merge(const Similarity3& into_from_left, Content left, Content* into) {
  for (auto& [id, keyframe] : left.keyframes) {
    keyframe.world_from_camera = into_from_left * keyframe.world_from_camera;
    into->keyframes.emplace(id, keyframe);
  }
  if (into->keyframes.size() > kMaxKeyframes) thinOut(&into->keyframes);
  for (auto& [id, point] : left.landmarks) {
    point.position = into_from_left * point.position;
    into->landmarks.emplace(id, point);
  }
  for (auto& [sequence, positions] : left.segment_positions) {
    if (positions.size() <= into->segment_positions[sequence].size()) continue;
    for (Eigen::Vector3d& position : positions) position = into_from_left * position;
    into->segment_positions[sequence] = positions;
  }
  for (Occurrence& occurrence : left.events) {
    occurrence.position = into_from_left * occurrence.position;
    into->events.push_back(occurrence);
  }
  while (into->events.size() > kMaxEvents) into->events.pop_front();
  into->world_from_camera = into_from_left * left.world_from_camera;
}

// A thinned trajectory would leave little of a segment, so its longest list of positions is kept.
void Scene::add(const CalibrationReport& report) {
  report_ = report;
  auto& known_positions = maps_.present().segment_positions;
  std::map<std::int64_t, std::vector<Eigen::Vector3d>> kept;
  for (const SegmentReport& segment : report.queue.segments) {
    std::vector<Eigen::Vector3d> positions;
    for (const auto& [id, keyframe] : keyframes()) {
      if (keyframe.stamp_ns < segment.begin_ns || keyframe.stamp_ns > segment.end_ns) continue;
      positions.push_back(keyframe.world_from_camera.translation);
    }
    const auto known = known_positions.find(segment.sequence);
    const bool known_is_longer =
        known != known_positions.end() && known->second.size() > positions.size();
    kept[segment.sequence] = known_is_longer ? known->second : positions;
  }
  known_positions.swap(kept);
}

std::vector<Scene::QueueSegment> Scene::queue() const {
  const auto& known_positions = maps_.present().segment_positions;
  std::vector<QueueSegment> all;
  for (const SegmentReport& segment : report_.queue.segments) {
    const auto found = known_positions.find(segment.sequence);
    if (found == known_positions.end() || found->second.size() < 2) continue;
    all.push_back({found->second, scoreShare(segment, report_.queue)});
  }
  return all;
}

void Scene::measure(const Segment& segment) {
  std::vector<double> depths;
  for (const Landmark& landmark : segment.landmarks) {
    if (landmark.inverse_depth > 0.0) depths.push_back(1.0 / landmark.inverse_depth);
  }
  unit_ = median(std::move(depths), unit_);
}

void Scene::addLandmarks(const Camera& camera, const Segment& newest, const ImageView* image) {
  const std::vector<Sightings> sightings = countSightings(newest);
  auto& landmarks = maps_.present().landmarks;
  for (std::size_t i = 0; i < newest.landmarks.size(); ++i) {
    const Landmark& landmark = newest.landmarks[i];
    const double rho = landmark.inverse_depth;
    if (sightings[i].count < kMinSightings || !(rho * kFar * unit_ > 1.0)) continue;
    const Keyframe& reference = newest.keyframes[static_cast<std::size_t>(landmark.reference)];
    Point& point = landmarks[landmark.track_id];
    point.position = reference.world_from_camera * (rayOf(landmark, camera) / rho);
    const bool in_image =
        sightings[i].last_keyframe + 1 == static_cast<int>(newest.keyframes.size());
    if (image != nullptr && in_image) point.brightness = brightnessAt(*image, sightings[i].pixel);
  }
  while (landmarks.size() > kMaxLandmarks) landmarks.erase(landmarks.begin());
}

void Scene::thinOut(std::map<std::int64_t, Keyframe>* keyframes) {
  const std::int64_t newest = keyframes->rbegin()->first;
  bool drop = false;
  for (auto i = keyframes->begin(); i != keyframes->end() && i->first < newest - kNewest;) {
    i = drop ? keyframes->erase(i) : std::next(i);
    drop = !drop;
  }
}

std::vector<Eigen::Vector3d> fieldOfView(const Camera& camera, int per_side) {
  const Eigen::Vector2d high(camera.width() - 1, camera.height() - 1);
  const std::vector<Eigen::Vector2d> corners = {
      {0.0, 0.0}, {high.x(), 0.0}, high, {0.0, high.y()}, {0.0, 0.0}};
  const Eigen::Vector2d centre = camera.parameters().segment<2>(2);
  constexpr int kSteps = 50;
  std::vector<Eigen::Vector3d> rays;
  for (std::size_t side = 0; side < 4; ++side) {
    for (int i = 0; i < per_side; ++i) {
      const Eigen::Vector2d border =
          corners[side] + (corners[side + 1] - corners[side]) * i / per_side;
      for (int step = 0; step < kSteps; ++step) {
        const Eigen::Vector2d pixel = border + (centre - border) * step / kSteps;
        const auto ray = camera.unproject(pixel);
        if (!ray) continue;
        rays.push_back(*ray);
        break;
      }
    }
  }
  return rays;
}

}  // namespace camera_self_calibration
