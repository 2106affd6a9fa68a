#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/pipeline/learnt_state.h"

namespace camera_self_calibration {

/// What other threads ask of the first one, which takes it before its next image.
class Requests {
 public:
  /// To begin from the start: with a saved state, a camera, or neither.
  struct Restart {
    std::optional<Camera> camera;
    std::shared_ptr<const LearntState> state;
  };
  struct Taken {
    bool reset_tracking = false;
    std::optional<Restart> restart;
    double scale = 1.0;
  };

  void resetTracking() {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_.reset_tracking = true;
  }
  void restart(Restart restart) {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_.restart = std::move(restart);
    waiting_.scale = 1.0;
  }
  void scale(double factor) {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_.scale *= factor;
  }
  Taken take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(waiting_, Taken());
  }

 private:
  std::mutex mutex_;
  Taken waiting_;
};

}  // namespace camera_self_calibration
