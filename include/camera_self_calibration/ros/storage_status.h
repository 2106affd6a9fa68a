#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/ros/calibration_store.h"

namespace camera_self_calibration {

/// What /diagnostics says of the files in which the calibration is kept. Not thread-safe.
class StorageStatus {
 public:
  /// Whether what is learnt is saved at all.
  void setKeeps(bool keeps) { keeps_ = keeps; }
  /// What of the saved files could not be used.
  void setProblems(const std::vector<std::string>& problems);
  /// How the newest saving ended.
  void update(const CalibrationStore::Outcome& saving) { saving_ = saving; }

  /// An ERROR while saving fails.
  void summarize(diagnostic_updater::DiagnosticStatusWrapper* status) const;

 private:
  bool keeps_ = false;
  std::string problems_;
  std::optional<CalibrationStore::Outcome> saving_;
};

}  // namespace camera_self_calibration
