#include "camera_self_calibration/rig_node/rig_store.h"

#include <exception>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/pipeline/state_file.h"
#include "camera_self_calibration/ros/calibration_url.h"
#include "camera_self_calibration/tools/rig_files.h"
#include "camera_self_calibration/tools/rig_state.h"

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
                         .path),
      names_(options.camera_names) {
  const std::vector<std::string>& urls = options.camera_info_urls;
  const std::string folder = resolvePath(options.state_folder, toCameraName(name)).path;
  if (!folder.empty()) rig_file_ = folder + "/rig.json";
  const bool infos = !urls.empty() || fallback;
  for (std::size_t c = 0; c < topics_.size() && (infos || !folder.empty()); ++c) {
    StoreOptions store;
    store.camera_name = options.camera_names[c];
    if (infos) {
      store.calibration_file =
          resolveCalibrationUrl(urls.empty() ? "" : urls[c], store.camera_name).path;
    }
    if (!folder.empty()) store.state_file = folder + "/" + store.camera_name + ".state";
    stores_.push_back(std::make_unique<CalibrationStore>(store));
  }
}

// All that is refused is refused here, so that it is not written over either.
RigStore::Loaded RigStore::loadRig() const {
  if (rig_file_.empty()) return {};
  const FileContents contents = readFile(rig_file_);
  if (!contents.exists) return {};
  const auto refused = [this](const std::string& why) {
    return Loaded{std::nullopt, "",
                  "the rig in " + rig_file_ + " is not used: " + why +
                      "; it is left untouched: move it away or choose another ~state_folder"};
  };
  if (!contents.error.empty()) return refused(contents.error);
  DecodedRigState decoded = decodeRigState(contents.bytes);
  if (!decoded.state) return refused(decoded.error);
  if (decoded.state->cameras != names_) return refused("it is of cameras with other names");
  return {std::move(decoded.state->estimate), "the rig in " + rig_file_ + " is the start", ""};
}

CalibrationStore::Loaded RigStore::loadCamera(int camera, std::optional<CameraModel> model,
                                              int width, int height) {
  if (rig_file_.empty()) return {};
  return stores_[camera]->load(model, width, height);
}

std::string RigStore::saveRig(const RigReport& report) const {
  const std::string refusal = loadRig().problem;
  if (!refusal.empty()) return refusal;
  return writeFileAtomically(rig_file_, encode(RigState{names_, report.estimate}));
}

std::vector<std::string> RigStore::notes(const RigReport& report) const {
  if (camchain_file_.empty()) return {};
  try {
    return camchainNotes(report.estimate.rig, camchain_file_);
  } catch (const std::exception&) {
    return {};  // Said by save().
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
  try {
    return writeFileAtomically(camchain_file_, rigCamchain(report.estimate.rig, topics_,
                                                           kMark + scaleNote(report.estimate)));
  } catch (const std::exception& e) {
    return camchain_file_ + " has no model for a lens: " + e.what();
  }
}

CalibrationStore::Outcome RigStore::save(
    const RigReport& report, const std::vector<sensor_msgs::CameraInfo>& infos,
    const std::vector<std::shared_ptr<const LearntState>>& states) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (report.state != CalibrationState::kConverged) {
    return {false, "not saved: the rig is not CONVERGED: " + report.sentence, true};
  }
  for (std::size_t c = 0; c < states.size() && !rig_file_.empty(); ++c) {
    if (states[c] && states[c]->epoch == report.cameras[c].epoch) continue;
    return {false, "not saved: camera " + names_[c] + " has not learnt its lens yet", true};
  }
  std::string written;
  std::string failed;
  const auto note = [](const std::string& what, std::string* list) {
    *list += (list->empty() ? "" : "; ") + what;
  };
  for (std::size_t c = 0; c < stores_.size(); ++c) {
    const CalibrationStore::Outcome outcome = rig_file_.empty()
                                                  ? stores_[c]->saveGiven(std::nullopt, infos[c])
                                                  : stores_[c]->save(*states[c], infos[c]);
    note(outcome.message, outcome.success ? &written : &failed);
  }
  if (!camchain_file_.empty()) {
    const std::string error = saveCamchain(report);
    note(error.empty() ? "saved to " + camchain_file_ : "not saved: " + error,
         error.empty() ? &written : &failed);
  }
  if (!rig_file_.empty()) {
    const std::string error = saveRig(report);
    note(error.empty() ? "saved to " + rig_file_ : "not saved: " + error,
         error.empty() ? &written : &failed);
  }
  return {failed.empty(), failed + (failed.empty() || written.empty() ? "" : "; ") + written};
}

}  // namespace camera_self_calibration
