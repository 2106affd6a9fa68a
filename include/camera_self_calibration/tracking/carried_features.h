#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "camera_self_calibration/tracking/local_motion.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

/// Finds the features that the camera carries along: on the robot's own body, on a guard before the
/// lens, in letters that a recorder writes over its images. They stand still in the image while the
/// scene moves; the scene is what covers most of the image. A feature is found out once the scene
/// would have moved it a hundred times as far as it may have moved: a point of the scene would have
/// to be a hundred times as far away as its surroundings, and the camera not turn meanwhile. Where
/// the scene's motion leaves the image still, as on the axis about which the camera rolls, nothing
/// is found out. Knows nothing of the lens.
class CarriedFeatures {
 public:
  /// Takes the tracks of the next image, which has the size of those before. Returns the ids of the
  /// tracks that are found out now.
  std::vector<std::int64_t> add(const TrackedFrame& frame);

  /// Whether a feature was found out within `distance` [px]. A place is forgotten once the scene
  /// has moved a hundred times as far as it took to find it out, so that it is tried again for a
  /// hundredth of the time: what was carried may have been taken away.
  bool near(const Eigen::Vector2d& pixel, double distance) const;

  void clear();

 private:
  struct History {
    std::int64_t id = 0;
    Eigen::Vector2d begin = Eigen::Vector2d::Zero();  // where it was when the step began
    Eigen::Vector2d scene = Eigen::Vector2d::Zero();  // how the scene would have moved it so far
    double scene_extent = 0.0;                        // the farthest of that [px]
    double own_extent = 0.0;  // the farthest that it has been from its reference pixel [px]
  };
  // A track that was there when the step began.
  struct Step {
    const Track* track;
    History* history;
    bool moved;  // by the length of a step
  };
  struct Place {
    Eigen::Vector2d pixel;
    double expires;  // at this path of the scene
  };

  History* historyOf(const Track& track);
  void findSteps(const TrackedFrame& frame);
  bool sceneMoved(const TrackedFrame& frame) const;
  LocalMotion::Motion sceneMotion(const TrackedFrame& frame);
  void beginStep(const TrackedFrame& frame);

  std::vector<History> histories_;  // by id
  std::vector<History> next_;
  std::vector<Step> steps_;
  std::vector<cv::Point2f> from_;
  std::vector<cv::Point2f> to_;
  std::vector<Place> places_;
  double path_ = 0.0;  // of the scene through the image [px]
  LocalMotion motion_;
};

}  // namespace camera_self_calibration
