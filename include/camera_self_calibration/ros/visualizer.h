#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/plotting/convergence_history.h"
#include "camera_self_calibration/plotting/track_overlay.h"
#include "camera_self_calibration/ros/node_options.h"
#include "camera_self_calibration/ros/scene.h"
#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

/// Publishes what people look at: ~markers, ~landmarks, ~track_image, ~convergence. Draws on a
/// thread of its own, at most ten times a second (the chart twice), and only what somebody hears;
/// otherwise it keeps the keyframes' poses and the reports for a viewer that comes later. All
/// functions may be called from different threads, and return at once.
class Visualizer {
 public:
  /// How many messages were drawn so far.
  struct Counts {
    std::int64_t markers = 0;
    std::int64_t clouds = 0;
    std::int64_t track_images = 0;
    std::int64_t charts = 0;
  };

  Visualizer(const ros::NodeHandle& private_node, const NodeOptions& options);
  ~Visualizer();

  /// An image on its way into the pipeline.
  void add(const ImageView& image, const std::string& frame_id);
  void add(const FrameResult& frame);
  /// The newest keyframes of the map and their landmarks, under these intrinsics.
  void add(std::uint64_t map_id, const Camera& camera, const Segment& newest);
  void add(const CalibrationReport& report);
  void add(const Event& event);

  Counts counts() const;

 private:
  /// A topic and whether somebody hears it.
  struct Topic {
    ros::Publisher publisher;
    std::atomic<bool> heard{false};
    std::uint32_t subscribers = 0;  // at the last look
    bool changed = false;           // since the last message; under mutex_
  };
  /// An image with its tracks, to be drawn.
  struct Picture {
    ImageView image;
    FrameResult frame;
  };

  void run();
  bool isDue(Topic* topic);
  void publishMarkers();
  void publishCloud();
  void publishTracks();
  void publishChart();
  std::vector<Caption> captions(const FrameResult& frame) const;
  std::optional<Caption> newsAt(std::int64_t stamp_ns) const;
  const ImageView* imageOf(std::int64_t stamp_ns) const;

  const std::string world_frame_;
  const Options pipeline_;
  Topic markers_;
  Topic cloud_;
  Topic tracks_;
  Topic chart_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  bool stop_ = false;
  Counts counts_;
  std::string image_frame_;
  std::int64_t stamp_ns_ = 0;  // of the newest frame
  std::deque<ImageView> images_;
  Scene scene_;
  std::optional<Event> newest_event_;
  ConvergenceHistory history_;
  TrackTrails trails_;
  std::optional<Picture> picture_;

  std::thread thread_;
};

}  // namespace camera_self_calibration
