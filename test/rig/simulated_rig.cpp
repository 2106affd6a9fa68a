#include "rig/simulated_rig.h"

#include <cmath>
#include <memory>

#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/feature_tracks.h"
#include "camera_self_calibration/simulation/mount.h"
#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/room.h"

namespace camera_self_calibration {
namespace {

// Each camera's map has its own frame and scale.
Rigid3 inOwnMap(const Rigid3& world_from_camera, int camera, const SimulatedRigOptions& options,
                Random* random) {
  const Rigid3 map_from_world(expSo3({0.3 * camera, -0.2, 0.1 * camera}), {1.0, 0.5 * camera, 0.0});
  Rigid3 pose = map_from_world * world_from_camera;
  pose.translation += options.position_sigma_m * random->normal3();
  pose.rotation =
      (pose.rotation * expSo3(options.rotation_sigma_rad * random->normal3())).normalized();
  pose.translation *= 0.5 + 0.3 * camera;
  return pose;
}

Trajectory ofCamera(const Trajectory& rig, int camera, const SimulatedRigOptions& options) {
  Mount mount;
  mount.body_from_camera = options.rig.rig_from_camera[camera];
  if (camera == options.changed) {
    mount.bump_at_s = options.change_at_s;
    mount.bump = options.bump;
  }
  return mounted(rig, mount);
}

Lens lensOf(int camera, const SimulatedRigOptions& options) {
  Lens lens{options.rig.cameras[camera], std::nullopt, 1.0};
  if (camera == options.changed) {
    lens.zoom_at_s = options.change_at_s;
    lens.zoom = options.zoom;
  }
  return lens;
}

FeatureTracksOptions tracksOf(const SimulatedRigOptions& options, int camera) {
  FeatureTracksOptions tracks;
  tracks.seed = mixSeed(options.seed, 10 + static_cast<std::uint64_t>(camera));
  tracks.max_features = options.max_features;
  tracks.pixel_sigma = options.pixel_sigma;
  tracks.outlier_share = options.outlier_share;
  return tracks;
}

}  // namespace

Camera rigLens(double focal, double k1) {
  Intrinsics p(8);
  p << focal, 1.002 * focal, 322.0, 236.0, k1, 0.01, 0.0, 0.0;
  return Camera(CameraModel::kEquidistant, 640, 480, p);
}

Rig stereoRig() {
  return {{rigLens(400.0, 0.02), rigLens(420.0, -0.01)},
          {Rigid3(), Rigid3(expSo3({0.02, -0.03, 0.05}), {0.12, 0.01, -0.005})}};
}

// The rig's frame is that of its first camera, moved or not.
Rig afterBump(const SimulatedRigOptions& options) {
  Rig rig = options.rig;
  rig.rig_from_camera[options.changed] = rig.rig_from_camera[options.changed] * options.bump;
  const Rigid3 first = rig.rig_from_camera.front();
  for (Rigid3& pose : rig.rig_from_camera) pose = first.inverse() * pose;
  return rig;
}

SimulatedRig simulateRig(const SimulatedRigOptions& options) {
  SimulatedRig result;
  result.truth = options.rig;
  RoomOptions room;
  room.seed = options.seed;
  const World world = makeRoom(room);
  SyntheticMotionOptions motion;
  motion.kind = options.motion;
  motion.seed = options.seed;
  motion.duration_s = options.interval_s * (options.frames + 1);
  const Trajectory way = syntheticMotion(motion);
  auto tracks = std::make_shared<std::vector<FeatureTracks>>();
  for (int c = 0; c < options.rig.size(); ++c) {
    tracks->emplace_back(world, lensOf(c, options), ofCamera(way, c, options),
                         tracksOf(options, c));
  }
  Random random(mixSeed(options.seed, 4));
  // Points outlive the tracks that show them.
  auto points =
      std::make_shared<std::vector<std::map<std::int64_t, Eigen::Vector3d>>>(tracks->size());
  for (int f = 0; f < options.frames; ++f) {
    RigFrame frame;
    frame.stamp_ns = std::llround(1e9 * options.interval_s * f);
    for (std::size_t c = 0; c < tracks->size(); ++c) {
      FeatureTracks& own = (*tracks)[c];
      RigView view;
      view.tracks = own.track(frame.stamp_ns).tracks;
      for (const Track& track : own.detect()) {
        view.tracks.push_back(track);
        (*points)[c][track.id] = *own.point(track.id);
      }
      view.world_from_camera =
          inOwnMap(own.worldFromCamera(frame.stamp_ns), static_cast<int>(c), options, &random);
      frame.views.push_back(view);
    }
    result.frames.push_back(frame);
  }
  auto noise = std::make_shared<Random>(mixSeed(options.seed, 5));
  const double sigma = options.pixel_sigma;
  result.across = [tracks, points, noise, sigma](const RigFrame& frame, int from, int to,
                                                 const std::vector<ExpectedAcross>& expected) {
    std::vector<SeenAcross> seen;
    for (const ExpectedAcross& feature : expected) {
      const auto pixel =
          (*tracks)[to].project((*points)[from].at(feature.track_id), toSeconds(frame.stamp_ns));
      // As a registration, which finds what is near.
      if (!pixel || (*pixel - feature.there.pixel).norm() > 15.0) continue;
      seen.push_back({0, from, feature.track_id, to, *pixel + sigma * noise->normal2(), sigma});
    }
    return seen;
  };
  return result;
}

double angleBetween(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return logSo3(a.conjugate() * b).norm();
}

double angleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace camera_self_calibration
