#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

/// Called from the thread that produced the result; must not call back into the SelfCalibrator.
/// Empty functions are skipped.
struct Callbacks {
  std::function<void(const FrameResult&)> frame;              ///< Each image processed.
  std::function<void(const CalibrationReport&)> calibration;  ///< Each keyframe processed.
  std::function<void(const Event&)> event;
};

/// Images in, trajectory and intrinsics out: the whole system of fig. 3, without ROS.
class SelfCalibrator {
 public:
  enum class Mode {
    kInline,   ///< process() returns when everything is computed: same input, same output.
    kThreaded  ///< process() enqueues; two threads work; live images may be dropped.
  };

  /// Throws std::invalid_argument that lists options.problems().
  SelfCalibrator(const Options& options, Mode mode, Callbacks callbacks);
  ~SelfCalibrator();

  /// Threaded: false if an older image had to be dropped. The image stays alive by its owner.
  /// A time that jumps back begins a new map. An empty image, or one of another size than the
  /// initial camera's or else the first, is left out and raises EventType::kInput once; the
  /// calibration stays.
  bool process(const ImageView& image);

  /// The same with tracks from elsewhere (simulation). `detect` is called, inline only, when the
  /// frame becomes a keyframe, and returns the tracks that start in it.
  void processTracks(const TrackedFrame& frame, const std::function<std::vector<Track>()>& detect);

  /// Ends all tracks: the next image begins a new map. The calibration and the queue stay.
  void resetTracking();

  /// Threaded: waits until all enqueued images and keyframes are processed.
  void flush();

  /// The newest report (any thread).
  CalibrationReport calibration() const;

  /// Images dropped because processing was slower than the camera.
  std::int64_t droppedImages() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace camera_self_calibration
