#include "camera_self_calibration/map/rolling_shutter.h"

#include <optional>
#include <vector>

#include "camera_self_calibration/map/rigid_motion.h"
#include "camera_self_calibration/tracking/image_motion.h"

namespace camera_self_calibration {
namespace {

// In the image in which its track starts, a feature's velocity is that at the end of the parabola,
// whose variance is this many times that of central differences through as many images; the
// reference itself has no noise.
constexpr double kStartVariance = 8.5;

/// One pixel of a segment, and what it moves like.
struct Mover {
  Eigen::Vector2d* pixel = nullptr;
  RowShift* shift = nullptr;
  std::optional<MovingPoint> point = {};     // nothing where the landmark cannot be seen
  std::optional<ImageMotion> of_scene = {};  // nothing where the scene's motion is not known
  bool with_scene = false;
};

Eigen::Vector2d seenPixel(const Mover& mover) { return *mover.pixel + mover.shift->shift; }

class Scene {
 public:
  Scene(double line_delay_s, const Camera& camera, Segment* segment)
      : line_delay_s_(line_delay_s),
        middle_row_(0.5 * (camera.height() - 1)),
        camera_(camera),
        segment_(segment),
        movers_(segment->keyframes.size()) {
    collect();
    for (std::size_t k = 0; k < movers_.size(); ++k) moveWithCamera(k);
  }

  SceneMembers members() const {
    SceneMembers result(movers_.size());
    for (std::size_t k = 0; k < movers_.size(); ++k) {
      for (const Mover& mover : movers_[k]) result[k].push_back(mover.with_scene);
    }
    return result;
  }

  void place(const SceneMembers& members) {
    for (Keyframe& keyframe : segment_->keyframes) keyframe.line_delay_s = line_delay_s_;
    for (std::size_t k = 0; k < movers_.size(); ++k) {
      for (std::size_t i = 0; i < movers_[k].size(); ++i) {
        place(members[k][i], &movers_[k][i]);
      }
    }
  }

 private:
  void collect() {
    for (Landmark& landmark : segment_->landmarks) {
      if (!landmark.anchored) continue;
      add(landmark, landmark.reference, 1.0 / kStartVariance, &landmark.reference_pixel,
          &landmark.reference_shift);
    }
    for (Observation& observation : segment_->observations) {
      add(segment_->landmarks[observation.landmark], observation.keyframe, 1.0, &observation.pixel,
          &observation.shift);
    }
  }

  void add(const Landmark& landmark, int keyframe, double weight, Eigen::Vector2d* pixel,
           RowShift* shift) {
    Mover mover{pixel, shift};
    if (const auto ray = rayOf(landmark)) {
      const Rigid3& from = segment_->keyframes[landmark.reference].world_from_camera;
      const Rigid3& to = segment_->keyframes[keyframe].world_from_camera;
      // Eq. (1)
      const Eigen::Vector3d point =
          to.rotation.conjugate() *
          (from.rotation * *ray + landmark.inverse_depth * (from.translation - to.translation));
      mover.point = MovingPoint{
          point, landmark.inverse_depth,
          motionInTime(seenPixel(mover), shift->motion, middle_row_, line_delay_s_), weight};
    }
    movers_[static_cast<std::size_t>(keyframe)].push_back(mover);
  }

  std::optional<Eigen::Vector3d> rayOf(const Landmark& landmark) const {
    if (!landmark.anchored) return landmark.bearing;
    return segment_->cameraOf(landmark.reference, camera_).unproject(landmark.reference_pixel);
  }

  void moveWithCamera(std::size_t keyframe) {
    const Camera& camera = segment_->cameraOf(static_cast<int>(keyframe), camera_);
    std::vector<MovingPoint> points;
    for (const Mover& mover : movers_[keyframe]) {
      if (mover.point) points.push_back(*mover.point);
    }
    const std::optional<CameraMotion> motion = fitCameraMotion(points, camera);
    if (!motion) return;
    for (Mover& mover : movers_[keyframe]) {
      if (mover.point) mover.of_scene = imageMotion(*mover.point, *motion, camera);
      mover.with_scene =
          mover.of_scene && movesWithScene(*mover.point, *mover.of_scene, motion->typical_residual);
    }
  }

  // What does not belong to the scene, or could not be fitted, moves as it was seen to.
  void place(bool with_scene, Mover* mover) const {
    if (!with_scene || !mover->of_scene) {
      return placePixel(line_delay_s_, camera_.height(), mover->pixel, mover->shift);
    }
    const Eigen::Vector2d seen = seenPixel(*mover);
    *mover->pixel = asSeenAtOnceInTime(seen, *mover->of_scene, middle_row_, line_delay_s_);
    mover->shift->shift = seen - *mover->pixel;
  }

  double line_delay_s_;
  double middle_row_;
  const Camera& camera_;
  Segment* segment_;
  std::vector<std::vector<Mover>> movers_;  // by keyframe
};

}  // namespace

void placePixel(double line_delay_s, int image_height, Eigen::Vector2d* pixel, RowShift* shift) {
  const Eigen::Vector2d seen = *pixel + shift->shift;
  *pixel = asSeenAtOnce(seen, shift->motion, 0.5 * (image_height - 1), line_delay_s);
  shift->shift = seen - *pixel;
}

void setLineDelay(double line_delay_s, int image_height, Segment* segment) {
  for (Keyframe& keyframe : segment->keyframes) keyframe.line_delay_s = line_delay_s;
  for (Landmark& landmark : segment->landmarks) {
    placePixel(line_delay_s, image_height, &landmark.reference_pixel, &landmark.reference_shift);
  }
  for (Observation& observation : segment->observations) {
    placePixel(line_delay_s, image_height, &observation.pixel, &observation.shift);
  }
}

SceneMembers setLineDelayOfScene(double line_delay_s, const Camera& camera, Segment* segment) {
  Scene scene(line_delay_s, camera, segment);
  SceneMembers members = scene.members();
  scene.place(members);
  return members;
}

void setLineDelayOfScene(double line_delay_s, const Camera& camera, const SceneMembers& members,
                         Segment* segment) {
  Scene(line_delay_s, camera, segment).place(members);
}

}  // namespace camera_self_calibration
