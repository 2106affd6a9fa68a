// The files of a fleet: see fleet_results.h.

#include <cmath>
#include <filesystem>
#include <iomanip>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/pipeline/state_file.h"
#include "camera_self_calibration/plotting/contribution_chart.h"
#include "camera_self_calibration/tools/bag_state.h"
#include "camera_self_calibration/tools/calibration_file.h"
#include "camera_self_calibration/tools/fleet_results.h"
#include "camera_self_calibration/tools/json.h"
#include "csv_text.h"

namespace camera_self_calibration {
namespace {

namespace fs = std::filesystem;

void writeText(const fs::path& path, const std::string& text) {
  const std::string error = writeFileAtomically(path.string(), text);
  if (!error.empty()) throw std::runtime_error(error);
}

// The last one has no number.
std::string stemOf(const CameraHistory& history, int epoch) {
  const bool last = epoch + 1 == history.epochs();
  return fileStem(history.name) + (last ? "" : ".epoch" + std::to_string(epoch + 1));
}

// NAME and NAME.epoch1, NAME.epoch2, ..., as stemOf has them.
bool isEpochOf(const std::string& name, const std::string& stem) {
  if (stem == name) return true;
  const std::string before = name + ".epoch";
  return stem.compare(0, before.size(), before) == 0 && stem.size() > before.size() &&
         stem.find_first_not_of("0123456789", before.size()) == std::string::npos;
}

// States and calibrations of all epochs of the camera that the folder has.
std::vector<fs::path> epochFiles(const fs::path& folder, const std::string& camera) {
  const fs::path stem = folder / fileStem(camera);
  std::vector<fs::path> files;
  if (!fs::is_directory(stem.parent_path())) return files;
  for (const fs::directory_entry& entry : fs::directory_iterator(stem.parent_path())) {
    const fs::path extension = entry.path().extension();
    if (extension != ".state" && extension != ".yaml") continue;
    if (isEpochOf(stem.filename(), entry.path().stem())) files.push_back(entry.path());
  }
  return files;
}

// After all is written, so that what was learnt is always in some file. A state goes only where
// every epoch has a solution: else it may be all that is left of a bag.
void removeEarlier(const fs::path& folder, const std::string& camera,
                   const std::set<fs::path>& written, bool solved) {
  for (const fs::path& file : epochFiles(folder, camera)) {
    if (written.count(file) > 0 || (file.extension() == ".state" && !solved)) continue;
    fs::remove(file);
  }
}

// Returns what the calibration file has in place of the lens; empty if it has the lens, or there is
// no file.
std::string writeEpoch(const fs::path& folder, const std::string& stem, const std::string& camera,
                       const EpochSolution& solution, std::set<fs::path>* written) {
  if (!solution.learnt) return {};
  const fs::path state = folder / (stem + ".state");
  writeState(state.string(), *solution.learnt);
  written->insert(state);
  if (solution.health.state != CalibrationState::kConverged) return {};
  CalibrationLabels labels;
  labels.camera_name = camera;
  const fs::path calibration = folder / (stem + ".yaml");
  const Camera& lens = solution.learnt->camera;
  const CameraFit fit =
      writeCalibration(calibration.string(), lens, CalibrationFormat::kRos, labels);
  written->insert(calibration);
  return approximationNote(stem + ".yaml", lens, CalibrationFormat::kRos, fit);
}

std::string valuesText(const Camera& lens, const IntrinsicsMatrix& covariance) {
  std::string text;
  for (Eigen::Index i = 0; i < lens.estimatedCount(); ++i) {
    text += "," + exactText(lens.parameters()(i));
  }
  for (Eigen::Index i = 0; i < lens.estimatedCount(); ++i) {
    text += "," + exactText(std::sqrt(covariance(i, i)));
  }
  return text;
}

std::string historyHeader(const Camera& lens) {
  const std::vector<std::string> all = lens.parameterNames();
  std::string names, sigmas;
  for (Eigen::Index i = 0; i < lens.estimatedCount(); ++i) {
    const std::string& name = all[static_cast<std::size_t>(i)];
    names += "," + name;
    sigmas += ",sigma_" + name;
  }
  return "begin,end,epoch" + names + sigmas + ",pixel_uncertainty_rms,state,of\n";
}

std::string historyRow(std::int64_t begin_ns, std::int64_t end_ns, int epoch, const Camera& lens,
                       const IntrinsicsMatrix& covariance, double uncertainty_px,
                       CalibrationState state, const std::string& of) {
  return stampText(begin_ns) + "," + stampText(end_ns) + "," + std::to_string(epoch) +
         valuesText(lens, covariance) + "," + exactText(uncertainty_px) + "," + toString(state) +
         "," + quoted(of) + "\n";
}

// From its first bag to its last.
std::pair<std::int64_t, std::int64_t> spanOf(const CameraHistory& history, int epoch) {
  std::pair<std::int64_t, std::int64_t> span{std::numeric_limits<std::int64_t>::max(), 0};
  for (const HistoricBag& bag : history.bags) {
    if (bag.epoch != epoch) continue;
    span.first = std::min(span.first, bag.record.begin_ns);
    span.second = std::max(span.second, bag.record.end_ns);
  }
  return span;
}

// Epochs count from 1; 0: a bag that is left out.
std::string historyText(const CameraResult& camera) {
  const CameraHistory& history = camera.history;
  std::string text = historyHeader(history.lens);
  for (const HistoricBag& bag : history.bags) {
    if (!bag.problem.empty()) continue;
    text +=
        historyRow(bag.record.begin_ns, bag.record.end_ns, bag.epoch + 1, bag.used.lens,
                   bag.used.covariance, bag.used.uncertainty_px, bag.record.state, bag.record.bag);
  }
  for (int e = 0; e < history.epochs(); ++e) {
    const EpochResult& epoch = camera.epochs[static_cast<std::size_t>(e)];
    if (!epoch.solved) continue;
    const auto [begin_ns, end_ns] = spanOf(history, e);
    text += historyRow(begin_ns, end_ns, e + 1, epoch.lens, epoch.solution.covariance,
                       epoch.solution.uncertainty_px, epoch.solution.health.state, "all together");
  }
  return text;
}

void addWorth(const EpochResult& epoch, std::vector<BagWorth>* worth) {
  IntrinsicsMatrix all;
  for (const IntrinsicsMatrix& contribution : epoch.solution.contributions) {
    if (contribution.size() > 0)
      all = all.size() == 0 ? contribution : IntrinsicsMatrix(all + contribution);
  }
  for (std::size_t b = 0; b < epoch.solution.contributions.size(); ++b) {
    const IntrinsicsMatrix& contribution = epoch.solution.contributions[b];
    if (contribution.size() > 0)
      (*worth)[b].growth = contributionOf(epoch.lens, all, contribution).image;
  }
  for (const WantedSegment& segment : epoch.solution.segments) ++(*worth)[segment.bag].segments;
}

Json cameraJson(const CameraResult& camera) {
  const EpochResult& present = camera.present();
  Json values = Json::array(), sigmas = Json::array(), changes = Json::array();
  if (present.solved) {
    for (Eigen::Index i = 0; i < present.lens.estimatedCount(); ++i) {
      values.push_back(present.lens.parameters()(i));
      sigmas.push_back(std::sqrt(present.solution.covariance(i, i)));
    }
  }
  for (const EpochBoundary& change : camera.history.changes) {
    changes.push_back({{"before", toSeconds(camera.history.bags[change.first].record.begin_ns)},
                       {"p_value", change.p_value}});
  }
  return {{"camera", camera.history.name},
          {"verdict", toString(verdictOf(camera))},
          {"sentence", sentenceOf(camera)},
          {"bags", camera.history.bags.size()},
          {"epochs", camera.history.epochs()},
          {"changes", changes},
          {"model", toString(camera.history.lens.model())},
          {"values", values},
          {"sigma", sigmas},
          {"pixel_uncertainty_rms", present.solution.uncertainty_px},
          {"scatter_of_bags_px", present.solution.tau_px},
          {"sibling_p_value", camera.siblings.p_value},
          {"sibling_distance_px", camera.siblings.distance_px}};
}

// What calibrate_bag or a robot wrote, rather than a merge.
bool isOwnState(const std::string& bytes) {
  const DecodedState decoded = decodeState(bytes);
  if (!decoded.state) return false;
  const std::vector<BagRecord>& bags = decoded.state->bags;
  return bags.empty() || (bags.size() == 1 && bags[0].state_file.empty());
}

fs::path historyFile(const fs::path& folder, const std::string& camera) {
  return folder / (fileStem(camera) + ".history.csv");
}

// Why a file must stay; empty where an earlier merge has written it. Every merge writes a history
// beside its calibrations. `may_be_input`: a history may rest on it.
std::string whyItStays(const fs::path& file, const fs::path& history, bool may_be_input) {
  constexpr const char* kForeign = "no merge has written";
  const bool state = file.extension() == ".state";
  if (!state && !fs::exists(history)) return kForeign;
  const std::string bytes = readFile(file.string()).bytes;
  if (state && !beginsAsState(bytes)) return kForeign;
  return may_be_input && isOwnState(bytes) ? "holds the result of one bag" : "";
}

}  // namespace

void refuseToReplaceOthers(const std::vector<CameraHistory>& histories, const std::string& folder) {
  std::set<fs::path> states;
  // Of another machine perhaps, where this one may not look.
  std::error_code ignored;
  for (const CameraHistory& history : histories) {
    for (const HistoricBag& bag : history.bags) {
      states.insert(fs::weakly_canonical(bag.record.state_file, ignored));
    }
  }
  for (const CameraHistory& history : histories) {
    for (const fs::path& file : epochFiles(folder, history.name)) {
      const std::string why = whyItStays(file, historyFile(folder, history.name),
                                         states.count(fs::weakly_canonical(file)) > 0);
      if (why.empty()) continue;
      throw std::runtime_error("the result for the camera '" + history.name + "' would replace " +
                               file.string() + ", which " + why + ": give another folder to --out");
    }
  }
}

CameraResult writeCamera(const CameraHistory& history, const SegmentStore& store,
                         const MergeOptions& options, const std::string& folder) {
  CameraResult result;
  result.history = history;
  result.worth.resize(history.bags.size());
  for (int e = 0; e < history.epochs(); ++e) {
    EpochResult epoch;
    epoch.solution = solveEpoch(history, e, store, options);
    epoch.solved = epoch.solution.learnt != nullptr;
    if (epoch.solved) epoch.lens = epoch.solution.learnt->camera;
    addWorth(epoch, &result.worth);
    result.epochs.push_back(std::move(epoch));
  }
  writeText(historyFile(folder, history.name), historyText(result));
  // All segments are loaded: what they were read from may be replaced.
  std::set<fs::path> written;
  bool solved = true;
  for (int e = 0; e < history.epochs(); ++e) {
    EpochResult& epoch = result.epochs[static_cast<std::size_t>(e)];
    EpochSolution& solution = epoch.solution;
    epoch.approximation = writeEpoch(folder, stemOf(history, e), history.name, solution, &written);
    solved = solved && solution.learnt;
    solution.learnt.reset();
  }
  removeEarlier(folder, history.name, written, solved);
  return result;
}

void writeFleet(const std::vector<CameraResult>& cameras, const std::string& folder) {
  Json verdicts = Json::array();
  std::string bags = "camera,bag,begin,end,epoch,segments_used,error_growth_without,version\n";
  for (const CameraResult& camera : cameras) {
    verdicts.push_back(cameraJson(camera));
    for (std::size_t i = 0; i < camera.history.bags.size(); ++i) {
      const HistoricBag& bag = camera.history.bags[i];
      bags += quoted(camera.history.name) + "," + quoted(bag.record.bag) + "," +
              stampText(bag.record.begin_ns) + "," + stampText(bag.record.end_ns) + "," +
              std::to_string(bag.epoch + 1) + "," + std::to_string(camera.worth[i].segments) + "," +
              exactText(camera.worth[i].growth) + "," + quoted(bag.record.version) + "\n";
    }
  }
  writeText(fs::path(folder) / "fleet.json", toText(verdicts));
  writeText(fs::path(folder) / "bags.csv", bags);
}

}  // namespace camera_self_calibration
