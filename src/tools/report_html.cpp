#include "camera_self_calibration/tools/report_html.h"

#include <algorithm>
#include <cmath>

#include "batch_figures.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/pixel_difference.h"
#include "camera_self_calibration/plotting/difference_chart.h"
#include "camera_self_calibration/plotting/palette.h"
#include "camera_self_calibration/plotting/teaching_chart.h"
#include "html_page.h"
#include "report_numbers.h"
#include "report_pictures.h"

namespace camera_self_calibration {
namespace {

std::string modelText(const Camera& camera) {
  return toString(camera.model()) + ", " + std::to_string(camera.width()) + " x " +
         std::to_string(camera.height());
}

std::int64_t originOf(const Recording& recording) {
  if (!recording.poses.empty()) return recording.poses.front().stamp_ns;
  return recording.reports.empty() ? 0 : recording.reports.front().stamp_ns;
}

double secondsOf(const Recording& recording) {
  const std::int64_t end = std::max(recording.final_report.stamp_ns,
                                    recording.poses.empty() ? 0 : recording.poses.back().stamp_ns);
  return std::max(0.0, 1e-9 * static_cast<double>(end - originOf(recording)));
}

std::string verdictSentence(const Recording& recording) {
  const CalibrationReport& report = recording.final_report;
  if (report.state != CalibrationState::kConverged) {
    return asSentence(report.sentence) + " " + asSentence(report.hint);
  }
  const int digits = decimalsFor(report.uncertainty.rms);
  return "The " + toString(report.camera.model()) + " lens is known to " +
         number(report.uncertainty.rms, digits) + " px rms over the image (" +
         number(report.uncertainty.max, digits) + " px at the worst place), from " +
         number(secondsOf(recording), 1) + " s of video of which " +
         std::to_string(report.queue.segments.size()) + " segments carry the result.";
}

std::int64_t observationsOf(const Recording& recording) {
  std::int64_t count = 0;
  for (const SegmentReport& segment : recording.final_report.queue.segments) {
    count += segment.observations;
  }
  return count;
}

void addHead(const std::string& source_name, const Recording& recording, HtmlPage* page) {
  const CalibrationReport& report = recording.final_report;
  page->verdict(toString(report.state), cssColour(stateColour(report.state)),
                verdictSentence(recording));
  if (!recording.complete) page->paragraph(kPartial);
  page->paragraph("Source: " + source_name + ". Camera model: " + modelText(report.camera) + ".");
  const CrossValidation& halves = report.cross_validation;
  page->figures({{number(report.uncertainty.rms, 3) + " px", "expected error, rms"},
                 {number(report.uncertainty.max, 3) + " px", "expected error, worst place"},
                 {number(report.observed.uncertainty.rms, 3) + " px", "rms where features were"},
                 {halves.compared ? number(halves.difference_px, 3) + " px" : "unknown",
                  "between two halves of the video"},
                 {std::to_string(recording.frames), "images"},
                 {std::to_string(recording.keyframes), "keyframes"},
                 {std::to_string(observationsOf(recording)), "observations in the queue"}});
}

Colour auditColour(AuditVerdict verdict) {
  return stateColour(verdict == AuditVerdict::kGood    ? CalibrationState::kConverged
                     : verdict == AuditVerdict::kWrong ? CalibrationState::kDegenerate
                                                       : CalibrationState::kInitializing);
}

void addAudit(const Recording& recording, HtmlPage* page) {
  if (!recording.audit) return;
  const AuditReport& audit = *recording.audit;
  page->section("Is the calibration in question still right?");
  page->verdict(toString(audit.verdict), cssColour(auditColour(audit.verdict)),
                asSentence(audit.sentence()) + " " + asSentence(audit.hint));
  const Camera& lens = recording.final_report.camera;
  const PixelDifference difference =
      pixelDifference(lens, Camera(recording.audited->model(), lens.width(), lens.height(),
                                   recording.audited->parameters()));
  if (!std::isfinite(audit.distance_px) || !std::isfinite(difference.error.rms)) return;
  page->paragraph(
      "Over the whole image, from where the video sees a ray to where the calibration in "
      "question does:");
  page->pictures({{drawDifference(lens, difference), ""}});
}

const Camera* sameModel(const std::optional<Camera>& reference, const Camera& camera) {
  return reference && reference->model() == camera.model() ? &*reference : nullptr;
}

void addParameters(const Recording& recording, HtmlPage* page) {
  const CalibrationReport& report = recording.final_report;
  const Camera* reference = sameModel(recording.reference, report.camera);
  const BatchEstimate* batch =
      recording.batch.batch.empty() ? nullptr : &recording.batch.batch.back();
  std::vector<std::vector<std::string>> rows = {{"parameter", "estimate", "sigma"}};
  if (reference != nullptr) {
    rows[0].insert(rows[0].end(), {"reference", "difference", "in sigmas"});
  }
  if (batch != nullptr) rows[0].insert(rows[0].end(), {"batch", "sigma of the batch"});
  const std::vector<std::string> names = report.camera.parameterNames();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double value = report.camera.parameters()(k);
    const bool known = k < report.covariance.rows();
    const double sigma = known ? std::sqrt(report.covariance(k, k)) : NAN;
    const int digits = decimalsFor(sigma);
    rows.push_back({names[i], number(value, digits), known ? number(sigma, digits) : "-"});
    if (reference != nullptr) {
      const bool has = k < reference->parameters().size();
      const double other = has ? reference->parameters()(k) : 0.0;
      rows.back().insert(rows.back().end(), {number(other, digits), number(value - other, digits),
                                             number((value - other) / sigma, 2)});
    }
    if (batch != nullptr && k < batch->covariance.rows()) {
      rows.back().insert(rows.back().end(), {number(batch->camera.parameters()(k), digits),
                                             number(std::sqrt(batch->covariance(k, k)), digits)});
    }
  }
  page->section("Parameters",
                "fx, fy, cx, cy in pixels, pixel centres at integer coordinates. Sigma is one "
                "standard deviation.");
  page->table(rows);
}

void addTrust(const Recording& recording, HtmlPage* page) {
  page->section("Where the calibration can be trusted",
                "Left: the expected error of a projection, with what a rotation of the camera "
                "absorbs taken out. Right: how many of the observations that the result rests on "
                "lie in each part of the image; grey: none.");
  if (recording.final_report.covariance.size() == 0) {
    page->paragraph("There is no estimate yet.");
    return;
  }
  page->pictures({{drawUncertainty(recording), ""}, {drawCoverage(recording), ""}});
}

void addConvergence(const Recording& recording, HtmlPage* page) {
  if (recording.reports.empty()) return;
  const bool batch = !recording.batch.batch.empty();
  page->section("Convergence",
                batch ? "The queue of the best segments beside the batch solution of the whole "
                        "trajectory, solved again from time to time with the same tracks and gates."
                      : "Estimates over the keyframes. Bands are three standard deviations.");
  page->pictures(
      {{drawParameterFigure(recording.reports, recording.batch, recording.reference, true), ""}});
  if (!batch) return;
  page->pictures({{drawQueueSizeFigure(recording.batch, recording.reference, true), ""}});
}

void addTeachings(const Recording& recording, HtmlPage* page) {
  if (!recording.learnt) return;
  const Camera& camera = recording.learnt->camera;
  const std::vector<SegmentTeaching> taught =
      teachings(recording.learnt->segments, camera, originOf(recording));
  std::vector<std::string> names = camera.parameterNames();
  names.resize(static_cast<std::size_t>(camera.estimatedCount()));
  page->section("What taught what",
                "The result rests on these segments of the video alone. The darker, the more the "
                "error would grow if the segment were missing.");
  page->pictures({{drawTeachings(taught, names, secondsOf(recording), 1000, true), ""}});
  std::vector<std::vector<std::string>> rows = {
      {"from [s]", "to [s]", "keyframes", "landmarks", "observations", "error without it"}};
  for (const SegmentTeaching& segment : taught) {
    rows.push_back({number(segment.begin_s, 1), number(segment.end_s, 1),
                    std::to_string(segment.keyframes), std::to_string(segment.landmarks),
                    std::to_string(segment.observations), "+" + percent(segment.image)});
  }
  page->table(rows);
}

void addResiduals(const Recording& recording, HtmlPage* page) {
  if (!recording.learnt) return;
  page->section("Residuals",
                "Of all observations in the queue. Where the lens model fits, the arrows are short "
                "and point anywhere; a common direction, such as outwards at the corners, would be "
                "an error of the model.");
  page->pictures({{drawResidualMap(recording), ""}, {drawResidualDistribution(recording), ""}});
}

std::vector<std::string> differenceRow(const std::string& name,
                                       const std::optional<TrajectoryDifference>& difference) {
  if (!difference) return {};
  return {name,
          percent(difference->share(), 3),
          number(difference->rms, 4),
          number(difference->relative_translation, 4),
          number(difference->relative_rotation_deg, 3),
          number(difference->travelled, 1)};
}

void addTrajectory(const Recording& recording, const TrajectoryResults& results,
                   const std::vector<StampedCameraPose>& ground_truth, HtmlPage* page) {
  if (recording.poses.empty()) return;
  page->section("Trajectory", ground_truth.empty() && recording.reference_poses.empty()
                                  ? "Of one camera alone: the scale is arbitrary."
                                  : "Aligned by the similarity that fits best.");
  std::vector<std::vector<std::string>> rows = {
      {"", "mean distance / way", "ATE rms", "RPE in 1 s", "RPE in 1 s [deg]", "travelled"}};
  for (const auto& row :
       {differenceRow("from the run with the reference calibration, until hand-over",
                      results.startup),
        differenceRow("from the run with the reference calibration, after hand-over",
                      results.later),
        differenceRow("from the ground truth", results.truth),
        differenceRow("from the ground truth, after hand-over", results.truth_later),
        differenceRow("reference calibration from the ground truth", results.truth_reference)}) {
    if (!row.empty()) rows.push_back(row);
  }
  if (rows.size() > 1) page->table(rows);
  page->pictures({{drawTrajectory(recording, ground_truth), ""}});
}

void addReference(const Recording& recording, HtmlPage* page) {
  if (!recording.reference) return;
  const Camera& camera = recording.final_report.camera;
  const PixelError difference = pixelDistance(*recording.reference, camera);
  page->section("Against the reference calibration",
                "Where the two put the same ray, " + number(difference.rms, 3) +
                    " px rms apart and " + number(difference.max, 3) +
                    " px at most, once the rotation that fits best is removed; " +
                    number(recording.final_report.uncertainty.rms, 3) +
                    " px rms are expected from the stated uncertainty.");
}

void addEvents(const Recording& recording, HtmlPage* page) {
  if (recording.events.empty()) return;
  page->section("Events");
  std::vector<std::vector<std::string>> rows = {{"at [s]", "event", ""}};
  const std::int64_t origin = originOf(recording);
  for (const Event& event : recording.events) {
    rows.push_back({number(1e-9 * static_cast<double>(event.stamp_ns - origin), 2),
                    toString(event.type), event.sentence});
  }
  page->table(rows);
}

}  // namespace

std::string reportHtml(const std::string& source_name, const Recording& recording,
                       const TrajectoryResults& trajectory,
                       const std::vector<StampedCameraPose>& ground_truth) {
  HtmlPage page("Camera calibration from motion");
  addHead(source_name, recording, &page);
  addAudit(recording, &page);
  addParameters(recording, &page);
  addTrust(recording, &page);
  addConvergence(recording, &page);
  addTeachings(recording, &page);
  addResiduals(recording, &page);
  addTrajectory(recording, trajectory, ground_truth, &page);
  addReference(recording, &page);
  addEvents(recording, &page);
  return page.text();
}

}  // namespace camera_self_calibration
