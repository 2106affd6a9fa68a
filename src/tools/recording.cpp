#include "camera_self_calibration/tools/recording.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iomanip>
#include <stdexcept>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/ros/messages.h"
#include "camera_self_calibration/tools/calibration_file.h"
#include "camera_self_calibration/tools/json.h"
#include "csv_text.h"

namespace camera_self_calibration {
namespace {

namespace fs = std::filesystem;

std::string parametersJson(const Camera& camera, const std::function<double(std::size_t)>& value) {
  std::vector<json::Member> members;
  const std::vector<std::string> names = camera.parameterNames();
  for (std::size_t i = 0; i < names.size(); ++i) {
    members.emplace_back(names[i], json::number(value(i)));
  }
  return json::object(members);
}

std::string cameraJson(const CalibrationReport& report) {
  const Camera& camera = report.camera;
  const std::vector<double> sigma = parameterSigmas(report);
  return json::object(
      {{"model", json::string(toString(camera.model()))},
       {"width", json::number(static_cast<std::int64_t>(camera.width()))},
       {"height", json::number(static_cast<std::int64_t>(camera.height()))},
       {"params", parametersJson(camera,
                                 [&](std::size_t i) {
                                   return camera.parameters()[static_cast<Eigen::Index>(i)];
                                 })},
       {"sigma", parametersJson(camera, [&](std::size_t i) { return sigma[i]; })}});
}

std::string modelsJson(const std::vector<ModelEvidence>& models) {
  std::vector<std::string> values;
  for (const ModelEvidence& model : models) {
    values.push_back(json::object({{"model", json::string(model.model)},
                                   {"chosen", model.chosen ? "true" : "false"},
                                   {"behind_nats", json::number(model.behind)}}));
  }
  return json::array(values);
}

std::string errorJson(const PixelError& error) {
  return json::object({{"rms", json::number(error.rms)}, {"max", json::number(error.max)}});
}

std::string lensFitJson(const LensFitReport& fit) {
  return json::object({{"sentence", json::string(fit.sentence())},
                       {"better_model", json::string(fit.better)},
                       {"misfit", errorJson(fit.misfit)},
                       {"misfit_observed", errorJson(fit.misfit_observed)},
                       {"undescribed_share", json::number(fit.undescribed)}});
}

std::string crossValidationJson(const CrossValidation& halves) {
  return json::object({{"sentence", json::string(halves.sentence())},
                       {"compared", halves.compared ? "true" : "false"},
                       {"cross_difference_px", json::number(halves.difference_px)},
                       {"expected_px", json::number(halves.expected_px)},
                       {"p_value", json::number(halves.p_value)}});
}

std::string observedJson(const ObservedReport& observed) {
  return json::object({{"share", json::number(observed.share)},
                       {"pixel_uncertainty", errorJson(observed.uncertainty)},
                       {"unseen_corners", json::string(observed.unseen_corners)}});
}

std::string auditJson(const AuditReport& audit) {
  return json::object({{"verdict", json::string(toString(audit.verdict))},
                       {"sentence", json::string(audit.sentence())},
                       {"hint", json::string(audit.hint)},
                       {"distance_px", json::number(audit.distance_px)},
                       {"sigma_px", json::number(audit.sigma_px)},
                       {"tolerance_px", json::number(audit.tolerance_px)},
                       {"p_value", json::number(audit.p_value)},
                       {"axis_deg", json::number(audit.axis_deg)},
                       {"axis_sigma_deg", json::number(audit.axis_sigma_deg)},
                       {"refused_share", json::number(audit.refused)},
                       {"where", json::string(audit.where)},
                       {"likely_cause", json::string(toString(audit.cause))},
                       {"since_stamp", audit.since_ns ? json::seconds(*audit.since_ns) : "null"}});
}

std::string eventsJson(const std::vector<Event>& events) {
  std::vector<std::string> values;
  values.reserve(events.size());
  for (const Event& event : events) {
    values.push_back(json::object({{"type", json::string(toString(event.type))},
                                   {"stamp", json::seconds(event.stamp_ns)},
                                   {"onset_stamp", json::seconds(event.onset_stamp_ns)},
                                   {"epoch", std::to_string(event.epoch)},
                                   {"magnitude_px", json::number(event.magnitude_px)},
                                   {"p_value", json::number(event.p_value)},
                                   {"sentence", json::string(event.sentence)}}));
  }
  return json::array(values);
}

void writeFile(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  std::ofstream file(path);
  write(file);
  if (!file.flush()) throw std::runtime_error(path.string() + " cannot be written");
}

void writePose(const TimedPose& pose, std::ostream& file) {
  const Eigen::Vector3d& t = pose.world_from_camera.translation;
  const Eigen::Quaterniond& q = pose.world_from_camera.rotation;
  file << json::seconds(pose.stamp_ns) << std::setprecision(12) << ' ' << t.x() << ' ' << t.y()
       << ' ' << t.z() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
}

void writeTrajectory(const Recording& recording, bool keyframes_only, std::ostream& file) {
  std::vector<TimedPose> poses;
  for (const TimedPose& pose : recording.poses) {
    if (pose.is_keyframe || !keyframes_only) poses.push_back(pose);
  }
  writeTrajectory(poses, recording.complete, "map units: the scale is arbitrary", file);
}

void writeCsvHeader(const Camera& camera, std::ostream& file) {
  file << "stamp";
  Camera all = camera;
  all.setEstimateK3(all.model() == CameraModel::kRadtan);  // it may join later
  for (const std::string& name : all.parameterNames()) file << ',' << name;
  for (const std::string& name : all.parameterNames()) file << ",sigma_" << name;
  file << ",entropy,pixel_uncertainty_rms,pixel_uncertainty_max,queue_size,decision,state,epoch,"
          "model,pixel_uncertainty_observed,observed_share,cross_difference_px,cross_expected_px\n";
}

// Without values where the lens model was another one than at last.
void writeParameters(const CalibrationReport& report, CameraModel model, std::ostream& file) {
  const Intrinsics& parameters = report.camera.parameters();
  const int columns =
      model == CameraModel::kRadtan ? kMaxIntrinsics : Camera::parameterCount(model);
  const bool same = report.camera.model() == model;
  for (int i = 0; i < columns; ++i) {
    file << ',' << (!same ? NAN : i < parameters.size() ? parameters(i) : 0.0);
  }
  const std::vector<double> sigmas = parameterSigmas(report);
  for (std::size_t i = 0; i < static_cast<std::size_t>(columns); ++i) {
    file << ',' << (same && i < sigmas.size() ? sigmas[i] : NAN);
  }
}

void writeCsvRow(const CalibrationReport& report, CameraModel model, std::ostream& file) {
  file << json::seconds(report.stamp_ns) << std::setprecision(10);
  writeParameters(report, model, file);
  file << ',' << report.entropy << ',' << report.uncertainty.rms << ',' << report.uncertainty.max
       << ',' << report.queue.segments.size() << ',' << quoted(report.queue.last_decision) << ','
       << toString(report.state) << ',' << report.epoch << ',' << toString(report.camera.model());
  const CrossValidation& halves = report.cross_validation;
  file << ',' << report.observed.uncertainty.rms << ',' << report.observed.share << ','
       << (halves.compared ? halves.difference_px : NAN) << ','
       << (halves.compared ? halves.expected_px : NAN) << '\n';
}

std::vector<std::string> writeCalibrations(const fs::path& folder, const std::string& topic,
                                           const Recording& recording) {
  const CalibrationReport& report = recording.final_report;
  const fs::path ros_file = folder / "calibration.yaml";
  const fs::path kalibr_file = folder / "camchain.yaml";
  // An estimate that is not good enough must not be taken for a calibration, nor an older file for
  // the result of this run.
  fs::remove(ros_file);
  fs::remove(kalibr_file);
  if (report.state != CalibrationState::kConverged) return {};
  CalibrationLabels labels;
  labels.topic = topic;
  if (!recording.complete) labels.comment = kPartial;
  std::vector<std::string> notes;
  for (const auto& [file, format] : {std::pair{ros_file, CalibrationFormat::kRos},
                                     std::pair{kalibr_file, CalibrationFormat::kKalibr}}) {
    const CameraFit fit = writeCalibration(file.string(), report.camera, format, labels);
    if (fit.error.max == 0.0) continue;
    notes.push_back(formatted(
        "%s holds an approximation, since %s has no %s lens like this: %s, off "
        "by %.2g px rms, %.2g px at most.",
        file.filename().c_str(), toString(format).c_str(), toString(report.camera.model()).c_str(),
        toString(fit.camera.model()).c_str(), fit.error.rms, fit.error.max));
  }
  return notes;
}

}  // namespace

void writeTrajectory(const std::vector<TimedPose>& poses, bool complete, const std::string& unit,
                     std::ostream& file) {
  if (!complete) file << "# " << kPartial << '\n';
  file << "# t[s] tx ty tz [" << unit << "] qx qy qz qw\n";
  bool any = false;
  std::uint64_t map_id = 0;
  for (const TimedPose& pose : poses) {
    if (!any || pose.map_id != map_id) file << "# map " << pose.map_id << '\n';
    any = true;
    map_id = pose.map_id;
    writePose(pose, file);
  }
}

std::string summaryJson(const Recording& recording, const std::vector<json::Member>& extra) {
  const CalibrationReport& report = recording.final_report;
  const double rate = static_cast<double>(recording.frames) / recording.processing_seconds;
  const auto count = [](auto n) { return json::number(static_cast<std::int64_t>(n)); };
  std::vector<json::Member> members = {
      {"state", json::string(toString(report.state))},
      {"complete", recording.complete ? "true" : "false"},
      {"sentence", json::string(report.sentence)},
      {"hint", json::string(report.hint)},
      {"camera", cameraJson(report)},
      {"pixel_uncertainty", errorJson(report.uncertainty)},
      {"frames", count(recording.frames)},
      {"keyframes", count(recording.keyframes)},
      {"processing_seconds", json::number(recording.processing_seconds)},
      {"frames_per_second", json::number(rate)},
      {"queue", json::object({{"segments", count(report.queue.segments.size())},
                              {"swaps", count(report.queue.swaps)}})},
      {"observed", observedJson(report.observed)},
      {"cross_validation", crossValidationJson(report.cross_validation)},
      {"lens_fit", lensFitJson(report.lens_fit)},
      {"models", modelsJson(report.models)},
      {"events", eventsJson(recording.events)}};
  if (recording.audit) members.emplace_back("audit", auditJson(*recording.audit));
  members.insert(members.end(), extra.begin(), extra.end());
  return json::object(members) + "\n";
}

std::vector<std::string> writeRecording(const std::string& folder, const std::string& topic,
                                        const Recording& recording,
                                        const std::vector<json::Member>& extra) {
  const fs::path path(folder);
  writeFile(path / "trajectory.tum",
            [&](std::ostream& file) { writeTrajectory(recording, false, file); });
  writeFile(path / "keyframes.tum",
            [&](std::ostream& file) { writeTrajectory(recording, true, file); });
  writeFile(path / "convergence.csv", [&](std::ostream& file) {
    writeCsvHeader(recording.final_report.camera, file);
    for (const CalibrationReport& report : recording.reports)
      writeCsvRow(report, recording.final_report.camera.model(), file);
  });
  const std::vector<std::string> notes = writeCalibrations(path, topic, recording);
  writeFile(path / "summary.json",
            [&](std::ostream& file) { file << summaryJson(recording, extra); });
  return notes;
}

}  // namespace camera_self_calibration
