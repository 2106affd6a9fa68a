#include "camera_self_calibration/tools/bag_state.h"

#include <stdexcept>

#include "camera_self_calibration/fleet/state_solution.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/pipeline/state_file.h"

namespace camera_self_calibration {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw std::runtime_error("the state file " + path + " is left untouched: " + why +
                           ". Choose another file, or --overwrite");
}

// Of a state file, whole or damaged, or of none.
FileContents ownContents(const std::string& path) {
  FileContents contents = readFile(path);
  if (!contents.exists || beginsAsState(contents.bytes)) return contents;
  throw std::runtime_error("the file " + path +
                           " is left untouched: it is not a state file of this program. Choose " +
                           "another file");
}

// What the run said last rather than what the segments say alone: a lens that drifts, a model that
// does not fit, an error that grew beyond the limit.
void addReport(const CalibrationReport& report, BagRecord* record) {
  record->state = report.state;
  record->lens_changes = report.epoch;
  record->misfit_px = report.lens_fit.misfit.rms;
  record->uncertainty_px = report.uncertainty.rms;
  if (report.covariance.rows() != record->lens.estimatedCount()) return;
  record->lens = report.camera;
  record->covariance = report.covariance;
}

}  // namespace

std::shared_ptr<const LearntState> stateOfBag(const Recording& recording, const std::string& bag,
                                              const std::string& camera) {
  if (!recording.learnt || !recording.complete) return nullptr;
  std::optional<BagRecord> record = recordOf(*recording.learnt);
  if (!record) return nullptr;
  record->bag = bag;
  record->camera = camera;
  record->begin_ns = recording.begin_ns;
  record->end_ns = recording.end_ns;
  record->images = recording.frames;
  addReport(recording.final_report, &*record);
  auto state = std::make_shared<LearntState>(*recording.learnt);
  state->state = record->state;
  state->bags = {*record};
  return state;
}

void refuseForeignFile(const std::string& path) { ownContents(path); }

std::shared_ptr<const LearntState> finishedState(const std::string& path, const std::string& bag,
                                                 const std::string& camera) {
  const FileContents contents = ownContents(path);
  if (!contents.exists) return nullptr;
  const DecodedState decoded = decodeState(contents.bytes);
  if (!decoded.state) refuse(path, decoded.error);
  const std::vector<BagRecord>& bags = decoded.state->bags;
  if (bags.size() != 1 || bags[0].bag != bag || bags[0].camera != camera) {
    refuse(path, bags.empty() ? "it was learnt live"
                              : "it holds what " + bags[0].bag + " contributes for the camera '" +
                                    bags[0].camera + "'");
  }
  return decoded.state;
}

void writeState(const std::string& path, const LearntState& state) {
  const std::string error = writeFileAtomically(path, encode(state));
  if (!error.empty()) throw std::runtime_error(error);
}

}  // namespace camera_self_calibration
