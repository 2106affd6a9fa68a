#include "camera_self_calibration/rig_node/rig_store.h"

#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/ros/calibration_url.h"
#include "camera_self_calibration/tools/rig_files.h"

namespace camera_self_calibration {
namespace {

// The comment in the first line tells our files from others.
const std::string kMark = "Written by camera_self_calibration. ";

}  // namespace

RigStore::RigStore(const RigNodeOptions& options, const std::string& name, bool fallback)
    : topics_(options.image_topics),
      camchain_file_(resolvePath(options.camchain_file.empty() && fallback
                                     ? "camchain_" + toCameraName(name) + ".yaml"
                                     : options.camchain_file,
                                 toCameraName(name))
                         .path) {
  const std::vector<std::string>& urls = options.camera_info_urls;
  for (std::size_t c = 0; c < topics_.size() && (!urls.empty() || fallback); ++c) {
    StoreOptions store;
    store.camera_name = options.camera_names[c];
    store.calibration_file =
        resolveCalibrationUrl(urls.empty() ? "" : urls[c], store.camera_name).path;
    stores_.push_back(std::make_unique<CalibrationStore>(store));
  }
}

// Empty, or what went wrong.
std::string RigStore::saveCamchain(const RigReport& report) const {
  const FileContents present = readFile(camchain_file_);
  if (present.exists && present.bytes.rfind("# " + kMark, 0) != 0) {
    return camchain_file_ +
           " exists and was not written by this program. It is left untouched: "
           "move it away, or set ~camchain_file to another file";
  }
  return writeFileAtomically(camchain_file_, rigCamchain(report.estimate.rig, topics_,
                                                         kMark + scaleNote(report.estimate)));
}

CalibrationStore::Outcome RigStore::save(const RigReport& report,
                                         const std::vector<sensor_msgs::CameraInfo>& infos) {
  if (report.state != CalibrationState::kConverged) {
    return {false, "not saved: the rig is not CONVERGED: " + report.sentence};
  }
  std::string written;
  std::string failed;
  const auto note = [](const std::string& what, std::string* list) {
    *list += (list->empty() ? "" : "; ") + what;
  };
  for (std::size_t c = 0; c < stores_.size(); ++c) {
    const CalibrationStore::Outcome outcome = stores_[c]->saveGiven(std::nullopt, infos[c]);
    note(outcome.message, outcome.success ? &written : &failed);
  }
  if (!camchain_file_.empty()) {
    const std::string error = saveCamchain(report);
    note(error.empty() ? "saved to " + camchain_file_ : "not saved: " + error,
         error.empty() ? &written : &failed);
  }
  return {failed.empty(), failed + (failed.empty() || written.empty() ? "" : "; ") + written};
}

}  // namespace camera_self_calibration
