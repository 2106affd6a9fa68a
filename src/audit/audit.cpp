#include "camera_self_calibration/audit/audit.h"

#include <array>
#include <cmath>

#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/camera/estimate_distance.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/queue/weak_directions.h"

namespace camera_self_calibration {
namespace {

// Models err most where they extrapolate, and there are the fewest features: what the outermost
// ones say is told apart.
constexpr double kInnerShare = 0.95;
// What is accepted is off by less than so many times the tolerance, for certain.
constexpr double kAccepted = 2.0;

// What is known of the lens.
struct Evidence {
  Camera lens;
  IntrinsicsMatrix covariance;
  double misfit_px = 0.0;  // of the lens model, which the covariance leaves out
  int freedom = 0;
};

Evidence evidenceOf(const CalibrationReport& live) {
  const double inflation = live.cross_validation.inflation();
  return {live.camera, inflation * inflation * live.covariance, live.lens_fit.misfit_observed.rms,
          live.scatter_freedom};
}

EstimateDistance distanceOf(const Camera& calibration, const Evidence& evidence,
                            const ImageWeights& weights) {
  EstimateDistance distance =
      distanceFromEstimate(evidence.lens, evidence.covariance, calibration, weights);
  distance.offset.other_sigma = evidence.misfit_px;
  return distance;
}

// Probabilities of what is found where the calibration is tolerable.
struct Chances {
  double distance = 1.0;
  double axis = 1.0;
  double least() const { return std::min(distance, axis); }
};

Chances chancesOf(const EstimateDistance& distance, const Evidence& evidence,
                  const AuditOptions& options) {
  // Where the rays are known, there is no chance in their having no pixel.
  const bool refuses =
      distance.refused > kNegligibleRim && distance.offset.noise <= options.tolerance_px;
  return {refuses ? 0.0
                  : chanceBeyond(distance.offset.length(), distance.offset.sigma(),
                                 options.tolerance_px, evidence.freedom),
          chanceBeyond(distance.axis_deg, distance.axis_sigma_deg, options.axis_tolerance_deg,
                       evidence.freedom)};
}

// In the image's thirds.
std::string whereMost(const EstimateDistance& distance, const Camera& lens) {
  static const char* const kNames[] = {"at the upper left", "at the top",    "at the upper right",
                                       "at the left",       "in the centre", "at the right",
                                       "at the lower left", "at the bottom", "at the lower right"};
  if (distance.points.empty()) return "";
  struct Part {
    double weight = 0.0;
    double squares = 0.0;
    double meanSquare() const { return weight > 0.0 ? squares / weight : 0.0; }
  };
  std::array<Part, 9> parts;
  for (const EstimateDistance::Point& point : distance.points) {
    const int column = std::min(2, static_cast<int>(3.0 * point.pixel.x() / lens.width()));
    const int row = std::min(2, static_cast<int>(3.0 * point.pixel.y() / lens.height()));
    Part& part = parts[static_cast<std::size_t>(3 * row + column)];
    part.weight += point.weight;
    part.squares += point.weight * point.offset.squaredNorm();
  }
  std::size_t worst = 0;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    if (parts[i].meanSquare() > parts[worst].meanSquare()) worst = i;
  }
  return formatted("%s (%.1f px rms)", kNames[worst], std::sqrt(parts[worst].meanSquare()));
}

std::string beyondMost(const Camera& calibration, const Evidence& evidence,
                       const ImageWeights& outer, double radius_px, const AuditOptions& options) {
  if (!(outer.sum() > 0.0)) return "";
  const EstimateDistance distance = distanceOf(calibration, evidence, outer);
  if (!(chancesOf(distance, evidence, options).least() < options.chance)) return "";
  const std::string place =
      formatted("beyond %.0f px from the centre, where few features are, ", radius_px);
  return place + (distance.refused > kNegligibleRim
                      ? formatted("%.0f %% of the features have no ray", 100.0 * distance.refused)
                      : formatted("it is off by %.1f px rms", distance.offset.length()));
}

void findCause(const Camera& calibration, const Evidence& evidence, const ImageWeights& inner,
               const AuditOptions& options, AuditReport* report) {
  const auto fits = [&](const Camera& camera) {
    return !(chancesOf(distanceOf(camera, evidence, inner), evidence, options).least() <
             options.chance);
  };
  const CauseFound found = likelyCause(calibration, evidence.lens, inner, fits);
  report->cause = found.cause;
  report->cause_sentence = found.sentence;
}

std::string chanceText(double p) {
  return p < 1e-6 ? std::string("p < 1e-6") : formatted("p = %.2g", p);
}

std::string axisText(const AuditReport& report) {
  return formatted("its optical axis is off by %.2f +- %.2f degrees", report.axis_deg,
                   report.axis_sigma_deg);
}

// What is wrong where the distance in pixels does not say it all.
void explainAxis(const Chances& chances, const AuditOptions& options, AuditReport* report) {
  if (!(chances.axis < options.chance)) return;
  if (chances.distance < options.chance || !report->reason.empty()) {
    report->where += ", and " + axisText(*report);
  } else {
    report->reason = axisText(*report) +
                     formatted(" (tolerance %.1f degrees, ", options.axis_tolerance_deg) +
                     chanceText(chances.axis) + ")";
  }
}

// Where the video does not tell the axis to a third of its tolerance, it does not count.
bool isGood(const AuditReport& report, const AuditOptions& options) {
  return isTolerable(report.distance_px, report.at_most_px, options) &&
         (report.axis_deg <= options.axis_tolerance_deg ||
          report.axis_sigma_deg > options.axis_tolerance_deg / 3.0);
}

AuditReport figuresOf(const EstimateDistance& distance, const AuditOptions& options) {
  AuditReport report;
  report.tolerance_px = options.tolerance_px;
  report.distance_px = distance.offset.length();
  report.sigma_px = distance.offset.sigma();
  report.at_most_px = distance.offset.atMost();
  report.axis_deg = distance.axis_deg;
  report.axis_sigma_deg = distance.axis_sigma_deg;
  report.refused = distance.refused;
  return report;
}

// Why it is neither GOOD nor WRONG.
void explainDoubt(const Evidence& evidence, const LensFitReport& fit, AuditReport* report) {
  const double needed_px = kAccepted * report->tolerance_px;
  if (!(report->at_most_px <= needed_px)) {
    report->reason = formatted(
        "the video only tells that it is off by less than %.2f px where features are (needed: %.2f "
        "px)",
        report->at_most_px, needed_px);
  } else {
    report->reason = "the distance is too close to the tolerance";
  }
  // By itself, to three sigma.
  if (evidence.misfit_px > 0.0 && report->distance_px + 3.0 * evidence.misfit_px > needed_px) {
    report->hint =
        "no motion would help, since " +
        (fit.better.empty() ? fit.model + " misses the lens and no other model was found to fit"
                            : fit.better + " fits the lens better than " + fit.model +
                                  ": choose that model, or auto");
    return;
  }
  const auto information = covarianceFromInformation(evidence.covariance);
  report->hint = weakestDirection(information.value_or(IntrinsicsMatrix()), evidence.lens).hint;
}

AuditReport nothingKnown(const CalibrationReport& live, const AuditOptions& options) {
  AuditReport report;
  report.tolerance_px = options.tolerance_px;
  report.reason = "the video has not determined the lens yet";
  report.hint = live.hint.empty() ? "move the camera and turn it about several axes" : live.hint;
  return report;
}

std::string offText(const AuditReport& report) {
  return formatted("off by %.2f +- %.2f px rms where features are (tolerance %.2f px, ",
                   report.distance_px, report.sigma_px, report.tolerance_px) +
         chanceText(report.p_value) + ")";
}

}  // namespace

std::string toString(AuditVerdict verdict) {
  const char* const names[] = {"GOOD", "WRONG", "CANNOT_TELL"};
  return names[static_cast<int>(verdict)];
}

bool isTolerable(double distance_px, double at_most_px, const AuditOptions& options) {
  return distance_px <= options.tolerance_px && at_most_px <= kAccepted * options.tolerance_px;
}

AuditReport audit(const Camera& calibration, const CalibrationReport& live,
                  const AuditOptions& options) {
  if (!live.handed_over || !live.observed.features || live.covariance.size() == 0) {
    return nothingKnown(live, options);
  }
  const Evidence evidence = evidenceOf(live);
  const Eigen::Vector2d centre = live.camera.parameters().segment<2>(2);
  const double radius_px = live.observed.features->radiusHolding(kInnerShare, centre);
  const ImageWeights inner = live.observed.features->within(radius_px, centre);
  const EstimateDistance distance = distanceOf(calibration, evidence, inner);
  const Chances chances = chancesOf(distance, evidence, options);
  const bool same_size =
      calibration.width() == live.camera.width() && calibration.height() == live.camera.height();
  AuditReport report = figuresOf(distance, options);
  report.p_value = same_size ? chances.least() : 0.0;
  if (!same_size) {
    report.reason = "it is for images of " + sizeText(calibration.width(), calibration.height()) +
                    ", but these are " + sizeText(live.camera.width(), live.camera.height());
  }
  if (report.p_value < options.chance) {
    report.verdict = AuditVerdict::kWrong;
    report.where = whereMost(distance, live.camera);
    explainAxis(chances, options, &report);
    findCause(calibration, evidence, inner, options, &report);
  } else if (!std::isfinite(report.distance_px)) {
    return nothingKnown(live, options);
  } else if (isGood(report, options)) {
    report.verdict = AuditVerdict::kGood;
    report.beyond =
        beyondMost(calibration, evidence, live.observed.features->beyond(radius_px, centre),
                   radius_px, options);
  } else {
    explainDoubt(evidence, live.lens_fit, &report);
  }
  return report;
}

std::string AuditReport::sentence() const {
  if (verdict == AuditVerdict::kCannotTell) {
    return reason + (std::isfinite(distance_px) ? "; it is " + offText(*this) : std::string());
  }
  if (verdict == AuditVerdict::kGood) {
    return "the calibration is right: " + offText(*this) + (beyond.empty() ? "" : "; " + beyond);
  }
  std::string text = reason;
  if (text.empty()) {
    text = std::isfinite(distance_px) ? "the calibration is " + offText(*this)
                                      : "the calibration cannot be one of this lens";
  }
  if (refused > kNegligibleRim) {
    text += formatted("; it has no ray for %.0f %% of the features", 100.0 * refused);
  }
  if (!where.empty()) text += "; off most " + where;
  text += since_ns ? formatted("; since the time stamp %.3f s", toSeconds(*since_ns))
                   : std::string("; from the beginning of the video");
  return text + "; likely cause: " + cause_sentence;
}

}  // namespace camera_self_calibration
