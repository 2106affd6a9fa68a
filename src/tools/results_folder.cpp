#include "camera_self_calibration/tools/results_folder.h"

#include <stdexcept>

namespace camera_self_calibration {
namespace {

namespace fs = std::filesystem;

// Every run writes this one, which tells its folder from others.
constexpr const char* kSummary = "summary.json";

void refuseForeignFolder(const fs::path& folder) {
  if (fs::exists(folder / kSummary)) return;
  for (const char* name : {"calibration.yaml", "camchain.yaml", "left.yaml", "right.yaml",
                           "trajectory.tum", "keyframes.tum", "convergence.csv", "report.html"}) {
    if (!fs::exists(folder / name)) continue;
    throw std::runtime_error((folder / name).string() +
                             " would be replaced, but is not the result of an earlier run (no " +
                             kSummary + " is beside it). Give another folder to --out");
  }
}

}  // namespace

ResultsFolder::ResultsFolder(const std::string& path) {
  if (path.empty()) return;
  refuseForeignFolder(path);
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

bool liesIn(const std::string& file, const std::string& folder) {
  if (folder.empty()) return false;
  const fs::path from_folder =
      fs::weakly_canonical(file).lexically_relative(fs::weakly_canonical(folder));
  return !from_folder.empty() && *from_folder.begin() != "..";
}

}  // namespace camera_self_calibration
