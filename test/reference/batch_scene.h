#pragma once

#include <cmath>
#include <random>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// A small scene with known truth: points 2 to 6 units in front of keyframes that translate and
/// turn about all axes. Every third landmark is inherited from before the segment.
class BatchScene {
 public:
  BatchScene(const Camera& camera, int keyframes, int landmarks, std::uint64_t seed)
      : camera_(camera), random_(seed) {
    for (int k = 0; k < keyframes; ++k) segment_.keyframes.push_back(keyframe(k, keyframes));
    while (static_cast<int>(segment_.landmarks.size()) < landmarks) addLandmark();
  }

  const Camera& camera() const { return camera_; }
  const Segment& truth() const { return segment_; }

  /// The truth with normal noise of `sigma` pixels on every observation.
  Segment noisy(double sigma, std::uint64_t seed) const {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0.0, sigma);
    Segment segment = segment_;
    for (Observation& seen : segment.observations) {
      seen.pixel += Eigen::Vector2d(normal(random), normal(random));
      seen.sigma = sigma;
    }
    return segment;
  }

  /// The landmark that is seen most often, to fix the scale.
  int scaleLandmark() const { return 0; }

 private:
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  Keyframe keyframe(int k, int count) {
    const double s = 2.0 * k / (count - 1.0) - 1.0;
    Keyframe frame;
    frame.id = k;
    frame.stamp_ns = 100000000LL * k;
    frame.world_from_camera.translation << s, 0.4 * std::sin(3.0 * s), 0.3 * s * s;
    frame.world_from_camera.rotation =
        expSo3({0.15 * std::cos(4.0 * s), -0.25 * s, 0.5 * std::sin(2.0 * s)});
    return frame;
  }

  void addLandmark() {
    const Eigen::Vector3d point(uniform(-3, 3), uniform(-2, 2), uniform(2, 6));
    const int index = static_cast<int>(segment_.landmarks.size());
    Landmark landmark;
    landmark.track_id = index;
    landmark.anchored = index % 3 != 2;
    landmark.reference = landmark.anchored ? index % 4 : 0;
    std::vector<Observation> seen;
    for (int k = 0; k < static_cast<int>(segment_.keyframes.size()); ++k) {
      const Eigen::Vector3d local = segment_.keyframes[k].world_from_camera.inverse() * point;
      Eigen::Vector2d pixel;
      const bool visible = camera_.project(local, &pixel) && camera_.inImage(pixel);
      if (k == landmark.reference) {
        if (!visible) return;
        landmark.reference_pixel = pixel;
        landmark.bearing = local.normalized();
        landmark.inverse_depth = 1.0 / local.norm();
        if (landmark.anchored) continue;
      }
      if (visible) seen.push_back({index, k, pixel, 1.0});
    }
    if (seen.size() < 4) return;
    segment_.landmarks.push_back(landmark);
    segment_.observations.insert(segment_.observations.end(), seen.begin(), seen.end());
  }

  Camera camera_;
  std::mt19937_64 random_;
  Segment segment_;
};

/// Disturbs everything but the first pose and the inverse depth of landmark `kept`.
inline void disturb(Segment* segment, int kept, double amount, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, amount);
  const auto vector = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  for (std::size_t k = 1; k < segment->keyframes.size(); ++k) {
    Rigid3& pose = segment->keyframes[k].world_from_camera;
    pose.rotation = pose.rotation * expSo3(vector());
    pose.translation += vector();
  }
  for (int i = 0; i < static_cast<int>(segment->landmarks.size()); ++i) {
    Landmark& landmark = segment->landmarks[i];
    if (i != kept) landmark.inverse_depth *= 1.0 + normal(random);
    if (!landmark.anchored) landmark.bearing = (landmark.bearing + vector()).normalized();
  }
}

}  // namespace camera_self_calibration
