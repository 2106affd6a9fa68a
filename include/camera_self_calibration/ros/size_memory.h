#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/ros/factory_calibration.h"

namespace camera_self_calibration {

/// Keeps what was learnt at one image size for another one: rescaled where the driver reports
/// binning and region of interest of both, or as it was when the size had been seen before.
/// Thread-safe.
class SizeMemory {
 public:
  struct Known {
    Camera camera;    ///< For the images that come now.
    std::string how;  ///< Where it comes from, in words.
  };

  /// `factory` knows the driver's CameraInfo; null: nobody does. It must outlive this object.
  explicit SizeMemory(const FactoryCalibration* factory) : factory_(factory) {}

  /// Remembers a CONVERGED calibration; a later epoch, a change of the lens, forgets all others.
  void update(const CalibrationReport& report);

  /// Ends all that was learnt, and waits for what begins anew; to be called once the calibrator is
  /// reset.
  void forget();

  /// Whether images of the same size show another part of the sensor, for some images in a row.
  bool windowMoved(int width, int height);

  /// From here on the images are of this size: what is known of their camera.
  std::optional<Known> begin(int width, int height);

 private:
  using Size = std::pair<int, int>;
  struct Learnt {
    Camera camera;
    std::optional<SensorWindow> window;
  };

  std::optional<Known> rescaled() const;
  std::optional<Known> seenBefore(const Size& size) const;

  const FactoryCalibration* factory_;
  mutable std::mutex mutex_;
  std::map<Size, Learnt> learnt_;
  Size newest_;                         // Of learnt_.
  std::optional<SensorWindow> window_;  // Of the images that come now.
  std::optional<std::uint64_t> epoch_;  // Since begin().
  int moved_images_ = 0;
  bool awaits_beginning_ = false;  // Reports still come from before the reset.
};

}  // namespace camera_self_calibration
