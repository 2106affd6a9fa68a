#include "camera_self_calibration/tools/results_folder.h"

#include <fstream>
#include <stdexcept>

#include "camera_self_calibration/tools/json.h"

namespace camera_self_calibration {
namespace {

namespace fs = std::filesystem;

// Every run writes this one, which tells its folder from others.
constexpr const char* kSummary = "summary.json";
// The others that a run may write, of one camera or of a rig.
constexpr const char* kResults[] = {
    "calibration.yaml",    "camchain.yaml",         "left.yaml",           "right.yaml",
    "trajectory.tum",      "keyframes.tum",         "convergence.csv",     "report.html",
    "fig4_parameters.png", "fig5_focal_length.png", "fig7_queue_sizes.png"};

void refuseForeignFolder(const fs::path& folder) {
  if (fs::exists(folder / kSummary)) return;
  for (const char* name : kResults) {
    if (!fs::exists(folder / name)) continue;
    throw std::runtime_error((folder / name).string() +
                             " would be replaced, but is not the result of an earlier run (no " +
                             kSummary + " is beside it). Give another folder to --out");
  }
}

// Folders of the same names beside the results of one camera are of other runs.
bool holdsRig(const fs::path& folder) {
  std::ifstream file(folder / kSummary);
  return Json::parse(file, nullptr, false).contains("rig_from_camera");
}

void removeNamed(const fs::path& folder) {
  for (const char* name : kResults) fs::remove(folder / name);
}

void removeCameras(const fs::path& folder) {
  for (int c = 0;; ++c) {
    const fs::path camera = folder / cameraFolder(c);
    if (!fs::exists(camera / kSummary)) return;
    removeNamed(camera);
    fs::remove(camera / kSummary);
    std::error_code not_empty;
    fs::remove(camera, not_empty);
  }
}

}  // namespace

ResultsFolder::ResultsFolder(const std::string& path, int cameras) {
  if (path.empty()) return;
  refuseForeignFolder(path);
  for (int c = 0; c < cameras; ++c) refuseForeignFolder(fs::path(path) / cameraFolder(c));
  for (fs::path missing = path; !missing.empty() && !fs::exists(missing);
       missing = missing.parent_path()) {
    made_.push_back(missing);
  }
  fs::create_directories(path);
}

ResultsFolder::~ResultsFolder() {
  std::error_code not_empty;
  for (const fs::path& folder : made_) fs::remove(folder, not_empty);
}

std::string cameraFolder(int camera) { return "cam" + std::to_string(camera); }

void removeResults(const std::string& folder) {
  if (!fs::exists(fs::path(folder) / kSummary)) return;
  // The summary stays until it is replaced: without it the folder would not be known as one of
  // results, should this run end before it has written its own.
  if (holdsRig(folder)) removeCameras(folder);
  removeNamed(folder);
}

bool liesIn(const std::string& file, const std::string& folder) {
  if (folder.empty()) return false;
  const fs::path from_folder =
      fs::weakly_canonical(file).lexically_relative(fs::weakly_canonical(folder));
  return !from_folder.empty() && *from_folder.begin() != "..";
}

}  // namespace camera_self_calibration
