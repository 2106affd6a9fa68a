#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "camera_self_calibration/pipeline/self_calibrator.h"

namespace camera_self_calibration {

/// A SelfCalibrator that can be begun anew (another image size, a reset): what it reports goes on
/// counting, so that no map, revision or epoch of the new one bears the number of an old one, and
/// no start that is given up goes unnoticed.
class CalibrationSession {
 public:
  /// `options` without an initial camera. The callbacks come from the calibrator's threads.
  CalibrationSession(const Options& options, Callbacks callbacks);

  /// Ends what runs, and begins with this initial camera, or else the default guess for the first
  /// image. What went wrong, in words; empty if nothing did.
  std::string start(const std::optional<Camera>& initial_camera);

  /// Ends the threads; returns when the last callback has.
  void stop();

  bool running() const { return calibrator_ != nullptr; }

  /// False if an older image had to be dropped; running() must be true.
  bool process(const ImageView& image) { return calibrator_->process(image); }

  /// Calls `use` with the calibrator; false if none is running. From any thread: what start() and
  /// stop() replace stays as long as `use` runs, so `use` should be quick.
  bool use(const std::function<void(SelfCalibrator&)>& use) const;

  /// Null unless running(). Its own numbers do not go on counting; those of the callbacks do.
  SelfCalibrator* calibrator() { return calibrator_.get(); }

 private:
  struct Counters {
    std::uint64_t map_id = 0;
    std::uint64_t revision = 0;
    std::uint64_t epoch = 0;
    std::uint64_t starts_given_up = 0;
  };

  Callbacks continued() const;
  void pass(FrameResult result) const;
  void pass(CalibrationReport report) const;

  const Options options_;
  const Callbacks callbacks_;
  bool started_ = false;
  Counters base_;  // Changes only while no thread runs.
  mutable std::mutex mutex_;
  mutable Counters newest_;
  mutable std::mutex calibrator_mutex_;  // while calibrator_ is replaced or used elsewhere
  std::unique_ptr<SelfCalibrator> calibrator_;
};

}  // namespace camera_self_calibration
