#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/simulation/auto_exposure.h"
#include "camera_self_calibration/simulation/lens.h"
#include "camera_self_calibration/simulation/mount.h"
#include "camera_self_calibration/simulation/moving_objects.h"
#include "camera_self_calibration/simulation/renderer.h"
#include "camera_self_calibration/simulation/room.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"
#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

struct SequenceOptions {
  RoomOptions room;
  Lens lens;  ///< The camera, and its zoom on the clock of the sequence [s].
  /// The kind, seed and speed of a synthetic motion; its box and duration are set from the room's
  /// free space and duration_s.
  SyntheticMotionOptions motion;
  /// If given, in place of the synthetic motion.
  std::optional<Trajectory> trajectory;
  Mount mount;               ///< Of the camera on what moves so.
  double rate_hz = 20.0;     ///< Of the images.
  double duration_s = 30.0;  ///< At most; a given trajectory may end earlier.
  MovingObjectsOptions objects;
  RendererOptions renderer;
  bool auto_exposure = false;  ///< See AutoExposure.
  bool text_overlay = false;   ///< See writeOverlay.
  std::uint64_t noise_seed = 1;
  std::int64_t start_stamp_ns = 1700000000000000000;  ///< Of the first image.

  /// Every violated bound in one sentence each; empty if all is well.
  std::vector<std::string> problems() const;
};

/// An image and everything that is true of it.
struct SimulatedFrame {
  cv::Mat image;  ///< CV_8UC1.
  std::int64_t stamp_ns = 0;
  Rigid3 world_from_camera;  ///< At the stamp: of the first row, middle of the exposure.
  Camera camera;

  /// The image without a copy; it keeps the pixels alive.
  ImageView view() const;
};

/// A sequence of rendered images with exact ground truth. Frames may be asked for in any order and
/// depend on the options only; with automatic exposure those before a frame are rendered first. Not
/// for use by two threads at once.
class SimulatedSequence {
 public:
  /// Throws std::invalid_argument that lists options.problems().
  explicit SimulatedSequence(const SequenceOptions& options);

  int size() const { return size_; }  ///< Number of frames.
  std::int64_t stampNs(int index) const;
  double time(int index) const { return index / options_.rate_hz; }  ///< Since the first frame [s].
  Rigid3 worldFromCamera(int index) const { return trajectory_.worldFromCamera(time(index)); }
  Camera camera(int index) const { return options_.lens.at(time(index)); }

  /// Renders a frame.
  SimulatedFrame frame(int index) const;

  const SequenceOptions& options() const { return options_; }
  const Trajectory& trajectory() const { return trajectory_; }
  const World& world() const { return world_->world; }

 private:
  cv::Mat exposed(int index) const;
  void meter(const cv::Mat& image) const;

  SequenceOptions options_;
  Trajectory trajectory_;
  std::shared_ptr<const PaintedWorld> world_;
  int size_;
  Renderer renderer_;
  std::optional<Renderer> zoomed_;
  mutable AutoExposure exposure_;
  mutable std::vector<double> gains_{1.0};  // of the frames that are metered, and of the next one
};

}  // namespace camera_self_calibration
