#pragma once

#include <cstdlib>
#include <filesystem>

namespace camera_self_calibration {

/// Where the tests on real video look for it: the folder that the environment variable
/// SELFCAL_VIDEOS names, else the one of the build.
inline std::filesystem::path videoFolder() {
  const char* const named = std::getenv("SELFCAL_VIDEOS");
  return named != nullptr ? named : SELFCAL_VIDEO_FOLDER;
}

}  // namespace camera_self_calibration
