#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/pipeline/learnt_state.h"

namespace camera_self_calibration {

/// Where a calibration is kept. Empty: not kept there.
struct StoreOptions {
  std::string camera_name = "camera";
  std::string calibration_file;  ///< YAML, as camera_info_manager keeps it.
  std::string state_file;        ///< Everything that was learnt (LearntState).
};

/// The calibration on the disk. Writes atomically and reads back. What load() refuses (a file that
/// cannot be read, is for another camera, or holds no usable values) is never written over: save()
/// refuses it too and says why. Thread-safe.
class CalibrationStore {
 public:
  explicit CalibrationStore(const StoreOptions& options) : options_(options) {}

  bool hasFile() const {
    return !options_.calibration_file.empty() || !options_.state_file.empty();
  }

  struct Loaded {
    std::shared_ptr<const LearntState> state;  ///< Fits model and image size; or null.
    std::optional<Camera> camera;              ///< As a start; of the model asked for, if any.
    std::vector<std::string> notes;            ///< What was taken from where.
    std::vector<std::string> problems;         ///< What was refused, and why.
  };

  /// What there is for a camera of this model (none: of any) and image size.
  Loaded load(std::optional<CameraModel> model, int width, int height);

  struct Outcome {
    bool success = false;
    std::string message;   ///< What was written where, or what went wrong.
    bool refused = false;  ///< Nothing was tried, since what there is must not be kept.
  };

  /// Keeps both, where a file is given; a CameraInfo of zeros never replaces a calibration. After
  /// beginAnew(), or where the state is of another epoch, what the state file held goes to
  /// FILE.previous first. So does a calibration with R and P of a stereo pair, if `info` has none.
  Outcome save(const LearntState& state, const sensor_msgs::CameraInfo& info);

  /// Keeps a calibration that was given from outside in the calibration file, as it is. What the
  /// state file held goes to FILE.previous, since the next start must not prefer it.
  Outcome saveGiven(std::optional<CameraModel> model, const sensor_msgs::CameraInfo& info);

  /// What is learnt from now on does not rest on what was saved.
  void beginAnew();

 private:
  /// Contents of a file; or why it is neither used nor written over; or, without a file, neither.
  struct KnownState {
    std::shared_ptr<const LearntState> state;
    std::string refusal;
  };
  struct KnownCalibration {
    std::optional<CameraFit> start;
    std::string refusal;
    std::string of_a_pair = {};  ///< The file, where it holds R and P of a stereo pair.
  };

  KnownState readState(std::optional<CameraModel> model, int width, int height) const;
  KnownCalibration readCalibration(std::optional<CameraModel> model, int width, int height) const;
  std::string saveState(const LearntState& state);
  std::string putStateAside(std::optional<CameraModel> model, const sensor_msgs::CameraInfo& info);
  std::string saveCalibration(std::optional<CameraModel> model,
                              const sensor_msgs::CameraInfo& info);
  std::optional<CameraModel> judgedBy(const LearntState& state) const;

  const StoreOptions options_;
  std::mutex mutex_;
  bool keep_previous_ = false;
  bool loaded_ = false;
  std::optional<CameraModel> loaded_model_;  // That the files were judged by; none: any.
};

}  // namespace camera_self_calibration
