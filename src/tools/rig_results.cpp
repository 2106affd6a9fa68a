#include "camera_self_calibration/tools/rig_results.h"

#include <camera_calibration_parsers/parse_yml.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/tools/calibration_format.h"
#include "camera_self_calibration/tools/report_text.h"
#include "camera_self_calibration/tools/results_folder.h"
#include "camera_self_calibration/tools/rig_files.h"
#include "camera_self_calibration/tools/trajectory_results.h"

namespace camera_self_calibration {
namespace {

namespace fs = std::filesystem;

Json vectorJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json placeJson(const RigRecording& recording, int c) {
  const RigEstimate& estimate = recording.estimate;
  const PlaceInRig& place = estimate.places[c];
  const Rigid3& pose = estimate.rig.rig_from_camera[c];
  const Eigen::Quaterniond& q = pose.rotation;
  const bool known = c == 0 || place.position_known;
  const Eigen::Vector3d& t = pose.translation;
  return {
      {"topic", recording.topics[c]},
      {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}},
      {"rotation_vector_deg", vectorJson(logSo3(q) / kDegree)},
      {"rotation_vector_sigma_deg", vectorJson(sigmasOf(place.rotation_covariance) / kDegree)},
      {"position", known ? vectorJson(t) : Json()},
      {"position_sigma", known ? vectorJson(sigmasOf(place.position_covariance)) : Json()},
      {"direction_sigma_deg", known && c > 0 ? Json(place.directionSigma(t) / kDegree) : Json()},
      {"time_offset_s", c > 0 ? Json(place.time_offset.seconds) : Json()},
      {"time_offset_sigma_s", c > 0 ? Json(place.time_offset.sigma) : Json()},
      {"shared_landmarks", place.shared_landmarks}};
}

Json changeJson(const RigRecording& recording, const MountChange& change) {
  return {
      {"type", toString(EventType::kMountChanged)},
      {"camera", change.camera},
      {"topic", recording.topics[change.camera]},
      {"sentence", change.sentence},
      {"onset_stamp", toSeconds(change.onset_ns)},
      {"rotation_deg", change.angle() / kDegree},
      {"rotation_sigma_deg", change.angleSigma() / kDegree},
      {"rotation_vector_deg", vectorJson(change.rotation / kDegree)},
      {"rotation_vector_sigma_deg", vectorJson(sigmasOf(change.rotation_covariance) / kDegree)},
      {"shift", change.shift_known ? vectorJson(change.shift) : Json()},
      {"shift_sigma", change.shift_known ? vectorJson(sigmasOf(change.shift_covariance)) : Json()},
      {"p_value", change.p_value}};
}

Json distanceJson(const AuditDistance& distance) {
  return {{"distance_px", distance.px},
          {"sigma_px", distance.sigma_px},
          {"at_most_px", distance.at_most_px},
          {"p_value", distance.p_value}};
}

Json placeAuditJson(const PlaceAudit& place) {
  return {{"verdict", toString(place.verdict)},
          {"sentence", place.sentence},
          {"hint", place.hint},
          {"turn_deg", place.turn_deg},
          {"turn", distanceJson(place.turn)},
          {"shift_deg", place.shift_judged ? Json(place.shift_deg) : Json()},
          {"shift", place.shift_judged ? distanceJson(place.shift) : Json()}};
}

// Of the places; what is said of the lenses stands in the folders of the cameras.
Json rigAuditJson(const RigAudit& audit) {
  Json lenses = Json::array();
  for (const AuditReport& lens : audit.lenses) lenses.push_back(toString(lens.verdict));
  Json places = Json::array();
  for (const PlaceAudit& place : audit.places) places.push_back(placeAuditJson(place));
  return {{"verdict", toString(audit.verdict())}, {"lenses", lenses}, {"places", places}};
}

void writeFile(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  std::ofstream file(path);
  write(file);
  if (!file.flush()) throw std::runtime_error(path.string() + " cannot be written");
}

void writeInfo(const fs::path& path, const std::string& name, const sensor_msgs::CameraInfo& info,
               const std::string& comment) {
  writeFile(path, [&](std::ostream& file) {
    if (!comment.empty()) file << "# " << comment << '\n';
    if (!camera_calibration_parsers::writeCalibrationYml(file, name, info)) {
      throw std::runtime_error(path.string() + " cannot be written");
    }
  });
}

std::vector<std::string> writePair(const fs::path& folder, const RigRecording& recording) {
  const RigEstimate& estimate = recording.estimate;
  std::string problem;
  const auto pair = stereoPair(estimate.rig, &problem);
  if (!pair) return {asSentence(problem)};
  std::vector<std::string> notes = {
      formatted("left.yaml is of %s, right.yaml of %s, for stereo_image_proc%s.",
                recording.topics[pair->left].c_str(), recording.topics[pair->right].c_str(),
                estimate.metric ? "" : "; its depths are in baselines")};
  const auto write = [&](const std::string& name, int camera, const sensor_msgs::CameraInfo& info,
                         const PixelError& error) {
    writeInfo(folder / (name + ".yaml"), name, info, fitNote(estimate.rig.cameras[camera], error));
    const std::string note = stereoNote(name + ".yaml", info, error);
    if (!note.empty()) notes.push_back(note);
  };
  write("left", pair->left, pair->left_info, pair->left_error);
  write("right", pair->right, pair->right_info, pair->right_error);
  return notes;
}

std::vector<std::string> writeCalibration(const fs::path& folder, const RigRecording& recording) {
  if (!recording.converged()) return {};
  const RigEstimate& estimate = recording.estimate;
  const std::string chain = rigCamchain(estimate.rig, recording.topics, scaleNote(estimate));
  writeFile(folder / "camchain.yaml", [&chain](std::ostream& file) { file << chain; });
  std::vector<std::string> notes = camchainNotes(estimate.rig, "camchain.yaml");
  for (const std::string& note : writePair(folder, recording)) notes.push_back(note);
  return notes;
}

std::string auditText(const RigAudit& audit) {
  std::string text = "audit of the rig: " + toString(audit.verdict()) + ":";
  for (std::size_t c = 0; c < audit.lenses.size(); ++c) {
    text += formatted(" The lens of camera %zu: %s.", c, toString(audit.lenses[c].verdict).c_str());
  }
  for (const PlaceAudit& place : audit.places) {
    text += " " + sentencesOf(place.sentence, place.hint);
  }
  return text + '\n';
}

}  // namespace

std::string rigText(const RigRecording& recording) {
  std::string text;
  if (!recording.complete) text += std::string(kPartial) + '\n';
  text += "rig: " + rigState(recording) + ": " + asSentence(recording.estimate.sentence) + '\n';
  for (const MountChange& change : recording.mount_changes) {
    text += toString(EventType::kMountChanged) + ": " + asSentence(change.sentence) + '\n';
  }
  if (!recording.estimate.hint.empty()) text += asSentence(recording.estimate.hint) + '\n';
  for (std::size_t c = 0; c < recording.cameras.size(); ++c) {
    text += formatted("\ncamera %zu, %s\n", c, recording.topics[c].c_str());
    text += reportText(recording.cameras[c]);
  }
  if (recording.audit) text += '\n' + auditText(*recording.audit);
  return text;
}

std::string rigTrajectoryText(const std::optional<TrajectoryDifference>& difference, bool metric) {
  if (!difference) return {};
  return kTrajectoryHeading + truthText("from the ground truth", difference) +
         formatted("  scale %.4f%s\n", difference->scale,
                   metric ? " (1 where the baseline is right)" : "");
}

Json rigJson(const RigRecording& recording) {
  const RigEstimate& estimate = recording.estimate;
  Json places = Json::array();
  for (int c = 0; estimate.usable && c < estimate.rig.size(); ++c) {
    places.push_back(placeJson(recording, c));
  }
  Json changes = Json::array();
  for (const MountChange& change : recording.mount_changes) {
    changes.push_back(changeJson(recording, change));
  }
  Json json = {{"state", rigState(recording)},       {"complete", recording.complete},
               {"sentence", estimate.sentence},      {"hint", estimate.hint},
               {"metric", estimate.metric},          {"length_unit", lengthUnit(estimate)},
               {"rig_from_camera", places},          {"mount_changes", changes},
               {"keyframes", estimate.poses.size()}, {"observations", estimate.observations}};
  if (recording.audit) json["audit"] = rigAuditJson(*recording.audit);
  return json;
}

std::string rigState(const RigRecording& recording) {
  return recording.estimate.usable ? toString(recording.state()) : "UNKNOWN";
}

std::vector<std::string> writeRig(const std::string& folder, const RigRecording& recording) {
  removeResults(folder);
  const fs::path path(folder);
  std::vector<std::string> notes;
  for (std::size_t c = 0; c < recording.cameras.size(); ++c) {
    const std::string name = cameraFolder(static_cast<int>(c));
    fs::create_directories(path / name);
    for (const std::string& note :
         writeRecording((path / name).string(), recording.topics[c], recording.cameras[c])) {
      notes.push_back(name + ": " + note);
    }
  }
  writeFile(path / "trajectory.tum", [&](std::ostream& file) {
    writeTrajectory(recording.poses, recording.complete, lengthUnit(recording.estimate), file);
  });
  const std::vector<std::string> more = writeCalibration(path, recording);
  notes.insert(notes.end(), more.begin(), more.end());
  writeFile(path / "summary.json", [&](std::ostream& file) { file << toText(rigJson(recording)); });
  return notes;
}

}  // namespace camera_self_calibration
