#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace camera_self_calibration {

/// The folder that a run of calibrate_bag writes its results into. Made before the work rather than
/// after it, so that one that cannot be made is known at once; gone again where nothing came of it.
class ResultsFolder {
 public:
  /// Nothing for an empty path. Throws std::runtime_error where the folder holds files that results
  /// would replace but not those of an earlier run, and std::filesystem::filesystem_error where it
  /// cannot be made.
  explicit ResultsFolder(const std::string& path);
  /// Removes what it has made and what is still empty.
  ~ResultsFolder();
  ResultsFolder(const ResultsFolder&) = delete;
  ResultsFolder& operator=(const ResultsFolder&) = delete;

 private:
  std::vector<std::filesystem::path> made_;  // innermost first
};

/// Whether `file` lies in `folder` or below it; false for an empty folder.
bool liesIn(const std::string& file, const std::string& folder);

}  // namespace camera_self_calibration
