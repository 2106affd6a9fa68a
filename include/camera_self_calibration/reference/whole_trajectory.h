#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// The keyframes, landmarks and observations of a whole run, put together from the windows that
/// were offered to the queue: the same tracks, with the tracker's own sigmas. A window that has no
/// keyframe in common with what came before begins a new part, in a frame and scale of its own.
class WholeTrajectory {
 public:
  /// Adds what a window (its keyframes' ids grow along the run) has beyond the windows before.
  void add(const Segment& window);

  /// One segment a part.
  std::vector<Segment> parts() const;

  /// Takes over poses, bearings and depths of solved parts; landmarks that are missing in them
  /// keep what they had.
  void update(const std::vector<Segment>& solved);

  /// Frees all pixels of a rolling shutter of this time between rows, as the newest window's are.
  void setLineDelay(double line_delay_s, int image_height);

  int keyframes() const { return keyframes_; }

 private:
  struct Part {
    Segment segment;                                     // without observations
    std::vector<std::vector<Observation>> observations;  // by landmark
    std::map<std::int64_t, int> keyframe_index;          // by id
    std::map<std::int64_t, int> landmark_index;          // by track id
  };

  static void learnMotion(const Observation& seen, std::vector<Observation>* known);
  static double scaleOf(const Part& part, const Segment& window);
  static void addKeyframes(const Segment& window, double scale, Part* part);

  int keyframes_ = 0;
  std::deque<Part> parts_;
};

}  // namespace camera_self_calibration
