#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "camera_self_calibration/map/segment.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/ros/by_map.h"
#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

/// What a picture of the current map shows, in bounded memory; a map that is found again is shown
/// whole. Positions in the world frame [map units]. Not thread-safe.
class Scene {
 public:
  /// A part of the trajectory that the calibration rests on.
  struct QueueSegment {
    std::vector<Eigen::Vector3d> positions;
    double score = 0.0;  ///< 0: informs most, to 1: least, of the queue's segments.
  };
  struct Point {
    Eigen::Vector3d position;
    int brightness = -1;  ///< In the image that saw it last, 0 to 255; negative if not known.
  };

  /// Where an event happened.
  struct Occurrence {
    Event event;
    Eigen::Vector3d position;
  };

  /// The newest keyframes of a map, with poses and depths solved. With those of another map the
  /// picture becomes that of the other.
  void add(std::uint64_t map_id, const Segment& newest);
  /// Their landmarks too; `image`, if not null, is that of the last keyframe.
  void addLandmarks(const Camera& camera, const Segment& newest, const ImageView* image);
  /// The queue and the camera.
  void add(const CalibrationReport& report);
  /// The pose, unless it is of another map than the keyframes.
  void add(const FrameResult& frame);
  /// It happens where the camera is.
  void add(const Event& event);

  /// By id.
  const std::map<std::int64_t, Keyframe>& keyframes() const { return maps_.present().keyframes; }
  std::vector<QueueSegment> queue() const;
  /// By track id.
  const std::map<std::int64_t, Point>& landmarks() const { return maps_.present().landmarks; }
  const Rigid3& worldFromCamera() const { return maps_.present().world_from_camera; }
  /// The newest in this map, the oldest first.
  const std::deque<Occurrence>& events() const { return maps_.present().events; }
  const CalibrationReport& report() const { return report_; }
  /// Median distance of the newest landmarks: the size of things [map units].
  double unit() const { return unit_; }
  /// Keyframes of the sliding window, counted from the newest.
  static constexpr int kWindow = 10;
  static constexpr std::size_t kMaxEvents = 6;

 private:
  /// One map.
  struct Content {
    std::map<std::int64_t, Keyframe> keyframes;
    std::map<std::int64_t, Point> landmarks;
    std::map<std::int64_t, std::vector<Eigen::Vector3d>> segment_positions;  // by sequence
    std::deque<Occurrence> events;
    Rigid3 world_from_camera;
    std::size_t size() const { return keyframes.size(); }
  };

  static void thinOut(std::map<std::int64_t, Keyframe>* keyframes);
  static void merge(const Similarity3& into_from_left, Content left, Content* into);
  void measure(const Segment& segment);

  std::uint64_t map_id_ = 0;
  double unit_ = 1.0;
  ByMap<Content> maps_;
  CalibrationReport report_;
};

/// Unit rays of the camera around the border of its image, clockwise, `per_side` for each side.
/// Where the border has no ray, of the next place towards the principal point that has one.
std::vector<Eigen::Vector3d> fieldOfView(const Camera& camera, int per_side);

}  // namespace camera_self_calibration
