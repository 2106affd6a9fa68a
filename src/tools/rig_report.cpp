#include "camera_self_calibration/tools/rig_report.h"

#include <cmath>
#include <utility>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/tools/fleet_results.h"
#include "camera_self_calibration/tools/results_folder.h"
#include "camera_self_calibration/tools/rig_results.h"
#include "html_page.h"
#include "report_numbers.h"
#include "report_pictures.h"
#include "rig_pictures.h"

namespace camera_self_calibration {
namespace {

std::string cameraName(const RigRecording& recording, std::size_t camera) {
  return formatted("camera %zu, %s", camera, recording.topics[camera].c_str());
}

/// "x, y, z" with as many digits as the largest sigma has a use for.
std::string vectorText(const Eigen::Vector3d& vector, const Eigen::Vector3d& sigmas) {
  std::string text;
  for (int i = 0; i < 3; ++i) {
    text += (i > 0 ? ", " : "") + number(vector(i), decimalsFor(sigmas.maxCoeff()));
  }
  return text;
}

void addHead(const RunDescription& run, const RigRecording& recording, HtmlPage* page) {
  const RigEstimate& estimate = recording.estimate;
  page->verdict(rigState(recording), cssColour(stateColour(recording.state())),
                sentencesOf(estimate.sentence, estimate.hint));
  if (!recording.complete) page->paragraph(kPartial);
  const Recording& first = recording.cameras.front();
  page->figures({{std::to_string(recording.cameras.size()), "cameras"},
                 {std::to_string(estimate.poses.size()), "keyframes of the rig"},
                 {std::to_string(estimate.observations), "observations"},
                 {estimate.evidence ? std::to_string(estimate.evidence->shared.size()) : "0",
                  "views that cameras share"}});
  page->table({{"", ""},
               {"input", run.input},
               {"recorded", timeText(first.begin_ns) + ", " +
                                number(toSeconds(first.end_ns - first.begin_ns), 1) + " s"},
               {"lengths", "in " + lengthUnit(estimate)},
               {"options", run.options.empty() ? "the defaults" : run.options},
               {"program", "camera_self_calibration " SELFCAL_VERSION}});
  double seconds = 0.0;
  for (const Recording& camera : recording.cameras) seconds += camera.processing_seconds;
  page->varying("Run on " + run.date + "; the cameras by themselves took " + number(seconds, 1) +
                " s.");
}

void addCameras(const RigRecording& recording, HtmlPage* page) {
  page->section("The cameras", "Each has a page of its own.");
  std::vector<std::vector<std::string>> rows = {
      {"", "topic", "state", "lens model", "expected error"}};
  for (std::size_t c = 0; c < recording.cameras.size(); ++c) {
    const CalibrationReport& report = recording.cameras[c].final_report;
    rows.push_back({std::to_string(c), recording.topics[c], toString(report.state),
                    toString(report.camera.model()),
                    number(report.uncertainty.rms, 3) + " px rms"});
  }
  page->table(rows);
  for (std::size_t c = 0; c < recording.cameras.size(); ++c) {
    page->link("Report of " + cameraName(recording, c),
               cameraFolder(static_cast<int>(c)) + "/report.html");
  }
}

void addPlaces(const RigRecording& recording, HtmlPage* page) {
  const RigEstimate& estimate = recording.estimate;
  if (!estimate.usable) return;
  page->section(
      "Where the cameras sit",
      "Against camera 0, in its optical frame: x to the right, y down, z forward. Rotation "
      "is a rotation vector. Sigma is one standard deviation; positions are in " +
          lengthUnit(estimate) + ".");
  std::vector<std::vector<std::string>> rows = {{"", "rotation [deg]", "sigma", "position", "sigma",
                                                 "direction known to [deg]", "shared landmarks",
                                                 "clock [ms]"}};
  for (int c = 1; c < estimate.rig.size(); ++c) {
    const PlaceInRig& place = estimate.places[c];
    const Rigid3& pose = estimate.rig.rig_from_camera[c];
    const Eigen::Vector3d turn = sigmasOf(place.rotation_covariance) / kDegree;
    const Eigen::Vector3d shift = sigmasOf(place.position_covariance);
    const bool known = place.position_known;
    rows.push_back({formatted("camera %d", c), vectorText(logSo3(pose.rotation) / kDegree, turn),
                    vectorText(turn, turn),
                    known ? vectorText(pose.translation, shift) : "not known",
                    known ? vectorText(shift, shift) : "",
                    known ? number(place.directionSigma(pose.translation) / kDegree, 2) : "",
                    std::to_string(place.shared_landmarks),
                    number(1e3 * place.time_offset.seconds, 2) + " \u00b1 " +
                        number(1e3 * place.time_offset.sigma, 2)});
  }
  page->table(rows);
}

void addAudit(const RigRecording& recording, HtmlPage* page) {
  if (!recording.audit) return;
  const RigAudit& audit = *recording.audit;
  page->section("Is the calibration in question still right?",
                "Its lenses are judged on the pages of the cameras.");
  page->verdict(toString(audit.verdict()), cssColour(verdictColour(audit.verdict())), "");
  std::vector<std::vector<std::string>> rows = {{"", "verdict", ""}};
  for (std::size_t c = 0; c < audit.lenses.size(); ++c) {
    rows.push_back({formatted("lens of camera %zu", c), toString(audit.lenses[c].verdict),
                    asSentence(audit.lenses[c].sentence())});
  }
  for (std::size_t p = 0; p < audit.places.size(); ++p) {
    const PlaceAudit& place = audit.places[p];
    rows.push_back({formatted("place of camera %zu", p + 1), toString(place.verdict),
                    sentencesOf(place.sentence, place.hint)});
  }
  page->table(rows);
}

void addChanges(const RigRecording& recording, HtmlPage* page) {
  if (recording.mount_changes.empty()) return;
  page->section("Cameras that were moved", "The result holds for what came after the last change.");
  std::vector<std::vector<std::string>> rows = {{"", "p"}};
  for (const MountChange& change : recording.mount_changes) {
    rows.push_back({asSentence(change.sentence), formatted("%.1e", change.p_value)});
  }
  page->table(rows);
}

/// What is compared: by themselves, the audited calibration, if any, and together.
std::vector<std::pair<std::string, Rig>> comparedRigs(const RigRecording& recording) {
  std::vector<std::pair<std::string, Rig>> rigs = {
      {"each camera by itself", recording.estimate.evidence->before}};
  if (recording.audited) rigs.emplace_back("the calibration in question", *recording.audited);
  rigs.emplace_back("all cameras together", recording.estimate.rig);
  return rigs;
}

void addEpipolarErrors(const RigRecording& recording, HtmlPage* page) {
  if (!recording.estimate.usable) return;
  const RigEvidence& evidence = *recording.estimate.evidence;
  const std::vector<CameraPair> pairs = pairsOf(evidence, recording.estimate.rig.size());
  if (pairs.empty()) return;
  page->section(
      "Epipolar error",
      "What one camera follows is found in the images of the others. How far it is there "
      "from its epipolar line: with each camera calibrated by itself and placed by motion "
      "alone, and with all solved together. Grey: nothing shared there.");
  const std::vector<std::pair<std::string, Rig>> rigs = comparedRigs(recording);
  std::vector<std::vector<std::string>> rows = {{"", "views"}};
  for (const auto& [title, rig] : rigs) rows[0].push_back(title + " [px rms]");
  std::vector<std::pair<Sheet, std::string>> charts;
  for (const CameraPair& pair : pairs) {
    rows.push_back({formatted("features of camera %d in camera %d", pair.from, pair.to), ""});
    for (const auto& [title, rig] : rigs) {
      const EpipolarError error = epipolarError(rig, evidence.shared, pair);
      rows.back()[1] = std::to_string(error.views);
      rows.back().push_back(number(error.rms, 3));
    }
    std::vector<std::pair<std::string, Rig>> titled = rigs;
    for (auto& [title, rig] : titled) title = formatted("in camera %d: ", pair.to) + title;
    for (Sheet& sheet : drawEpipolarMaps(titled, evidence.shared, pair)) {
      charts.emplace_back(std::move(sheet), "Epipolar error over the image");
    }
  }
  page->table(rows);
  page->charts(charts);
}

void addRectified(const RigRecording& recording, HtmlPage* page) {
  if (!recording.converged()) return;
  std::string problem;
  const auto pair = stereoPair(recording.estimate.rig, &problem);
  if (!pair) return;
  const RigEvidence& evidence = *recording.estimate.evidence;
  const EpipolarError rows = rowError(*pair, evidence.shared);
  page->section(
      "The rectified pair",
      "As stereo_image_proc makes it from left.yaml and right.yaml. What both cameras see "
      "lies on one row if the calibration is right.");
  if (rows.views > 0) {
    page->paragraph(
        formatted("Rows of %d shared views agree to %.3f px rms.", rows.views, rows.rms));
  }
  page->photographs({{drawRectifiedPair(*pair, evidence),
                      "Left and right image, with lines along rows. Circles: shared views."}});
}

void addText(const RigRecording& recording, HtmlPage* page) {
  page->section("Calibration to copy");
  if (!recording.converged()) {
    page->paragraph("There is none: an estimate that has not CONVERGED is not to be used.");
    return;
  }
  const RigEstimate& estimate = recording.estimate;
  page->text("Kalibr (camchain.yaml)",
             rigCamchain(estimate.rig, recording.topics, scaleNote(estimate)), true);
}

void addTrajectory(const RigRecording& recording, const std::optional<TrajectoryDifference>& truth,
                   const std::vector<StampedCameraPose>& ground_truth, HtmlPage* page) {
  if (recording.poses.empty()) return;
  page->section("Trajectory", "Of camera 0.");
  if (truth) {
    page->table({{"", "ATE rms", "RPE in 1 s", "RPE in 1 s [deg]", "travelled", "scale"},
                 {"from the ground truth", number(truth->rms, 4),
                  number(truth->relative_translation, 4), number(truth->relative_rotation_deg, 3),
                  number(truth->travelled, 1), number(truth->scale, 4)}});
  }
  page->charts({{drawTrajectory({recording.poses.begin(), recording.poses.end()}, {}, ground_truth,
                                lengthUnit(recording.estimate)),
                 "Path of the rig from above"}});
}

}  // namespace

std::string rigReportHtml(const RunDescription& run, const RigRecording& recording,
                          const std::optional<TrajectoryDifference>& truth,
                          const std::vector<StampedCameraPose>& ground_truth) {
  HtmlPage page("Rig calibration: " + inputName(run.input));
  addHead(run, recording, &page);
  addAudit(recording, &page);
  addCameras(recording, &page);
  addPlaces(recording, &page);
  addChanges(recording, &page);
  addEpipolarErrors(recording, &page);
  addRectified(recording, &page);
  addText(recording, &page);
  addTrajectory(recording, truth, ground_truth, &page);
  return page.text();
}

}  // namespace camera_self_calibration
