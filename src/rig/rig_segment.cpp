#include "camera_self_calibration/rig/rig_segment.h"

#include <algorithm>
#include <map>

#include "camera_self_calibration/map/inverse_depth.h"

namespace camera_self_calibration {
namespace {

// A track's sightings: views and measurements.
using Sightings = std::vector<std::pair<int, const Track*>>;

std::map<std::int64_t, Sightings> sightingsOf(const std::vector<RigFrame>& frames, int camera) {
  const RigViews views{static_cast<int>(frames.front().views.size())};
  std::map<std::int64_t, Sightings> by_track;
  for (int f = 0; f < static_cast<int>(frames.size()); ++f) {
    for (const Track& track : frames[f].views[camera].tracks) {
      by_track[track.id].emplace_back(views.index(f, camera), &track);
    }
  }
  return by_track;
}

double triangulated(const Segment& segment, const Landmark& landmark, const Sightings& sightings,
                    const Camera& camera) {
  const Rigid3& reference = segment.keyframes[landmark.reference].world_from_camera;
  RayIntersection rays;
  for (const auto& [view, track] : sightings) {
    const auto ray = camera.unproject(track->pixel);
    if (view == landmark.reference || !ray) continue;
    const Rigid3& pose = segment.keyframes[view].world_from_camera;
    const Eigen::Matrix3d from_world = pose.rotation.conjugate().toRotationMatrix();
    rays.add(*ray, from_world * (reference.rotation * landmark.bearing),
             from_world * (reference.translation - pose.translation));
  }
  return rays.inverseDepth();
}

void addLandmark(std::int64_t track_id, const Sightings& sightings, const Camera& camera,
                 Segment* segment) {
  const auto ray = camera.unproject(sightings.front().second->pixel);
  if (!ray) return;
  Landmark landmark;
  landmark.track_id = track_id;
  landmark.reference = sightings.front().first;
  landmark.anchored = false;
  landmark.reference_pixel = sightings.front().second->pixel;
  landmark.bearing = *ray;
  landmark.inverse_depth = triangulated(*segment, landmark, sightings, camera);
  const auto index = static_cast<int>(segment->landmarks.size());
  segment->landmarks.push_back(landmark);
  for (const auto& [view, track] : sightings) {
    segment->observations.push_back({index, view, track->pixel, track->sigma});
  }
}

void groupByLandmark(Segment* segment) {
  std::stable_sort(
      segment->observations.begin(), segment->observations.end(),
      [](const Observation& a, const Observation& b) { return a.landmark < b.landmark; });
}

}  // namespace

void placeViews(const Rig& rig, RigSegment* segment) {
  const RigViews views{rig.size()};
  for (Segment& tracks : segment->tracks) {
    tracks.held_lenses = rig.cameras;
    tracks.keyframes.resize(static_cast<std::size_t>(segment->frames() * rig.size()));
    for (int v = 0; v < static_cast<int>(tracks.keyframes.size()); ++v) {
      Keyframe& keyframe = tracks.keyframes[v];
      keyframe.id = v;
      keyframe.stamp_ns = segment->stamps_ns[views.frame(v)];
      keyframe.lens = views.camera(v);
      keyframe.world_from_camera =
          segment->world_from_rig[views.frame(v)] * rig.rig_from_camera[views.camera(v)];
    }
  }
}

RigSegment makeRigSegment(const std::vector<RigFrame>& frames, const Rig& rig, int min_views) {
  RigSegment segment;
  for (const RigFrame& frame : frames) {
    segment.stamps_ns.push_back(frame.stamp_ns);
    segment.world_from_rig.push_back(frame.views.front().world_from_camera.value_or(Rigid3()));
  }
  segment.tracks.resize(static_cast<std::size_t>(rig.size()));
  if (frames.empty()) return segment;
  placeViews(rig, &segment);
  for (int c = 0; c < rig.size(); ++c) {
    for (const auto& [id, sightings] : sightingsOf(frames, c)) {
      if (static_cast<int>(sightings.size()) < min_views) continue;
      addLandmark(id, sightings, rig.cameras[c], &segment.tracks[c]);
    }
  }
  return segment;
}

void addSeenAcross(const std::vector<SeenAcross>& seen, RigSegment* segment) {
  const RigViews views{static_cast<int>(segment->tracks.size())};
  std::vector<std::map<std::int64_t, int>> landmarks(segment->tracks.size());
  for (std::size_t c = 0; c < landmarks.size(); ++c) {
    for (std::size_t l = 0; l < segment->tracks[c].landmarks.size(); ++l) {
      landmarks[c][segment->tracks[c].landmarks[l].track_id] = static_cast<int>(l);
    }
  }
  for (const SeenAcross& one : seen) {
    const auto found = landmarks[one.from].find(one.track_id);
    if (found == landmarks[one.from].end()) continue;
    segment->tracks[one.from].observations.push_back(
        {found->second, views.index(one.frame, one.to), one.pixel, one.sigma});
  }
  for (Segment& tracks : segment->tracks) groupByLandmark(&tracks);
}

void removeSeenAcross(RigSegment* segment) {
  const RigViews views{static_cast<int>(segment->tracks.size())};
  for (int c = 0; c < views.cameras; ++c) {
    auto& observations = segment->tracks[c].observations;
    observations.erase(
        std::remove_if(observations.begin(), observations.end(),
                       [&](const Observation& o) { return views.camera(o.keyframe) != c; }),
        observations.end());
  }
}

int sharedLandmarks(const RigSegment& segment, int camera) {
  const RigViews views{static_cast<int>(segment.tracks.size())};
  const Segment& tracks = segment.tracks[camera];
  std::vector<char> shared(tracks.landmarks.size(), 0);
  for (const Observation& seen : tracks.observations) {
    if (views.camera(seen.keyframe) != camera) shared[seen.landmark] = 1;
  }
  return static_cast<int>(std::count(shared.begin(), shared.end(), 1));
}

void scaleSegment(double factor, RigSegment* segment) {
  for (Rigid3& pose : segment->world_from_rig) pose.translation *= factor;
  for (Segment& tracks : segment->tracks) {
    for (Keyframe& keyframe : tracks.keyframes) keyframe.world_from_camera.translation *= factor;
    for (Landmark& landmark : tracks.landmarks) landmark.inverse_depth /= factor;
  }
}

}  // namespace camera_self_calibration
