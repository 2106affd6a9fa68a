#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <vector>

#include "camera_self_calibration/map/segment.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

/// What a picture of the current map shows, in bounded memory. Positions in the world frame [map
/// units]. Not thread-safe.
class Scene {
 public:
  /// A stretch of the trajectory that the calibration rests on.
  struct Stretch {
    std::vector<Eigen::Vector3d> positions;
    double score = 0.0;  ///< 0: informs most, to 1: least, of the queue's segments.
  };
  struct Point {
    Eigen::Vector3d position;
    int brightness = -1;  ///< In the image that saw it last, 0 to 255; negative if not known.
  };

  /// The newest keyframes of a map, with poses and depths solved. Those of another map replace
  /// everything.
  void add(std::uint64_t map_id, const Segment& newest);
  /// Their landmarks too; `image`, if not null, is that of the last keyframe.
  void addLandmarks(const Camera& camera, const Segment& newest, const ImageView* image);
  /// The queue and the camera.
  void add(const CalibrationReport& report);
  /// Of another map than the keyframes': left out.
  void add(const FrameResult& frame);

  const std::map<std::int64_t, Keyframe>& keyframes() const { return keyframes_; }  ///< By id.
  std::vector<Stretch> queue() const;
  const std::map<std::int64_t, Point>& landmarks() const { return landmarks_; }  ///< By track id.
  const Rigid3& worldFromCamera() const { return world_from_camera_; }
  const CalibrationReport& report() const { return report_; }
  /// Median distance of the newest landmarks: the size of things [map units].
  double unit() const { return unit_; }
  /// Keyframes of the sliding window, counted from the newest.
  static constexpr int kWindow = 10;

 private:
  void clear();
  void measure(const Segment& segment);
  void thinOut();

  std::uint64_t map_id_ = 0;
  double unit_ = 1.0;
  std::map<std::int64_t, Keyframe> keyframes_;
  std::map<std::int64_t, Point> landmarks_;
  std::map<std::int64_t, std::vector<Eigen::Vector3d>> stretches_;  // by sequence
  Rigid3 world_from_camera_;
  CalibrationReport report_;
};

/// Unit rays of the camera around the border of its image, clockwise, `per_side` for each side.
/// Where the border has no ray, of the next place towards the principal point that has one.
std::vector<Eigen::Vector3d> fieldOfView(const Camera& camera, int per_side);

}  // namespace camera_self_calibration
