#include "camera_self_calibration/ros/calibration_store.h"

#include <camera_calibration_parsers/parse_yml.h>

#include <cmath>
#include <exception>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/pipeline/state_file.h"
#include "camera_self_calibration/ros/calibration_yaml.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "camera_self_calibration/ros/model_conversion.h"

namespace camera_self_calibration {
namespace {

std::optional<NamedCameraInfo> parse(const std::string& text, std::string* problem) {
  try {
    return parseCalibrationYaml(text);
  } catch (const std::exception& e) {
    *problem = e.what();
    return std::nullopt;
  }
}

// Moved or removed by the user, not by this program.
const char* const kLeftUntouched = "; it is left untouched: move it away or choose another file";

}  // namespace

CalibrationStore::Loaded CalibrationStore::load(std::optional<CameraModel> model, int width,
                                                int height) {
  const std::lock_guard<std::mutex> lock(mutex_);
  Loaded loaded;
  loaded_ = true;
  loaded_model_ = model;
  const KnownState state = readState(model, width, height);
  if (state.state) {
    loaded.state = state.state;
    loaded.notes.push_back("what was learnt before is restored from " + options_.state_file);
  }
  const KnownCalibration calibration = readCalibration(model, width, height);
  if (calibration.start) {
    const CameraFit& fit = *calibration.start;
    loaded.camera = fit.camera;
    loaded.notes.push_back("the calibration in " + options_.calibration_file + " is the start" +
                           (fit.error.max > 0.0
                                ? ", fitted to the model " + toString(fit.camera.model()) +
                                      " within " + formatted("%.3g px", fit.error.max)
                                : ""));
  }
  for (const std::string& problem : {state.refusal, calibration.refusal}) {
    if (!problem.empty()) loaded.problems.push_back(problem);
  }
  return loaded;
}

CalibrationStore::KnownState CalibrationStore::readState(std::optional<CameraModel> model,
                                                         int width, int height) const {
  if (options_.state_file.empty()) return {};
  const FileContents contents = readFile(options_.state_file);
  if (!contents.exists) return {};
  const auto refused = [this](const std::string& why) {
    return KnownState{
        nullptr, "the state file " + options_.state_file + " is not used: " + why + kLeftUntouched};
  };
  if (!contents.error.empty()) return refused(contents.error);
  const DecodedState decoded = decodeState(contents.bytes);
  if (!decoded.state) return refused(decoded.error);
  const Camera& camera = decoded.state->camera;
  if (model && camera.model() != *model) {
    return refused("it is for the model " + toString(camera.model()) + ", not " + toString(*model));
  }
  if (camera.width() != width || camera.height() != height) {
    return refused("it is for images of " + sizeText(camera.width(), camera.height()) +
                   ", these are " + sizeText(width, height));
  }
  return {decoded.state, ""};
}

// All that is refused is refused here, so that load() and save() cannot be of two minds.
CalibrationStore::KnownCalibration CalibrationStore::readCalibration(
    std::optional<CameraModel> model, int width, int height) const {
  const std::string& path = options_.calibration_file;
  if (path.empty()) return {};
  const FileContents contents = readFile(path);
  if (!contents.exists) return {};
  const auto refused = [&path](const std::string& why) {
    return KnownCalibration{
        std::nullopt, "the calibration file " + path + " is not used: " + why + kLeftUntouched};
  };
  if (!contents.error.empty()) return refused(contents.error);
  std::string problem;
  const std::optional<NamedCameraInfo> named = parse(contents.bytes, &problem);
  if (!named) {
    return refused("it is no calibration that camera_info_manager can read: " + problem);
  }
  if (named->name != options_.camera_name) {
    return refused("it is for the camera '" + named->name + "', this one has the name '" +
                   options_.camera_name + "'");
  }
  const auto file_width = static_cast<int>(named->info.width);
  const auto file_height = static_cast<int>(named->info.height);
  if (file_width != width || file_height != height) {
    return refused("it is for images of " + sizeText(file_width, file_height) + ", these are " +
                   sizeText(width, height));
  }
  const std::optional<CameraFit> start = startFrom(named->info, model);
  if (!start) return refused(whyNoStart(named->info, model));
  return {start, "", isOfAPair(named->info) ? contents.bytes : ""};
}

CalibrationStore::Outcome CalibrationStore::save(const LearntState& state,
                                                 const sensor_msgs::CameraInfo& info) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::string written;
  std::string failed;
  const auto note = [&](const std::string& path, const std::string& error) {
    std::string& text = error.empty() ? written : failed;
    text += (text.empty() ? "" : "; ") + (error.empty() ? path : error);
  };
  if (!options_.calibration_file.empty()) {
    note(options_.calibration_file, saveCalibration(judgedBy(state), info));
  }
  if (!options_.state_file.empty()) note(options_.state_file, saveState(state));
  if (written.empty() && failed.empty()) {
    return {false, "no file is given: set ~camera_info_url or ~state_file"};
  }
  if (failed.empty()) return {true, "saved to " + written};
  return {false, "not saved: " + failed + (written.empty() ? "" : "; saved to " + written)};
}

CalibrationStore::Outcome CalibrationStore::saveGiven(std::optional<CameraModel> model,
                                                      const sensor_msgs::CameraInfo& info) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const std::string& path = options_.calibration_file;
  if (path.empty()) {
    return {false, "not saved: set ~camera_info_url to keep it for the next start"};
  }
  std::string error = saveCalibration(model, info);
  if (error.empty()) error = putStateAside(model, info);
  return {error.empty(), error.empty() ? "saved to " + path : "not saved: " + error};
}

std::string CalibrationStore::putStateAside(std::optional<CameraModel> model,
                                            const sensor_msgs::CameraInfo& info) {
  const std::string& path = options_.state_file;
  const KnownState known =
      readState(model, static_cast<int>(info.width), static_cast<int>(info.height));
  if (!known.state) return "";  // what is refused is not preferred either
  std::error_code error;
  std::filesystem::rename(path, path + ".previous", error);
  if (error) return "cannot rename " + path + ": " + error.message();
  keep_previous_ = false;
  return "";
}

// What load() refused is not written over, and what it took is.
std::optional<CameraModel> CalibrationStore::judgedBy(const LearntState& state) const {
  return loaded_ ? loaded_model_ : state.camera.model();
}

void CalibrationStore::beginAnew() {
  const std::lock_guard<std::mutex> lock(mutex_);
  keep_previous_ = true;
}

std::string CalibrationStore::saveState(const LearntState& state) {
  const std::string& path = options_.state_file;
  const KnownState known = readState(judgedBy(state), state.camera.width(), state.camera.height());
  if (!known.refusal.empty()) return known.refusal;
  if (known.state && (keep_previous_ || state.epoch != known.state->epoch)) {
    // What was learnt of another lens, or before a reset, is not lost.
    const std::string error = writeFileAtomically(path + ".previous", encode(*known.state));
    if (!error.empty()) return error;
  }
  const std::string error = writeFileAtomically(path, encode(state));
  if (!error.empty()) return error;
  keep_previous_ = false;
  return "";
}

std::string CalibrationStore::saveCalibration(std::optional<CameraModel> model,
                                              const sensor_msgs::CameraInfo& info) {
  if (!isCalibrated(info)) return kUncalibrated;
  const std::string& path = options_.calibration_file;
  const KnownCalibration known =
      readCalibration(model, static_cast<int>(info.width), static_cast<int>(info.height));
  if (!known.refusal.empty()) return known.refusal;
  std::string problem;
  std::ostringstream text;
  text.precision(17);
  if (!camera_calibration_parsers::writeCalibrationYml(text, options_.camera_name, info) ||
      !parse(text.str(), &problem)) {
    return "the calibration cannot be put into the format of " + path;
  }
  if (!known.of_a_pair.empty() && !isOfAPair(info)) {
    const std::string error = writeFileAtomically(path + ".previous", known.of_a_pair);
    if (!error.empty()) return error;
  }
  return writeFileAtomically(path, text.str());
}

}  // namespace camera_self_calibration
