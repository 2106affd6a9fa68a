#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/camera/image_weights.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/geometry/similarity.h"
#include "camera_self_calibration/model_choice/model_report.h"
#include "camera_self_calibration/pipeline/health.h"
#include "camera_self_calibration/queue/cross_validation.h"
#include "camera_self_calibration/tracking/image_view.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

enum class TrackingState { kInitializing, kTracking, kLost };
enum class EventType {
  kCalibrationChange,
  kHandover,
  kConverged,
  kLost,
  kRelocalized,
  kInput,
  kMountChanged,
  kNoLongerConverged
};

/// "TRACKING", "WAITING_FOR_MOTION", "HANDOVER", ...: the names used in messages and files.
std::string toString(TrackingState state);
std::string toString(EventType type);

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A map that goes on in another: an older one was found again, or the scale was set.
struct MapMove {
  std::uint64_t from = 0;  ///< map_id of the poses until now.
  std::uint64_t to = 0;
  Similarity3 to_from_from;  ///< Takes these poses over into the other map.
};

/// The result of one image, published in the order of the images.
struct FrameResult {
  std::int64_t stamp_ns = 0;  ///< Of the image.
  TrackingState state = TrackingState::kInitializing;
  std::string sentence;          ///< The state in words, with what would help.
  std::uint64_t map_id = 0;      ///< Poses of different maps have different frames and scales.
  std::optional<MapMove> moved;  ///< In the first image of a map that goes on in another.
  /// Known while TRACKING only; else the last one that was. Map units: the scale is arbitrary. Axes
  /// of the optical frame (REP 103).
  Rigid3 world_from_camera;
  /// Of a perturbation (translation in the world [map unit], rotation in the camera [rad]).
  Matrix6d pose_covariance = Matrix6d::Zero();
  bool is_keyframe = false;
  std::int64_t keyframe_id = -1;           ///< If is_keyframe.
  std::uint64_t calibration_revision = 0;  ///< Of the intrinsics used.
  TrackedFrame tracks;
  ImageView image;  ///< As it was given; empty where tracks were.
  double processing_seconds = 0.0;
};

/// One segment of the queue, for reports.
struct SegmentReport {
  std::int64_t sequence = 0;
  std::int64_t begin_ns = 0;
  std::int64_t end_ns = 0;
  double entropy = 0.0;  ///< Normalised differential entropy of its own marginal [nats].
  int keyframes = 0;
  int landmarks = 0;
  int observations = 0;
};

struct QueueReport {
  std::vector<SegmentReport> segments;
  int swaps = 0;  ///< Changes of the queue since the start, the first fillings too.
  bool last_accepted = false;
  std::string last_decision;  ///< What became of the newest candidate, and why.
};

/// What is known of the shutter.
struct ShutterReport {
  bool rolls = false;      ///< Whether a readout time is in use.
  double readout_s = 0.0;  ///< From the first row to the last: given, or the estimate [s].
  double sigma_s = std::numeric_limits<double>::infinity();  ///< Of the estimate; 0 if given [s].
};

/// In words, with the readout time in milliseconds.
std::string describe(const ShutterReport& shutter);

/// What features of the queue's segments covered of the image.
struct ObservedReport {
  double share = 0.0;                              ///< Of the part of the image that sees, 0 to 1.
  PixelError uncertainty = PixelError::unknown();  ///< There, as the whole image's [px].
  std::string unseen_corners;                      ///< In words; empty where there is none.
  /// Of the queue's observations; null where there is none.
  std::shared_ptr<const ImageWeights> features;
};

/// What is known of the intrinsics.
struct CalibrationReport {
  /// CONVERGED, and not merely kept so beyond a limit: what outlives the run asks for this.
  bool isGoodNow() const { return state == CalibrationState::kConverged && !afresh; }

  std::int64_t stamp_ns = 0;  ///< Of the newest image that it rests on.
  CalibrationState state = CalibrationState::kWaitingForMotion;
  std::string sentence;  ///< The state in words.
  std::string hint;      ///< Which motion would help; empty if none is needed.
  /// The verdict by the limits themselves, where CONVERGED is kept beyond one so that it does not
  /// flicker.
  std::optional<HealthVerdict> afresh;
  Camera camera;
  IntrinsicsMatrix covariance;  ///< n_c x n_c; empty until there is an estimate.
  /// Degrees of freedom of the disagreement between segments that the covariance was made larger
  /// by; 0: it was not.
  int scatter_freedom = 0;
  /// Expected error over the image [px]: of noise, of what halves of the video disagree beyond it,
  /// and of the lens model's misfit. Infinite until there is an estimate.
  PixelError uncertainty;
  ObservedReport observed;     ///< Known after hand-over.
  double entropy = 0.0;        ///< Of the estimate, normalised as the segments' [nats].
  std::uint64_t revision = 0;  ///< Grows with each new estimate.
  std::uint64_t epoch = 0;     ///< Grows with each change of the physical camera.
  /// Of the newest test whether the lens is still the same; 1 where there was none.
  double change_p_value = 1.0;
  std::string last_change;  ///< What the last change of the lens was; empty if there was none.
  std::int64_t last_change_ns = 0;       ///< When it began.
  bool handed_over = false;              ///< From the startup batch to the queue.
  bool frozen = false;                   ///< Kept as it is on request.
  std::uint64_t starts_given_up = 0;     ///< Start values so far that map after map was lost with.
  std::optional<Camera> start_given_up;  ///< The newest of them.
  std::int64_t keyframes = 0;            ///< Seen so far.
  QueueReport queue;
  ShutterReport shutter;
  CrossValidation cross_validation;
  LensFitReport lens_fit;
  /// Of the newest comparison of lens models; empty unless the model is to be chosen.
  std::vector<ModelEvidence> models;
};

struct Event {
  EventType type = EventType::kInput;
  std::int64_t stamp_ns = 0;        ///< Of the image that raised it.
  std::int64_t onset_stamp_ns = 0;  ///< Dated start of a change; else equal to stamp_ns.
  std::string sentence;
  std::uint64_t epoch = 0;      ///< Of the calibration after the event.
  double magnitude_px = 0.0;    ///< kCalibrationChange: pixelDistance of the lens before and after.
  double p_value = 1.0;         ///< Of a change: probability of so much by chance.
  double rotation = 0.0;        ///< kMountChanged: by how much a camera of a rig was turned [rad].
  double rotation_sigma = 0.0;  ///< 1 sigma of it [rad].
};

}  // namespace camera_self_calibration
