// Two rendered images of a room with a zoom between them.
#include "camera_self_calibration/tracking/zoom_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "camera_self_calibration/simulation/simulated_sequence.h"
#include "camera_self_calibration/tracking/tracker.h"

namespace camera_self_calibration {
namespace {

struct Followed {
  int before = 0;
  int after = 0;
  int right = 0;  // within a pixel of where the zoomed lens sees the point
};

Followed followAcross(double zoom) {
  SequenceOptions options;
  Intrinsics parameters(5);
  parameters << 310.0, 310.0, 319.5, 239.5, 0.9;
  options.lens.camera = Camera(CameraModel::kFov, 640, 480, parameters);
  options.lens.zoom = zoom;
  options.lens.zoom_at_s = 0.05;
  options.motion.speed = 0.3;
  options.duration_s = 0.15;
  const SimulatedSequence sequence(options);
  Tracker tracker{TrackerOptions()};
  const SimulatedFrame first = sequence.frame(0);
  tracker.track(first.view());
  Followed followed;
  followed.before = static_cast<int>(tracker.detect().size());
  const SimulatedFrame second = sequence.frame(1);
  for (const Track& track : tracker.track(second.view()).tracks) {
    ++followed.after;
    const auto ray = first.camera.unproject(track.reference_pixel);
    const Eigen::Vector3d direction = first.world_from_camera.rotation * *ray;
    const auto hit = sequence.world().castRay(first.world_from_camera.translation, direction);
    if (!hit) continue;
    const Eigen::Vector3d point = first.world_from_camera.translation + hit->distance * direction;
    Eigen::Vector2d pixel;
    if (!second.camera.project(second.world_from_camera.inverse() * point, &pixel)) continue;
    followed.right += (pixel - track.pixel).norm() < 1.0;
  }
  return followed;
}

TEST(ZoomSearch, BridgesAZoomWithinOneImage) {
  for (const double zoom : {1.15, 1.3, 0.8}) {
    const Followed followed = followAcross(zoom);
    std::cout << "zoom " << zoom << ": " << followed.before << " features, " << followed.after
              << " followed, " << followed.right << " rightly\n";
    ASSERT_GT(followed.before, 60);
    // Of those that are still in the image, which are 1 / zoom^2 at most.
    const double visible = std::min(1.0, 1.0 / (zoom * zoom)) * followed.before;
    EXPECT_GT(followed.right, 0.4 * visible) << zoom;
    EXPECT_GT(followed.right, 0.9 * followed.after) << zoom;
  }
}

}  // namespace
}  // namespace camera_self_calibration
