#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "camera_self_calibration/map/segment.h"
#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/tracking/appearance.h"
#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

struct KeyframeMessage;  // pipeline/front_end.h
struct LearntState;      // pipeline/state_file.h writes and reads it

/// The newest part of the map, until the keyframe that is handed to the back end: with a rolling
/// shutter that may be, two images after it was taken. Lives as long as the call.
struct MapView {
  std::uint64_t map_id = 0;
  const Camera& camera;   ///< That its poses and depths were estimated with.
  const Segment& newest;  ///< The last keyframes; all of the startup batch before hand-over.
};

/// Called from the thread that produced the result; must not call back into the SelfCalibrator.
/// Empty functions are skipped.
struct Callbacks {
  std::function<void(const FrameResult&)> frame;              ///< Each image processed.
  std::function<void(const CalibrationReport&)> calibration;  ///< Each keyframe processed.
  std::function<void(const Event&)> event;
  /// What each keyframe brings to the back end, before it is processed there: the newest window
  /// with its tracks. For whole-trajectory solutions and other observers.
  std::function<void(const KeyframeMessage&)> keyframe;
  std::function<void(const MapView&)> map;  ///< Each keyframe, before its report.
};

/// Images in, trajectory and intrinsics out: the whole system of fig. 3, without ROS.
class SelfCalibrator {
 public:
  enum class Mode {
    kInline,  ///< process() returns when everything is computed: same input, same output.
    /// process() returns when the image is located. The back end works on its keyframe meanwhile,
    /// in a second thread; what it finds counts from the image after the next keyframe: same input,
    /// same output. All callbacks come from within process() and flush().
    kPipelined,
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

  /// The same with tracks from elsewhere (simulation). `detect` is called when the frame becomes a
  /// keyframe, and returns the tracks that start in it; `describe` at some of the keyframes
  /// (without it a map that was lost is not found again). Threaded, the caller takes the place of
  /// the first thread, so that a calibrator takes either images or tracks: the second kind throws
  /// std::logic_error.
  void processTracks(const TrackedFrame& frame, const std::function<std::vector<Track>()>& detect,
                     const Describe& describe = nullptr);

  // What follows may be called from any thread and takes effect with the next image.

  /// Ends all tracks: the next image begins a new map. The calibration and the queue stay.
  void resetTracking();

  /// Forgets everything and learns from the beginning: from the options' initial camera, or the
  /// given one, which must be plausible and of the options' model (else std::invalid_argument).
  void reset();
  void reset(const Camera& start);

  /// Begins with what was learnt in an earlier run: CONVERGED at the first keyframe if it was then,
  /// and re-checked against the images. What was learnt since the start is forgotten. Images of
  /// another size are left out. Throws std::invalid_argument that says what is wrong with it, or if
  /// it is of another model.
  void restore(const std::shared_ptr<const LearntState>& state);

  /// All that was learnt; null until the queue has taken over.
  std::shared_ptr<const LearntState> state() const;

  /// Keeps the calibration as it is while tracking goes on; false where there is none to keep.
  bool freeze(bool frozen);

  /// Multiplies the lengths of the present map and of all poses to come by `factor`, as when the
  /// true size of something is known. The new map_id marks that they no longer compare. False
  /// unless TRACKING, or if the factor is none that isScaleFactor() takes.
  bool setScale(double factor);

  /// From 1e-6 to 1e6, so that lengths stay numbers that can be computed with.
  static bool isScaleFactor(double factor);

  /// Waits until all images and keyframes are processed. Pipelined, it is for the thread that calls
  /// process() alone.
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
