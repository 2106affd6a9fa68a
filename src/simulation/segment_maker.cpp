#include "camera_self_calibration/simulation/segment_maker.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

constexpr int kWarmUpFrames = 2;  // before the segment, in which inherited tracks are detected

struct View {
  int keyframe;
  Eigen::Vector2d pixel;
  double sigma;
  bool outlier;
};

// What is known of one track while the segment is being recorded.
struct Recorded {
  Track first;
  int born = -1;  // keyframe of its detection; -1: before the segment
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // in the world [m]
  std::vector<View> views;
};

Trajectory trajectoryOf(const SegmentOptions& options, const World& world, std::uint64_t seed) {
  if (options.trajectory) return *options.trajectory;
  SyntheticMotionOptions motion;
  motion.kind = options.motion;
  motion.speed = options.motion_speed;
  motion.seed = mixSeed(seed, 1);
  motion.box = world.free_space;
  motion.duration_s = options.start_s + (options.keyframes + 1) * options.keyframe_interval_s;
  return syntheticMotion(motion);
}

// Stamps of the warm-up frames and of the keyframes: as a keyframe rule would choose them.
std::vector<std::int64_t> stampsOf(const SegmentOptions& options, const Trajectory& trajectory) {
  const double largest_turn = options.keyframe_rotation_deg * kDegree;
  std::vector<double> times;
  for (int k = -kWarmUpFrames; k <= 0; ++k) {
    times.push_back(options.start_s + k * options.keyframe_interval_s);
  }
  for (int k = 1; k < options.keyframes; ++k) {
    const Rigid3 last = trajectory.worldFromCamera(times.back());
    double step = 0.0;
    double turn = 0.0;
    while (step < options.keyframe_interval_s && turn < largest_turn) {
      step = std::min(step + 0.01, options.keyframe_interval_s);
      const Rigid3 next = trajectory.worldFromCamera(times.back() + step);
      turn = logSo3(last.rotation.conjugate() * next.rotation).norm();
    }
    times.push_back(times.back() + step);
  }
  std::vector<std::int64_t> stamps;
  stamps.reserve(times.size());
  for (const double time : times) {
    stamps.push_back(options.tracks.start_stamp_ns +
                     static_cast<std::int64_t>(std::llround(1e9 * time)));
  }
  return stamps;
}

Keyframe keyframeAt(const FeatureTracks& tracks, std::int64_t stamp_ns, int index) {
  Keyframe keyframe;
  keyframe.id = index;
  keyframe.stamp_ns = stamp_ns;
  keyframe.world_from_camera = tracks.worldFromCamera(stamp_ns);
  keyframe.velocity = tracks.trajectory().velocity(tracks.timeOf(stamp_ns));
  return keyframe;
}

void detect(int keyframe, FeatureTracks* tracks, std::map<std::int64_t, Recorded>* recorded) {
  for (const Track& track : tracks->detect()) {
    (*recorded)[track.id] = Recorded{track, keyframe, *tracks->point(track.id), {}};
  }
}

// Runs the tracks over warm-up and segment; the map is ordered by track id.
std::map<std::int64_t, Recorded> record(const SegmentOptions& options, FeatureTracks* tracks,
                                        std::vector<Keyframe>* keyframes) {
  std::map<std::int64_t, Recorded> recorded;
  const std::vector<std::int64_t> stamps = stampsOf(options, tracks->trajectory());
  for (int k = -kWarmUpFrames; k < options.keyframes; ++k) {
    const std::int64_t stamp = stamps[static_cast<std::size_t>(k + kWarmUpFrames)];
    for (const Track& track : tracks->track(stamp).tracks) {
      if (k < 0) continue;
      recorded[track.id].views.push_back(
          {k, track.pixel, track.sigma, tracks->isOutlier(track.id)});
    }
    if (k >= 0) {
      keyframes->push_back(keyframeAt(*tracks, stamp, k));
    }
    const bool inside = k >= 0;
    const bool wanted = inside ? options.origin != LandmarkOrigin::kInherited
                               : options.origin != LandmarkOrigin::kAnchored;
    if (wanted) detect(inside ? k : -1, tracks, &recorded);
  }
  return recorded;
}

void append(const Recorded& track, SimulatedSegment* out) {
  Segment& segment = out->segment;
  Landmark landmark;
  landmark.track_id = track.first.id;
  landmark.anchored = track.born >= 0;
  landmark.reference = landmark.anchored ? track.born : track.views.front().keyframe;
  landmark.reference_pixel =
      landmark.anchored ? track.first.reference_pixel : track.views.front().pixel;
  const Rigid3& world_from_camera =
      segment.keyframes[static_cast<std::size_t>(landmark.reference)].world_from_camera;
  const Eigen::Vector3d in_reference = world_from_camera.inverse() * track.point;
  landmark.bearing = in_reference.normalized();
  landmark.inverse_depth = 1.0 / in_reference.norm();
  const int index = static_cast<int>(segment.landmarks.size());
  segment.landmarks.push_back(landmark);
  out->points.push_back(track.point);
  for (const View& view : track.views) {
    segment.observations.push_back({index, view.keyframe, view.pixel, view.sigma});
    out->outliers.push_back(view.outlier);
  }
}

}  // namespace

std::vector<std::string> SegmentOptions::problems() const {
  std::vector<std::string> found = tracks.problems();
  for (const std::string& problem : room.problems()) found.push_back(problem);
  if (keyframes < 2) found.push_back("a segment needs at least 2 keyframes");
  if (min_views < 2) found.push_back("min_views must be at least 2");
  if (!(keyframe_interval_s > 0.0)) found.push_back("keyframe_interval_s must be positive");
  if (!(keyframe_rotation_deg > 0.0)) found.push_back("keyframe_rotation_deg must be positive");
  if (!(start_s >= kWarmUpFrames * keyframe_interval_s)) {
    found.push_back("start_s must be at least two keyframe intervals");
  }
  return found;
}

SimulatedSegment makeSegment(const SegmentOptions& options, std::uint64_t seed) {
  std::string message;
  for (const std::string& problem : options.problems()) message += problem + "; ";
  if (!message.empty()) throw std::invalid_argument("simulated segment: " + message);
  const World world = makeRoom(options.room);
  FeatureTracksOptions track_options = options.tracks;
  track_options.seed = mixSeed(seed, 2);
  const Trajectory trajectory = trajectoryOf(options, world, seed);
  FeatureTracks tracks(world, Lens{options.camera, std::nullopt, 1.0}, trajectory, track_options);
  SimulatedSegment out;
  out.camera = options.camera;
  out.segment.sequence = static_cast<std::int64_t>(seed);
  const auto recorded = record(options, &tracks, &out.segment.keyframes);
  for (const auto& [id, track] : recorded) {
    const int views = static_cast<int>(track.views.size()) + (track.born >= 0 ? 1 : 0);
    if (views >= options.min_views) append(track, &out);
  }
  return out;
}

Segment perturbed(const Segment& segment, const SegmentPerturbation& sigma, std::uint64_t seed) {
  Random random(mixSeed(seed, 3));
  Segment out = segment;
  for (std::size_t i = 1; i < out.keyframes.size(); ++i) {
    Rigid3& pose = out.keyframes[i].world_from_camera;
    pose.translation += sigma.translation_m * random.normal3();
    pose.rotation = (pose.rotation * expSo3(sigma.rotation_rad * random.normal3())).normalized();
  }
  for (Landmark& landmark : out.landmarks) {
    landmark.inverse_depth *= 1.0 + sigma.inverse_depth * random.normal();
    const Eigen::Vector3d turn = sigma.bearing_rad * random.normal3();
    if (!landmark.anchored) landmark.bearing = (expSo3(turn) * landmark.bearing).normalized();
  }
  return out;
}

}  // namespace camera_self_calibration
