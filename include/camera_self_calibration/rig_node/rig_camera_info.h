#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/rig/rig_session.h"
#include "camera_self_calibration/ros/camera_info_policy.h"
#include "camera_self_calibration/tools/rig_files.h"

namespace camera_self_calibration {

/// Decides which CameraInfo goes out for each camera of a rig: its own (CameraInfoPolicy) until the
/// rig is CONVERGED, then that with the joint intrinsics; of two cameras side by side with R and P
/// of the rectified pair, which change together and only where the difference is visible. A
/// camera whose lens changes ends what was joint. Thread-safe.
class RigCameraInfo {
 public:
  /// `pipeline` says what counts as converged.
  RigCameraInfo(const CameraInfoOptions& options, const Options& pipeline, int cameras);

  /// Warnings about what goes out from now on, one sentence each.
  std::vector<std::string> update(const RigReport& report);

  /// The frame of the images of a camera; to be called with each.
  void noteFrame(int camera, const std::string& frame);

  /// For an image of this header and size. Both of a rectified pair name the left camera's frame,
  /// as image_geometry demands it.
  sensor_msgs::CameraInfo infoFor(int camera, const std_msgs::Header& header, int width,
                                  int height) const;

  /// What goes out for a camera by itself.
  CameraInfoState state(int camera) const { return policies_[camera]->state(); }

  /// In words what goes out for a camera.
  std::string stateText(int camera) const;

  /// Once the rig is CONVERGED, why there is no rectified pair, or that its cameras are exchanged;
  /// else empty.
  std::string pairNote() const;

 private:
  std::vector<std::string> updatePair(const RigReport& report);
  const sensor_msgs::CameraInfo* ofPair(int camera) const;

  const double min_change_px_;
  const Options pipeline_;
  std::vector<std::unique_ptr<CameraInfoPolicy>> policies_;
  std::mutex update_mutex_;     // one update at a time
  std::uint64_t revision_ = 0;  // that the pair was judged by
  mutable std::mutex mutex_;    // for all that follows
  std::optional<StereoPair> pair_;
  std::vector<std::string> frames_;  // of the images
  Rig pair_rig_;                     // behind it
  std::string why_no_pair_;
};

}  // namespace camera_self_calibration
