#pragma once

#include <std_msgs/Header.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <string>

#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/ros/camera_info.h"

namespace camera_self_calibration {

struct CameraInfoOptions {
  double min_change_px = 0.1;  ///< A new one must differ from the published one by more [px rms].
  OutputModel model = OutputModel::kAuto;
  bool publish_uncalibrated = false;  ///< Estimates before CONVERGED go out too, but no DEGENERATE.
  /// P stays that of the first converged calibration, so that the rectified image keeps its
  /// geometry while K and D are refined; else P follows K.
  bool fixed_projection = false;
};

/// What was published last.
struct CameraInfoState {
  std::string distortion_model;  ///< Empty while zeros go out.
  PixelError error;              ///< Of the conversion to it [px].
  bool inherited = false;        ///< From before the images changed, not confirmed in these.
  bool given = false;            ///< By set_camera_info, and not replaced by an estimate yet.
  bool last_good = false;        ///< CONVERGED once, while the present estimate is not.
  /// Why zeros go out although there is a calibration; empty otherwise.
  std::string obstacle;
  /// How far what goes out is from the estimate, and what to do; empty where it is close.
  std::string deviation;
};

/// The event as a node tells it: where CONVERGED is left, with what becomes of camera_info.
Event withCameraInfo(Event event, const CameraInfoState& info);

/// Decides which CameraInfo goes out: zeros until CONVERGED, and a new estimate only if it differs
/// visibly, since every change makes consumers rebuild their rectification maps. When CONVERGED is
/// left, the last good one stays until a reset or a change of the lens. One that did not come from
/// the images ends where the calibrator gives it up as its start. Thread-safe, but for update() and
/// inherit(), which must not overlap each other.
class CameraInfoPolicy {
 public:
  /// A conversion that errs by more than this is worth a warning [px].
  static constexpr double kConversionWarning = 0.1;

  explicit CameraInfoPolicy(const CameraInfoOptions& options)
      : options_(options), min_change_px_(options.min_change_px) {}

  /// A warning about what is published from now on; empty if there is nothing to warn about.
  std::string update(const CalibrationReport& report);

  /// Publishes a calibration known from elsewhere (another image size of the same camera) until an
  /// estimate replaces it, or a change of the lens (a later epoch) shows that it no longer holds.
  void inherit(const Camera& camera);

  /// Publishes a message that was given from outside, as it is and at once, until an estimate that
  /// begins anew is CONVERGED or shows another lens. `camera` is what it means; from any thread,
  /// before the calibrator is reset.
  void accept(const Camera& camera, const sensor_msgs::CameraInfo& info);

  /// Ends what inherit() and accept() began; from any thread.
  void forget();

  /// CameraInfoOptions::min_change_px from now on; from any thread.
  void setMinChange(double pixels) { min_change_px_ = pixels; }

  /// The calibration behind the published message; nothing while zeros go out.
  std::optional<Camera> published() const;

  /// For an image of this header and size.
  sensor_msgs::CameraInfo infoFor(const std_msgs::Header& header, int width, int height) const;

  CameraInfoState state() const;

 private:
  bool usable(const CalibrationReport& report) const;
  bool keeps(const CalibrationReport& report);
  bool lastGoodHolds(const CalibrationReport& report) const;
  void forgetLastGood();
  std::string forgetRefuted(const CalibrationReport& report);
  std::string follow(const CalibrationReport& report);
  void withdraw();
  std::optional<std::string> publish(const Camera& camera, bool converged, std::uint64_t orders);
  std::string remedy(const Camera& camera) const;
  std::string judgement(const CalibrationReport& report) const;
  void setProjection(bool converged, sensor_msgs::CameraInfo* info);

  const CameraInfoOptions options_;
  std::atomic<double> min_change_px_;
  std::atomic<std::uint64_t> orders_{0};  // Calls of accept() and forget().
  std::uint64_t inherited_epoch_ = 0;
  bool inherited_epoch_known_ = false;
  std::uint64_t starts_given_up_ = 0;  // By the last report.

  mutable std::mutex mutex_;
  std::optional<sensor_msgs::CameraInfo> fixed_;  // Its P and size hold.
  std::optional<Camera> camera_;                  // Behind published_.
  std::optional<CameraInfoConversion> published_;
  std::optional<std::uint64_t> good_epoch_;  // published_ was CONVERGED in this epoch.
  bool last_good_ = false;
  bool inherited_ = false;
  bool given_ = false;
  bool awaits_beginning_ = false;  // Reports still come from before the reset.
  std::string warning_;            // Of published_; without one, why there is none.
};

}  // namespace camera_self_calibration
