#include "camera_self_calibration/tools/report_html.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "batch_figures.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/camera/field_of_view.h"
#include "camera_self_calibration/camera/pixel_difference.h"
#include "camera_self_calibration/model_choice/model_choice.h"
#include "camera_self_calibration/plotting/contribution_chart.h"
#include "camera_self_calibration/plotting/difference_chart.h"
#include "camera_self_calibration/plotting/track_overlay.h"
#include "camera_self_calibration/tools/calibration_format.h"
#include "camera_self_calibration/tools/fleet_results.h"
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
  return std::max(0.0, toSeconds(end - originOf(recording)));
}

std::string verdictSentence(const Recording& recording) {
  const CalibrationReport& report = recording.final_report;
  if (report.state != CalibrationState::kConverged) {
    return sentencesOf(report.sentence, report.hint);
  }
  const int digits = decimalsFor(report.uncertainty.rms);
  return "The " + toString(report.camera.model()) + " lens is known to " +
         number(report.uncertainty.rms, digits) + " px rms over the image (" +
         number(report.uncertainty.max, digits) + " px at the worst place). The result rests on " +
         std::to_string(report.queue.segments.size()) + " segments out of " +
         number(secondsOf(recording), 1) + " s of video.";
}

std::int64_t observationsOf(const Recording& recording) {
  std::int64_t count = 0;
  for (const SegmentReport& segment : recording.final_report.queue.segments) {
    count += segment.observations;
  }
  return count;
}

std::string pixels(double value) {
  return std::isfinite(value) ? number(value, 3) + " px" : "unknown";
}

std::string fieldOfViewText(const Camera& camera) {
  const FieldOfView field = fieldOfView(camera);
  return number(field.horizontal, 1) + "\u00b0 horizontal, " + number(field.vertical, 1) +
         "\u00b0 vertical, " + number(field.diagonal, 1) + "\u00b0 diagonal";
}

void addHead(const RunDescription& run, const Recording& recording, HtmlPage* page) {
  const CalibrationReport& report = recording.final_report;
  page->verdict(toString(report.state), cssColour(stateColour(report.state)),
                verdictSentence(recording));
  if (!recording.complete) page->paragraph(kPartial);
  page->figures({{pixels(report.uncertainty.rms), "expected error, rms"},
                 {pixels(report.uncertainty.max), "expected error, worst place"},
                 {pixels(report.observed.uncertainty.rms), "rms where features were"},
                 {std::to_string(recording.frames), "images"},
                 {std::to_string(recording.keyframes), "keyframes"},
                 {std::to_string(observationsOf(recording)), "observations in the queue"}});
  page->table(
      {{"", ""},
       {"input", run.input},
       {"topic or file", run.topic},
       {"recorded", timeText(recording.begin_ns) + ", " + number(secondsOf(recording), 1) + " s"},
       {"lens model", modelText(report.camera)},
       {"field of view",
        report.covariance.size() > 0 ? fieldOfViewText(report.camera) : "not known yet"},
       {"shutter", describe(report.shutter)},
       {"options", run.options.empty() ? "the defaults" : run.options},
       {"program", "camera_self_calibration " SELFCAL_VERSION}});
  const double rate = static_cast<double>(recording.frames) / recording.processing_seconds;
  page->varying("Run on " + run.date + ", in " + number(recording.processing_seconds, 1) + " s (" +
                number(rate, 0) + " images a second).");
}

std::string observedText(const ObservedReport& observed) {
  if (!(observed.share > 0.0)) return "Not known yet.";
  const std::string corners =
      observed.unseen_corners.empty() ? "" : " " + asSentence(observed.unseen_corners);
  return "Features covered " + number(100.0 * observed.share, 0) +
         " % of the image; the expected error there is " + number(observed.uncertainty.rms, 3) +
         " px rms." + corners;
}

void addVerdict(const RunDescription& run, const Recording& recording, HtmlPage* page) {
  const CalibrationReport& report = recording.final_report;
  const auto orUnknown = [](const std::string& text) {
    return text.empty() ? std::string("Not compared yet.") : asSentence(text);
  };
  page->section("Why this verdict",
                "The state is CONVERGED when the expected error is below its limit. The expected "
                "error contains noise, disagreement between two halves of the video that share no "
                "image, and misfit of the lens model.");
  page->table({{"check", "result"},
               {"expected error", number(report.uncertainty.rms, 3) + " px rms; the limit is " +
                                      number(run.converged_pixel_rms, 2) + " px."},
               {"halves of the video", orUnknown(report.cross_validation.sentence())},
               {"lens model", orUnknown(report.lens_fit.sentence())},
               {"region observed", observedText(report.observed)}});
}

void addModels(const Recording& recording, HtmlPage* page) {
  const std::vector<ModelEvidence>& models = recording.final_report.models;
  if (models.empty()) return;
  page->section("Comparison of lens models",
                "How many times as likely the tracks in the video are with the model in use as "
                "with another one, each with the lens that fits best. By chance alone a model "
                "gains a factor of some 1.6 for each parameter more. The simplest model that the "
                "video does not refute is in use.");
  std::vector<std::vector<std::string>> rows = {
      {"model", "times as likely with the one in use", ""}};
  for (const ModelEvidence& model : models) {
    rows.push_back(
        {model.model,
         std::isfinite(model.behind) ? timesAsLikely(model.behind) : "cannot fit the video",
         model.chosen ? "in use" : ""});
  }
  page->table(rows);
}

void addText(const RunDescription& run, const Recording& recording, HtmlPage* page) {
  const CalibrationReport& report = recording.final_report;
  page->section("Calibration to copy");
  if (report.state != CalibrationState::kConverged) {
    page->paragraph("There is none: an estimate that has not CONVERGED is not to be used.");
    return;
  }
  CalibrationLabels labels;
  labels.topic = run.topic;
  if (!recording.complete) labels.comment = kPartial;
  bool open = true;
  for (const auto& [format, name] :
       {std::pair{CalibrationFormat::kRos, "ROS (camera_info_manager)"},
        std::pair{CalibrationFormat::kPlain, "this package"},
        std::pair{CalibrationFormat::kKalibr, "Kalibr"},
        std::pair{CalibrationFormat::kOpenCv, "OpenCV"}}) {
    const CameraFit fit = storable(report.camera, format);
    const std::string approximate =
        fit.error.max == 0.0 ? ""
                             : formatted(": approximated as %s, %.2g px rms",
                                         toString(fit.camera.model()).c_str(), fit.error.rms);
    page->text(name + approximate, calibrationText(fit.camera, format, labels), open);
    open = false;
  }
}

void addExample(const Recording& recording, HtmlPage* page) {
  if (!recording.example) return;
  const ExampleImage& example = *recording.example;
  const double at_s = toSeconds(example.stamp_ns - originOf(recording));
  const bool known = recording.final_report.covariance.size() > 0;
  page->section("An example image",
                "Straight edges of the scene are straight in the undistorted image if the "
                "calibration is right.");
  page->photographs(
      {{drawTracks(example.gray, example.trails, {}),
        "At " + number(at_s, 1) + " s, with " + std::to_string(example.trails.trails().size()) +
            " tracks: new ones are orange, old ones green."},
       {known ? undistorted(example.gray, recording.final_report.camera) : cv::Mat(),
        "The same, undistorted with this calibration, at most 120\u00b0 wide."}});
}

void addAudit(const Recording& recording, HtmlPage* page) {
  if (!recording.audit) return;
  const AuditReport& audit = *recording.audit;
  page->section("Is the calibration in question still right?");
  page->verdict(toString(audit.verdict), cssColour(verdictColour(audit.verdict)),
                sentencesOf(audit.sentence(), audit.hint));
  const Camera& lens = recording.final_report.camera;
  const PixelDifference difference =
      pixelDifference(lens, Camera(recording.audited->model(), lens.width(), lens.height(),
                                   recording.audited->parameters()));
  if (!std::isfinite(audit.distance_px) || !std::isfinite(difference.error.rms)) return;
  page->paragraph(
      "Over the whole image, from where the video sees a ray to where the calibration in "
      "question does:");
  page->charts({{drawDifference(lens, difference), "Difference between both calibrations"}});
}

const Camera* sameModel(const std::optional<Camera>& reference, const Camera& camera) {
  return reference && reference->model() == camera.model() ? &*reference : nullptr;
}

void addParameters(const Recording& recording, HtmlPage* page) {
  const CalibrationReport& report = recording.final_report;
  const Camera* reference = sameModel(recording.reference, report.camera);
  const BatchEstimate* batch = comparable(report, recording.batch);
  std::vector<std::vector<std::string>> rows = {{"parameter", "estimate", "sigma"}};
  if (reference != nullptr) {
    rows[0].insert(rows[0].end(), {"reference", "difference", "in sigmas"});
  }
  if (batch != nullptr) rows[0].insert(rows[0].end(), {"batch", "sigma of the batch"});
  std::vector<std::string> names = report.camera.parameterNames();
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
                std::string("fx, fy, cx and cy are in pixels, and pixel centres lie at integer "
                            "coordinates. ") +
                    kSigmaMeaning);
  page->table(rows);
  if (report.covariance.size() == 0) return;
  page->paragraph(
      "Correlations. Strong ones are normal: parameters that move together change "
      "the image little, and the expected error in pixels takes this into account.");
  names.resize(static_cast<std::size_t>(report.covariance.rows()));
  const Eigen::VectorXd inverse = report.covariance.diagonal().cwiseSqrt().cwiseInverse();
  page->correlations(names, inverse.asDiagonal() * report.covariance * inverse.asDiagonal());
}

/// What drawUncertainty leaves out.
std::string misfitText(const CalibrationReport& report) {
  const std::string left_out = "The map does not contain what the lens model misses of the lens";
  const LensFitReport& fit = report.lens_fit;
  if (!fit.compared) return left_out + ", which is not known yet.";
  if (fit.misfit.rms < 0.0005) return left_out + "; compared with richer lenses, that is nothing.";
  return left_out + ": compared with richer lenses " + number(fit.misfit.rms, 3) +
         " px rms over the image, " + number(fit.misfit.max, 3) +
         " px at the worst place. Squares add: with it, the expected error is " +
         number(report.uncertainty.rms, 3) + " px rms.";
}

void addTrust(const Recording& recording, HtmlPage* page) {
  page->section("Where the calibration can be trusted",
                "The error of a projection that noise makes, and what halves of the video disagree "
                "beyond it, with what a rotation of the camera absorbs taken out; and how many of "
                "the observations that the result rests on lie in each part of the image. Grey: "
                "none.");
  if (recording.final_report.covariance.size() == 0) {
    page->paragraph("There is no estimate yet.");
    return;
  }
  std::vector<std::pair<Sheet, std::string>> charts = {
      {drawUncertainty(recording), "Error by noise over the image"}};
  if (recording.learnt) charts.emplace_back(drawCoverage(recording), "Observations over the image");
  page->charts(charts);
  page->paragraph(misfitText(recording.final_report));
}

void addConvergence(const Recording& recording, HtmlPage* page) {
  if (recording.reports.empty()) return;
  const bool batch = !recording.batch.batch.empty();
  page->section(
      "Convergence",
      batch ? "The queue of the best segments beside the batch solution of the whole "
              "trajectory, solved again from time to time with the same tracks and gates. Bands "
              "are three sigmas, as above."
            : "Estimates over the keyframes. Bands are three sigmas, as above; the dashed line is "
              "the hand-over from startup to the queue.");
  std::vector<std::pair<Sheet, std::string>> charts;
  for (Sheet& panel :
       drawParameterPanels(recording.reports, recording.batch, recording.reference, kChartWidth)) {
    charts.emplace_back(std::move(panel), "Estimates over the keyframes");
  }
  page->charts(charts);
  if (!batch) return;
  page->charts({{drawQueueSizeFigure(recording.batch, recording.reference, 700),
                 "Queues of different size"}});
}

void addContributions(const Recording& recording, HtmlPage* page) {
  if (!recording.learnt) return;
  const Camera& camera = recording.learnt->camera;
  const std::vector<SegmentContribution> contributed =
      contributions(recording.learnt->segments, camera, originOf(recording));
  std::vector<std::string> names = camera.parameterNames();
  names.resize(static_cast<std::size_t>(camera.estimatedCount()));
  page->section("Which seconds informed the result",
                "The result rests on these segments of the video alone. The darker a segment, the "
                "more the error would grow without it.");
  page->charts({{drawContributions(contributed, names, secondsOf(recording), kChartWidth),
                 "Error without each segment, over time"}});
  std::vector<std::vector<std::string>> rows = {
      {"from [s]", "to [s]", "keyframes", "landmarks", "observations", "error without it"}};
  for (const SegmentContribution& segment : contributed) {
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
                "and point anywhere, and the mean outwards is zero within its band; a common "
                "direction, such as outwards in the corners, is an error of the model.");
  page->charts(
      {{drawResidualMap(recording), "Residuals over the image"},
       {drawResidualsByRadius(recording), "Residuals by distance from the principal point"},
       {drawResidualsOverTime(recording, originOf(recording)), "Residuals over time"},
       {drawResidualDistribution(recording), "Distribution of the residuals"}});
  const double ratio = residualRatio(recording);
  page->paragraph(
      "Red: the residuals that the tracker's sigmas lead one to expect. The curve is narrower than "
      "the standard normal distribution, since landmarks and poses are fitted to the same "
      "observations and absorb a part of the noise. Real residuals have a sharper peak and longer "
      "tails: some tracks are better, and some worse, than their sigma says. The residuals' rms "
      "is " +
      number(ratio, 2) +
      (ratio < 1.0 ? " of what is expected: the tracker's sigmas are cautious, and so are the "
                     "parameters' sigmas, which never assume less noise than the tracker states."
                   : " of what is expected: the parameters' sigmas take the difference into "
                     "account."));
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
  page->charts(
      {{drawTrajectory({recording.poses.begin(), recording.poses.end()},
                       {recording.reference_poses.begin(), recording.reference_poses.end()},
                       ground_truth, "map units"),
        "Path of the camera from above"}});
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
    rows.push_back({number(toSeconds(event.stamp_ns - origin), 2), toString(event.type),
                    asSentence(event.sentence)});
  }
  page->table(rows);
}

}  // namespace

std::string inputName(const std::string& path) {
  const std::filesystem::path file(path);
  return (file.has_filename() ? file : file.parent_path()).filename().string();
}

std::string reportHtml(const RunDescription& run, const Recording& recording,
                       const TrajectoryResults& trajectory,
                       const std::vector<StampedCameraPose>& ground_truth) {
  HtmlPage page("Camera calibration: " + inputName(run.input));
  addHead(run, recording, &page);
  addAudit(recording, &page);
  addVerdict(run, recording, &page);
  addParameters(recording, &page);
  addText(run, recording, &page);
  addExample(recording, &page);
  addTrust(recording, &page);
  addResiduals(recording, &page);
  addModels(recording, &page);
  addConvergence(recording, &page);
  addContributions(recording, &page);
  addTrajectory(recording, trajectory, ground_truth, &page);
  addReference(recording, &page);
  addEvents(recording, &page);
  return page.text();
}

}  // namespace camera_self_calibration
