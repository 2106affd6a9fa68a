#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace camera_self_calibration {

/// The folder that a run of calibrate_bag writes its results into. Made before the work rather than
/// after it, so that one that cannot be made is known at once; gone again where nothing came of it.
class ResultsFolder {
 public:
  /// Nothing for an empty path; `cameras`: of a rig. Throws std::runtime_error where the folder, or
  /// that of a camera, holds files that results would replace but not those of an earlier run, and
  /// std::filesystem::filesystem_error where it cannot be made.
  explicit ResultsFolder(const std::string& path, int cameras = 0);
  /// Removes what it has made and what is still empty.
  ~ResultsFolder();
  ResultsFolder(const ResultsFolder&) = delete;
  ResultsFolder& operator=(const ResultsFolder&) = delete;

 private:
  std::vector<std::filesystem::path> made_;  // innermost first
};

/// Where the results of one camera go, in the folder of the rig.
std::string cameraFolder(int camera);

/// Removes what an earlier run wrote into this folder, and what it wrote of the cameras of a rig,
/// so that no older file passes for a result of the next run. Only summary.json stays, to be
/// replaced. Nothing where there is none. Throws std::filesystem::filesystem_error.
void removeResults(const std::string& folder);

/// Whether `file` lies in `folder` or below it; false for an empty folder.
bool liesIn(const std::string& file, const std::string& folder);

}  // namespace camera_self_calibration
