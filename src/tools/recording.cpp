#include "camera_self_calibration/tools/recording.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iomanip>
#include <stdexcept>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/ros/messages.h"
#include "camera_self_calibration/tools/calibration_file.h"
#include "camera_self_calibration/tools/results_folder.h"
#include "csv_text.h"

namespace camera_self_calibration {
namespace {

namespace fs = std::filesystem;

Json parametersJson(const Camera& camera, const std::function<double(std::size_t)>& value) {
  Json members = Json::object();
  const std::vector<std::string> names = camera.parameterNames();
  for (std::size_t i = 0; i < names.size(); ++i) members[names[i]] = value(i);
  return members;
}

Json cameraJson(const CalibrationReport& report) {
  const Camera& camera = report.camera;
  const std::vector<double> sigma = parameterSigmas(report);
  return {{"model", toString(camera.model())},
          {"width", camera.width()},
          {"height", camera.height()},
          {"params", parametersJson(camera,
                                    [&](std::size_t i) {
                                      return camera.parameters()[static_cast<Eigen::Index>(i)];
                                    })},
          {"sigma", parametersJson(camera, [&](std::size_t i) { return sigma[i]; })}};
}

Json modelsJson(const std::vector<ModelEvidence>& models) {
  Json values = Json::array();
  for (const ModelEvidence& model : models) {
    values.push_back(
        {{"model", model.model}, {"chosen", model.chosen}, {"behind_nats", model.behind}});
  }
  return values;
}

Json errorJson(const PixelError& error) { return {{"rms", error.rms}, {"max", error.max}}; }

/// Null where nothing is known, so that nobody takes a default for a result.
template <typename Value>
Json ifKnown(bool known, Value value) {
  return known ? Json(value) : Json();
}

Json lensFitJson(const LensFitReport& fit) {
  const auto known = [&](const PixelError& misfit) {
    return errorJson(fit.compared ? misfit : PixelError::unknown());
  };
  return {{"sentence", fit.sentence()},
          {"compared", fit.compared},
          {"refuted", ifKnown(fit.compared, fit.refuted)},
          {"better_model", fit.better},
          {"misfit", known(fit.misfit)},
          {"misfit_observed", known(fit.misfit_observed)},
          {"undescribed_share", ifKnown(fit.compared, fit.undescribed)}};
}

Json crossValidationJson(const CrossValidation& halves) {
  return {{"sentence", halves.sentence()},
          {"compared", halves.compared},
          {"cross_difference_px", ifKnown(halves.compared, halves.difference_px)},
          {"expected_px", ifKnown(halves.compared, halves.expected_px)},
          {"p_value", ifKnown(halves.compared, halves.p_value)}};
}

Json observedJson(const ObservedReport& observed) {
  return {{"share", ifKnown(observed.share > 0.0, observed.share)},
          {"pixel_uncertainty", errorJson(observed.uncertainty)},
          {"unseen_corners", observed.unseen_corners}};
}

Json auditJson(const AuditReport& audit) {
  const bool judged =
      audit.verdict != AuditVerdict::kCannotTell || std::isfinite(audit.distance_px);
  return {{"verdict", toString(audit.verdict)},
          {"sentence", audit.sentence()},
          {"hint", audit.hint},
          {"distance_px", audit.distance_px},
          {"sigma_px", audit.sigma_px},
          {"at_most_px", audit.at_most_px},
          {"tolerance_px", audit.tolerance_px},
          {"p_value", ifKnown(judged, audit.p_value)},
          {"axis_deg", ifKnown(judged, audit.axis_deg)},
          {"axis_sigma_deg", audit.axis_sigma_deg},
          {"refused_share", ifKnown(judged, audit.refused)},
          {"where", audit.where},
          {"likely_cause", toString(audit.cause)},
          {"since_stamp", audit.since_ns ? Json(toSeconds(*audit.since_ns)) : Json()}};
}

Json eventsJson(const std::vector<Event>& events) {
  Json values = Json::array();
  for (const Event& event : events) {
    values.push_back({{"type", toString(event.type)},
                      {"stamp", toSeconds(event.stamp_ns)},
                      {"onset_stamp", toSeconds(event.onset_stamp_ns)},
                      {"epoch", event.epoch},
                      {"magnitude_px", event.magnitude_px},
                      {"p_value", event.p_value},
                      {"sentence", event.sentence}});
  }
  return values;
}

void writeFile(const fs::path& path, const std::function<void(std::ostream&)>& write) {
  std::ofstream file(path);
  write(file);
  if (!file.flush()) throw std::runtime_error(path.string() + " cannot be written");
}

void writePose(const TimedPose& pose, std::ostream& file) {
  const Eigen::Vector3d& t = pose.world_from_camera.translation;
  const Eigen::Quaterniond& q = pose.world_from_camera.rotation;
  file << stampText(pose.stamp_ns) << std::setprecision(12) << ' ' << t.x() << ' ' << t.y() << ' '
       << t.z() << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
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
  file << stampText(report.stamp_ns) << std::setprecision(10);
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
  // An estimate that is not good enough must not be taken for a calibration.
  if (report.state != CalibrationState::kConverged) return {};
  CalibrationLabels labels;
  labels.topic = topic;
  if (!recording.complete) labels.comment = kPartial;
  std::vector<std::string> notes;
  for (const auto& [file, format] : {std::pair{ros_file, CalibrationFormat::kRos},
                                     std::pair{kalibr_file, CalibrationFormat::kKalibr}}) {
    const CameraFit fit = writeCalibration(file.string(), report.camera, format, labels);
    const std::string note =
        approximationNote(file.filename().string(), report.camera, format, fit);
    if (!note.empty()) notes.push_back(note);
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

Json summaryJson(const Recording& recording, const Json& extra) {
  const CalibrationReport& report = recording.final_report;
  const double rate = static_cast<double>(recording.frames) / recording.processing_seconds;
  Json summary = {
      {"state", toString(report.state)},
      {"complete", recording.complete},
      {"sentence", report.sentence},
      {"hint", report.hint},
      {"camera", cameraJson(report)},
      {"pixel_uncertainty", errorJson(report.uncertainty)},
      {"frames", recording.frames},
      {"keyframes", recording.keyframes},
      {"carried_features", recording.carried},
      {"processing_seconds", recording.processing_seconds},
      {"frames_per_second", rate},
      {"queue", {{"segments", report.queue.segments.size()}, {"swaps", report.queue.swaps}}},
      {"observed", observedJson(report.observed)},
      {"cross_validation", crossValidationJson(report.cross_validation)},
      {"lens_fit", lensFitJson(report.lens_fit)},
      {"models", modelsJson(report.models)},
      {"events", eventsJson(recording.events)}};
  if (recording.audit) summary["audit"] = auditJson(*recording.audit);
  summary.update(extra);
  return summary;
}

std::vector<std::string> writeRecording(const std::string& folder, const std::string& topic,
                                        const Recording& recording, const Json& extra) {
  removeResults(folder);
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
            [&](std::ostream& file) { file << toText(summaryJson(recording, extra)); });
  return notes;
}

}  // namespace camera_self_calibration
