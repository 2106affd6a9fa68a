#include "camera_self_calibration/tools/rig_results.h"

#include <camera_calibration_parsers/parse_yml.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/tools/json.h"
#include "camera_self_calibration/tools/report_text.h"
#include "camera_self_calibration/tools/rig_files.h"

namespace camera_self_calibration {
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = M_PI / 180.0;

std::string vectorJson(const Eigen::Vector3d& v) {
  return json::array({json::number(v.x()), json::number(v.y()), json::number(v.z())});
}

std::string lengthUnit(const RigEstimate& estimate) {
  return estimate.metric ? "m" : "distance between the first two cameras";
}

std::string placeJson(const RigRecording& recording, int c) {
  const RigEstimate& estimate = recording.estimate;
  const PlaceInRig& place = estimate.places[c];
  const Rigid3& pose = estimate.rig.rig_from_camera[c];
  const Eigen::Quaterniond& q = pose.rotation;
  const bool known = c == 0 || place.position_known;
  const Eigen::Vector3d& t = pose.translation;
  return json::object(
      {{"topic", json::string(recording.topics[c])},
       {"rotation_xyzw", json::array({json::number(q.x()), json::number(q.y()), json::number(q.z()),
                                      json::number(q.w())})},
       {"rotation_vector_deg", vectorJson(logSo3(q) / kDegree)},
       {"rotation_vector_sigma_deg",
        vectorJson(place.rotation_covariance.diagonal().cwiseMax(0.0).cwiseSqrt() / kDegree)},
       {"position", known ? vectorJson(t) : "null"},
       {"position_sigma",
        known ? vectorJson(place.position_covariance.diagonal().cwiseMax(0.0).cwiseSqrt())
              : "null"},
       {"direction_sigma_deg",
        known && c > 0 ? json::number(place.directionSigma(t) / kDegree) : "null"},
       {"time_offset_s", c > 0 ? json::number(place.time_offset.seconds) : "null"},
       {"time_offset_sigma_s", c > 0 ? json::number(place.time_offset.sigma) : "null"},
       {"shared_landmarks", json::number(static_cast<std::int64_t>(place.shared_landmarks))}});
}

std::string rigState(const RigRecording& recording) {
  return recording.converged() ? "CONVERGED" : recording.estimate.usable ? "CONVERGING" : "UNKNOWN";
}

void writeFile(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  std::ofstream file(path);
  write(file);
  if (!file.flush()) throw std::runtime_error(path.string() + " cannot be written");
}

void writeInfo(const fs::path& path, const std::string& name, const sensor_msgs::CameraInfo& info) {
  writeFile(path, [&](std::ostream& file) {
    if (!camera_calibration_parsers::writeCalibrationYml(file, name, info)) {
      throw std::runtime_error(path.string() + " cannot be written");
    }
  });
}

std::string scaleNote(const RigEstimate& estimate) {
  return estimate.metric ? "Lengths in metres."
                         : "Lengths in distances between cam0 and cam1: the scale is not known.";
}

std::vector<std::string> writeCalibration(const fs::path& folder, const RigRecording& recording) {
  for (const char* name : {"camchain.yaml", "left.yaml", "right.yaml"}) fs::remove(folder / name);
  if (!recording.converged()) return {};
  const RigEstimate& estimate = recording.estimate;
  writeFile(folder / "camchain.yaml", [&](std::ostream& file) {
    file << rigCamchain(estimate.rig, recording.topics, scaleNote(estimate));
  });
  std::string problem;
  const auto pair = stereoPair(estimate.rig, &problem);
  if (!pair) return {asSentence(problem)};
  writeInfo(folder / "left.yaml", "left", pair->left_info);
  writeInfo(folder / "right.yaml", "right", pair->right_info);
  return {formatted("left.yaml is of %s, right.yaml of %s, for stereo_image_proc%s.",
                    recording.topics[pair->left].c_str(), recording.topics[pair->right].c_str(),
                    estimate.metric ? "" : "; its depths are in baselines")};
}

}  // namespace

std::string rigText(const RigRecording& recording) {
  std::string text;
  if (!recording.complete) text += std::string(kPartial) + '\n';
  text += "rig: " + rigState(recording) + ": " + asSentence(recording.estimate.sentence) + '\n';
  if (!recording.estimate.hint.empty()) text += asSentence(recording.estimate.hint) + '\n';
  for (std::size_t c = 0; c < recording.cameras.size(); ++c) {
    text += formatted("\ncamera %zu, %s\n", c, recording.topics[c].c_str());
    text += reportText(recording.cameras[c]);
  }
  return text;
}

std::string rigTrajectoryText(const RigRecording& recording,
                              const std::vector<StampedCameraPose>& ground_truth) {
  const std::vector<StampedCameraPose> poses(recording.poses.begin(), recording.poses.end());
  const auto difference = compareTrajectories(poses, ground_truth);
  if (!difference) return {};
  return formatted(
      "trajectory against the ground truth, after similarity alignment: ATE %.4f, RPE %.4f and "
      "%.3f "
      "deg over 1 s; %.1f travelled; scale %.4f%s\n",
      difference->rms, difference->relative_translation, difference->relative_rotation_deg,
      difference->travelled, difference->scale,
      recording.estimate.metric ? " (1 where the baseline is right)" : "");
}

std::string rigJson(const RigRecording& recording) {
  const RigEstimate& estimate = recording.estimate;
  std::vector<std::string> places;
  for (int c = 0; estimate.usable && c < estimate.rig.size(); ++c) {
    places.push_back(placeJson(recording, c));
  }
  return json::object(
             {{"state", json::string(rigState(recording))},
              {"complete", recording.complete ? "true" : "false"},
              {"sentence", json::string(estimate.sentence)},
              {"hint", json::string(estimate.hint)},
              {"metric", estimate.metric ? "true" : "false"},
              {"length_unit", json::string(lengthUnit(estimate))},
              {"rig_from_camera", json::array(places)},
              {"keyframes", json::number(static_cast<std::int64_t>(estimate.poses.size()))},
              {"observations", json::number(static_cast<std::int64_t>(estimate.observations))}}) +
         "\n";
}

std::vector<std::string> writeRig(const std::string& folder, const RigRecording& recording) {
  const fs::path path(folder);
  std::vector<std::string> notes;
  for (std::size_t c = 0; c < recording.cameras.size(); ++c) {
    const std::string name = formatted("cam%zu", c);
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
  writeFile(path / "summary.json", [&](std::ostream& file) { file << rigJson(recording); });
  return notes;
}

}  // namespace camera_self_calibration
