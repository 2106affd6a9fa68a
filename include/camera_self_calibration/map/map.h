#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/geometry/similarity.h"
#include "camera_self_calibration/map/inverse_depth.h"
#include "camera_self_calibration/map/segment.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

/// The newest keyframes and the landmarks seen in them: bounded, whatever the length of the run.
/// Depths are kept in an anchor keyframe, along the ray of the pixel seen there, so that nothing
/// depends on the intrinsics but the poses and depths themselves.
class Map {
 public:
  /// `exact_references`: a landmark's ray is that of the pixel in which its track was detected, as
  /// in eq. 1. Otherwise that pixel is a measurement like the others, and the ray is estimated: the
  /// patch that all others are registered against has an error of its own, which they share.
  explicit Map(int max_keyframes, bool exact_references = false)
      : max_keyframes_(max_keyframes), exact_references_(exact_references) {}

  struct Sighting {
    std::int64_t keyframe_id = 0;
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< Freed of the rolling shutter.
    double sigma =
        1.0;  ///< Standard deviation per axis [px], positive; the reference pixel has one too.
    RowShift shift = {};
  };
  struct Point {
    std::int64_t reference_id = 0;  ///< Keyframe in which the track was detected.
    Eigen::Vector2d reference_pixel = Eigen::Vector2d::Zero();
    std::int64_t anchor_id = 0;       ///< Keyframe that inverse_depth refers to.
    double inverse_depth = 1.0;       ///< [1/map unit]
    std::vector<Sighting> sightings;  ///< In the order of time; the reference's is the first.
  };

  /// Adds a keyframe with an id greater than all before. Tracks not seen before start a landmark
  /// (detected in this keyframe if pixel == reference_pixel) at `new_inverse_depth`. The oldest
  /// keyframe goes when there are too many; depths that referred to it move on to the next
  /// sighting.
  void addKeyframe(const Keyframe& keyframe, const std::vector<Track>& tracks,
                   double new_inverse_depth, const Camera& camera);

  /// The physical camera changed: keyframes before this stamp keep the intrinsics `earlier`. Those
  /// from before the change before it are forgotten.
  void changeLens(std::int64_t onset_ns, const Camera& earlier, const Camera& present);

  /// The intrinsics that a keyframe was taken with; `present` since the last change.
  const Camera& cameraOf(const Keyframe& keyframe, const Camera& present) const {
    return keyframe.lens == kPresentLens ? present : held_lenses_[keyframe.lens];
  }

  /// How many keyframes have this stamp or a later one.
  int keyframesSince(std::int64_t stamp_ns) const;

  /// Frees all pixels of a rolling shutter of this time between rows [s].
  void setLineDelay(double line_delay_s, int image_height);
  double lineDelayS() const { return line_delay_s_; }

  /// Tells the motion of tracks in a keyframe, better known than when it was added; unknown ones
  /// are ignored.
  void setMotions(std::int64_t keyframe_id, const std::map<std::int64_t, ImageMotion>& motions,
                  int image_height);

  /// Removes landmarks altogether.
  void removePoints(const std::vector<std::int64_t>& track_ids);
  void clear();

  /// Takes all poses and depths over into another world.
  void move(const Similarity3& other_from_world);

  const std::deque<Keyframe>& keyframes() const { return keyframes_; }
  const std::map<std::int64_t, Point>& points() const { return points_; }
  /// Null if unknown.
  const Keyframe* keyframe(std::int64_t id) const;

  /// The keyframes from index `first` on as a segment of their own: landmarks detected before it
  /// are inherited. Landmarks with fewer than two sightings in it are left out.
  Segment segmentFrom(int first, const Camera& camera) const;

  /// The last `count` keyframes but for the `newer` newest ones.
  Segment lastKeyframes(int count, const Camera& camera, int newer = 0) const;

  /// Takes over poses, generations and depths of a segment made by this map (after solving). What
  /// the map has forgotten since then is left out.
  void update(const Segment& segment);

  /// Where a point is; nothing where its anchor's pixel has no ray.
  std::optional<WorldPoint> worldPoint(const Point& point, const Camera& camera) const;

  /// Inverse depth of a point as seen from a pose; nothing where its anchor's pixel has no ray.
  std::optional<double> inverseDepthFrom(const Rigid3& world_from_camera, const Point& point,
                                         const Camera& camera) const;

  /// Where those of the tracks are that are points; without those whose anchor's pixel has no ray.
  std::vector<WorldPoint> worldPoints(const std::vector<std::int64_t>& track_ids,
                                      const Camera& camera) const;

  /// typicalInverseDepth() of the points seen in a keyframe, in its own frame.
  double typicalInverseDepthAt(std::int64_t keyframe_id, const Camera& camera) const;

 private:
  Segment segmentOf(int first, int end, const Camera& camera) const;
  void removeOldest(const Camera& camera);
  std::optional<Landmark> landmarkFrom(std::int64_t track_id, const Point& point,
                                       const Sighting& first, const Camera& camera) const;

  int max_keyframes_;
  bool exact_references_;
  std::deque<Keyframe> keyframes_;
  std::vector<Camera> held_lenses_;  // Segment::held_lenses of what is taken out of it
  double line_delay_s_ = 0.0;
  std::map<std::int64_t, Point> points_;  // by track id: ordered, so that results are repeatable
};

/// The pixel at which a point was seen in a keyframe; null if it was not.
const Map::Sighting* sightingIn(const Map::Point& point, std::int64_t keyframe_id);

}  // namespace camera_self_calibration
