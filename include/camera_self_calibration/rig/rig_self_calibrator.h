#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/rig/rig_session.h"

namespace camera_self_calibration {

/// As Callbacks, with the camera's number. Those of different cameras may overlap.
struct RigCallbacks {
  std::function<void(int, const FrameResult&)> frame;
  std::function<void(int, const CalibrationReport&)> calibration;
  /// Of a rig also kMountChanged; kInput, of the first camera, where a joint solution or a callback
  /// failed with an exception.
  std::function<void(int, const Event&)> event;
  /// After each joint solution and each keyframe of a camera.
  std::function<void(const RigReport&)> rig;
};

/// Images of several cameras in, their intrinsics and places out. Each camera has a SelfCalibrator;
/// a RigSession takes what they see. Live, one more thread solves jointly, whenever that is worth
/// it; for at most half of the time, at low priority, so that no image waits for it.
class RigSelfCalibrator {
 public:
  /// `cameras`: options of each. Throws as SelfCalibrator.
  RigSelfCalibrator(const RigOptions& rig, const std::vector<Options>& cameras,
                    SelfCalibrator::Mode mode, RigCallbacks callbacks);
  ~RigSelfCalibrator();

  /// As RigSession::restore, and SelfCalibrator::restore and state of one camera.
  void restore(const RigEstimate& before) { session_.restore(before); }
  void restore(int camera, const std::shared_ptr<const LearntState>& state) {
    cameras_[camera]->restore(state);
  }
  std::shared_ptr<const LearntState> state(int camera) const { return cameras_[camera]->state(); }

  /// As SelfCalibrator::process; those of one camera in the order of time.
  bool process(int camera, const ImageView& image);

  /// Inline: solves jointly from all so far.
  RigReport solve();

  RigReport report() const { return session_.report(); }

 private:
  Callbacks callbacksOf(int camera);
  void run();
  void work() noexcept;
  RigReport tell(RigReport report);
  RigReport examineMounts();

  const RigCallbacks callbacks_;
  const bool inline_;
  std::atomic<bool> stopping_{false};
  std::mutex mutex_;
  std::condition_variable wake_;  // stopping_, or a keyframe came
  RigSession session_;
  std::atomic<std::int64_t> newest_image_ns_{0};
  std::uint64_t told_epoch_ = 0;  // of the newest change of a mount; of the thread that solves
  std::vector<std::unique_ptr<SelfCalibrator>> cameras_;
  std::thread solver_;
};

}  // namespace camera_self_calibration
