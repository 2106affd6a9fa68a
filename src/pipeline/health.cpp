#include "camera_self_calibration/pipeline/health.h"

#include <cmath>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/queue/weak_directions.h"

namespace camera_self_calibration {
namespace {

// Keyframes after which an estimate that is still unobserved is called degenerate.
constexpr int kKeyframesToJudge = 12;
// Uncertainty over the image's longer side, rms, from which on the verdict asks for another motion.
// Below kUselessUncertaintyShare, by which the calibrator decides what it uses: translation alone
// simulates 0.025 to 0.1 in a batch, by noise in the estimated rotations. Such an estimate may be
// used, but nobody should be told that it converges.
constexpr double kDegenerateUncertaintyShare = 0.02;
// A state is left when the uncertainty has passed the limit by more than it is known to: the
// scatter of a few segments, some eight degrees of freedom, tells a standard deviation to a quarter
// of it, and this is twice that.
constexpr double kHysteresis = 1.5;

// Halves that are as good as each other differ by twice the uncertainty of both together. Up to
// twice that, at the threshold, the weaker half is a check: it has a fourteenth of the information.
constexpr double kMostBetweenHalves = 4.0;

// What is less than this share of the image that sees is worth a word.
constexpr double kWholeImage = 0.98;

std::string goodTo(const HealthEvidence& evidence) {
  return formatted("good to %.2f px rms over the image", evidence.uncertainty.rms) +
         (evidence.seeing_share < kWholeImage ? " without its dark rim" : "");
}

std::string limit(const HealthEvidence& evidence) {
  return formatted(" (limit %.2f px)", evidence.threshold_px);
}

// Of CONVERGED, which is kept a little beyond its limit.
std::string limitToLeave(const HealthEvidence& evidence) {
  if (evidence.uncertainty.rms <= evidence.threshold_px) return limit(evidence);
  return formatted(" (limit %.2f px, no longer CONVERGED above %.2f px)", evidence.threshold_px,
                   kHysteresis * evidence.threshold_px);
}

bool isUnobserved(const HealthEvidence& evidence, const Camera& camera, bool was_unobserved) {
  if (!evidence.has_estimate || evidence.information.size() == 0) return false;
  const double limit_px =
      kDegenerateUncertaintyShare * camera.longerSide() / (was_unobserved ? kHysteresis : 1.0);
  return !(evidence.uncertainty.rms < limit_px) ||
         !(scaledEigenvalues(evidence.information)(0) > kUnobservedEigenvalue);
}

}  // namespace

std::string toString(CalibrationState state) {
  switch (state) {
    case CalibrationState::kWaitingForMotion:
      return "WAITING_FOR_MOTION";
    case CalibrationState::kInitializing:
      return "INITIALIZING";
    case CalibrationState::kConverging:
      return "CONVERGING";
    case CalibrationState::kConverged:
      return "CONVERGED";
    case CalibrationState::kDegenerate:
      return "DEGENERATE";
  }
  return "";
}

namespace {

// The parameters that are known least and the motion that would tell them.
WeakDirection weakest(const HealthEvidence& evidence, const Camera& camera) {
  return weakestDirection(evidence.has_estimate ? evidence.information : IntrinsicsMatrix(),
                          camera);
}

// No parameter asks for k3: it is estimated where a comparison of models finds that it is needed.
std::string settable(const std::string& model) {
  return cameraModelFromString(model) ? model : "auto";
}

// What to do about a model that misses the lens.
std::string adviceOn(const std::string& better_model) {
  if (!better_model.empty()) {
    const std::string model = settable(better_model);
    return "use the lens model " + model + (model == "auto" ? "" : ", or auto, which finds one");
  }
  return "let features pass through the whole image; if the misfit stays, allow a larger error "
         "(converged_pixel_rms), or use a lens model of more parameters";
}

std::string beginning(const HealthEvidence& evidence) {
  return evidence.epoch > 0 ? "the lens changed and is being calibrated anew"
                            : "the calibration is starting";
}

// A map that ends soon may be an accident, two are none.
bool isLostTooSoon(const HealthEvidence& evidence) {
  return evidence.maps > 2 && evidence.longest_map < evidence.needed_keyframes;
}

// The motion that would tell more, if images could be followed long enough to learn from it.
std::string motionFor(const WeakDirection& weak, const HealthEvidence& evidence) {
  if (!isLostTooSoon(evidence)) return weak.hint;
  return formatted(
      "tracking never lasts for more than %d keyframes, of which %d are needed: move more slowly, "
      "with more light; if the motion is slow, see whether images are missing, blurred or "
      "interlaced",
      evidence.longest_map, evidence.needed_keyframes);
}

// However the camera moves: under this model no motion gives a calibration.
HealthVerdict startsUnderAWrongModel(const HealthEvidence& evidence) {
  return {CalibrationState::kInitializing,
          beginning(evidence) + ", but the lens model does not fit the lens",
          adviceOn(evidence.better_model)};
}

std::string orUseAuto(const HealthEvidence& evidence) {
  return evidence.model_was_given ? "; if this stays, the lens model may be wrong: use auto" : "";
}

// What segments say that disagree is enough, but not right.
std::string onDisagreement(const HealthEvidence& evidence) {
  return "move more slowly, and keep what moves by itself out of view" + orUseAuto(evidence);
}

HealthVerdict degenerate(const HealthEvidence& evidence, const WeakDirection& weak) {
  return {CalibrationState::kDegenerate,
          "the motion so far does not determine the intrinsics; least known: " + weak.name +
              ", which keeps its last value",
          motionFor(weak, evidence) + orUseAuto(evidence)};
}

HealthVerdict stillLearning(const HealthEvidence& evidence, const WeakDirection& weak) {
  std::string sentence = beginning(evidence);
  if (evidence.has_estimate) {
    sentence += "; so far it is " + goodTo(evidence) +
                formatted(" (startup ends below %.2f px)", 2.0 * evidence.threshold_px);
  }
  // Also where so many keyframes have no solution yet.
  if (evidence.has_estimate || evidence.keyframes >= kKeyframesToJudge) {
    sentence += ", least known: " + weak.name;
  }
  if (!evidence.obstacle.empty()) sentence += "; " + evidence.obstacle;
  return {CalibrationState::kInitializing, sentence,
          evidence.segments_disagree ? onDisagreement(evidence) : motionFor(weak, evidence)};
}

}  // namespace

HealthVerdict judgeHealth(const HealthEvidence& evidence, const Camera& camera,
                          CalibrationState before) {
  const double rms = evidence.uncertainty.rms;
  const double allowed =
      (before == CalibrationState::kConverged ? kHysteresis : 1.0) * evidence.threshold_px;
  const bool checked = evidence.blind_below_px <= kMostBetweenHalves * allowed;
  if (evidence.handed_over && rms <= allowed && checked) {
    return {CalibrationState::kConverged,
            "the calibration is " + goodTo(evidence) + limitToLeave(evidence), ""};
  }
  if (evidence.handed_over && evidence.model_misses) {
    return {CalibrationState::kConverging,
            "the calibration is only " + goodTo(evidence) + limit(evidence) +
                (evidence.better_model.empty() ? ", because no lens model was found to fit the lens"
                                               : ", because the lens model does not fit the lens"),
            adviceOn(evidence.better_model)};
  }
  const WeakDirection weak = weakest(evidence, camera);
  if (evidence.handed_over && rms <= allowed) {
    return {CalibrationState::kConverging,
            "the calibration is " + goodTo(evidence) +
                ", but only one part of the video supports it, and no other part can check it",
            "repeat this motion in another place: " + weak.hint};
  }
  if (evidence.handed_over) {
    return {CalibrationState::kConverging,
            "the calibration is " + goodTo(evidence) +
                formatted(" (needed: %.2f px)", evidence.threshold_px) +
                "; least known: " + weak.name,
            weak.hint};
  }
  if (evidence.keyframes < 2) {
    return {
        CalibrationState::kWaitingForMotion, "the camera has not moved enough yet",
        "move the camera; if it is moving, most features are on the robot itself: cover it with a "
        "mask"};
  }
  if (evidence.model_misses) return startsUnderAWrongModel(evidence);
  if (evidence.keyframes >= kKeyframesToJudge &&
      isUnobserved(evidence, camera, before == CalibrationState::kDegenerate)) {
    return degenerate(evidence, weak);
  }
  return stillLearning(evidence, weak);
}

}  // namespace camera_self_calibration
