#include "camera_self_calibration/model_choice/model_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {
namespace {

struct Hypothesis {
  CameraModel model;
  bool with_k3;
};
// From the simplest on.
constexpr std::array<Hypothesis, 5> kHypotheses = {{{CameraModel::kPinhole, false},
                                                    {CameraModel::kFov, false},
                                                    {CameraModel::kRadtan, false},
                                                    {CameraModel::kEquidistant, false},
                                                    {CameraModel::kRadtan, true}}};

bool describes(const Hypothesis& hypothesis, const Camera& camera) {
  return hypothesis.model == camera.model() &&
         hypothesis.with_k3 == (camera.estimatedCount() == kMaxIntrinsics);
}

double square(double value) { return value * value; }

// All lenses fitted to the same observations, each fitted when it is asked for.
class Trials {
 public:
  Trials(const LensComparison& comparison, const ImageField& field, int threads)
      : observations_(comparison.observations), field_(field), threads_(threads) {
    trials_ = comparison.richer;
    trials_.push_back(comparison.present);
  }

  // The best fit so far, from whose poses and depths the others start.
  const LensTrial& best() const {
    return *std::min_element(
        trials_.begin(), trials_.end(),
        [](const LensTrial& a, const LensTrial& b) { return a.cost < b.cost; });
  }

  const LensTrial* find(const Hypothesis& hypothesis) {
    for (const LensTrial& trial : trials_) {
      if (describes(hypothesis, trial.camera)) return &trial;
    }
    const LensTrial from = best();
    const auto start = likewise(from.camera, hypothesis.model, hypothesis.with_k3);
    if (!start) return nullptr;
    LensObservations observations = observations_;
    observations.segments = from.segments;
    trials_.push_back(tryLens(observations, *start, threads_));
    return &trials_.back();
  }

  LensKnowledge knowledge(const LensTrial& trial) const {
    return knowledgeOf(observations_, trial, threads_);
  }

  // Squared pixel uncertainty; infinite where it is unknown [px^2].
  double noise(const LensTrial& trial) const {
    return square(pixelUncertainty(trial.camera, knowledge(trial).covariance, field_).rms);
  }

  // Expected squared error of a lens if `other` is of the right model: its noise, and what it is
  // off beyond what the noise of both explains [px^2].
  double error(const LensTrial& lens, const LensTrial& other) const {
    const double own = noise(lens);
    const double others = noise(other);
    const double off = square(pixelDistance(lens.camera, other.camera, field_).rms);
    return own + others < off ? off - others : own;
  }

  bool isUseful(double error) const {
    return error < square(kUselessUncertaintyShare * trials_.front().camera.longerSide());
  }

  std::vector<ModelEvidence> evidence(const std::string& chosen, double variance) const {
    const auto found = std::find_if(trials_.begin(), trials_.end(),
                                    [&](const LensTrial& trial) { return trial.name() == chosen; });
    std::vector<ModelEvidence> evidence;
    for (const LensTrial& trial : trials_) {
      const bool is_chosen = trial.name() == chosen;
      evidence.push_back(
          {trial.name(), is_chosen, is_chosen ? 0.0 : (trial.cost - found->cost) / variance});
    }
    return evidence;
  }

 private:
  const LensObservations& observations_;
  const ImageField& field_;
  int threads_;
  std::vector<LensTrial> trials_;
};

// The simplest that the best fit does not refute.
std::optional<LensTrial> simplestTenable(double refuted, const LensKnowledge& known,
                                         Trials* trials) {
  for (const Hypothesis& hypothesis : kHypotheses) {
    const LensTrial* trial = trials->find(hypothesis);
    if (trial == nullptr || !trial->usable) continue;
    if (leadByChance(trials->best(), *trial, known) >= refuted) return *trial;
  }
  return std::nullopt;
}

// A simpler lens that explains as much, or is known so much better that it is nearer to the truth.
std::optional<LensTrial> simplerThan(const LensTrial& present, const LensKnowledge& known,
                                     const ModelChoiceOptions& options,
                                     const std::set<std::string>& refuted, Trials* trials) {
  const double noise = trials->noise(present);
  for (const Hypothesis& hypothesis : kHypotheses) {
    if (Camera::parameterCount(hypothesis.model) + (hypothesis.with_k3 ? 1 : 0) >=
        present.camera.estimatedCount()) {
      break;
    }
    const LensTrial* found = trials->find(hypothesis);
    if (found == nullptr || !found->usable) continue;
    const LensTrial simpler = *found;
    const double error = trials->error(simpler, present);
    const bool plausible = leadByChance(present, simpler, known) > options.plausible;
    if (plausible && error <= noise && refuted.count(simpler.name()) == 0) return simpler;
    if (trials->isUseful(error) && error < options.clearly_less * noise) return simpler;
  }
  return std::nullopt;
}

}  // namespace

std::string timesAsLikely(double nats) {
  constexpr double kReadable = 1000.0;
  constexpr int kBeyondDoubt = 20;  // power of ten; the tracks are not as independent as that
  const double power = nats / std::log(10.0);
  if (std::abs(power) > kBeyondDoubt) {
    return formatted(power > 0.0 ? "more than 10^%d" : "less than 10^-%d", kBeyondDoubt);
  }
  if (std::abs(nats) >= std::log(kReadable)) return formatted("10^%.0f", power);
  const double times = std::exp(nats);
  return formatted(times < 9.5 ? "%.2g" : "%.0f", times);
}

bool ModelChoice::isDue(std::int64_t keyframes) {
  if (keyframes < next_) return false;
  next_ = nextComparison(keyframes);
  return true;
}

std::optional<LensTrial> ModelChoice::choose(const LensComparison& comparison,
                                             const ImageField& field, int threads) {
  const LensTrial& present = comparison.present;
  Trials trials(comparison, field, threads);
  const LensTrial best = trials.best();
  if (!best.usable) return std::nullopt;
  const LensKnowledge known = trials.knowledge(best);
  const bool alone = comparison.observations.segments.size() == 1;
  const double refuted = alone ? kSignificanceAlone : options_.refuted;
  std::optional<LensTrial> other;
  if (leadByChance(best, present, known) < refuted) {
    other = simplestTenable(refuted, known, &trials);
    // Wrong but well known may be nearer to the truth than right but hardly known.
    if (other && present.usable && !(trials.noise(*other) <= trials.error(present, *other))) {
      other.reset();
    }
    if (other && !alone) refuted_.insert(present.name());
  } else {
    other = simplerThan(present, known, options_, refuted_, &trials);
  }
  evidence_ = trials.evidence(other ? other->name() : present.name(), known.variance.factor);
  return other;
}

std::string ModelChoice::sentence() const {
  const ModelEvidence* chosen = nullptr;
  const ModelEvidence* next = nullptr;
  for (const ModelEvidence& evidence : evidence_) {
    if (evidence.chosen) {
      chosen = &evidence;
    } else if (next == nullptr || evidence.behind < next->behind) {
      next = &evidence;
    }
  }
  if (chosen == nullptr) return "";
  const std::string text = "lens model " + chosen->model;
  if (next == nullptr) return text + ": no richer model fits the video better";
  if (std::isinf(next->behind)) return text + ": no other model was found to fit the video";
  const std::string times = timesAsLikely(std::abs(next->behind)) + " times as likely)";
  if (next->behind < 0.0) {
    return text + " (" + next->model +
           " fits the video better, but not by enough: with it the tracks are " + times;
  }
  return text + " (fits the video better than the next best, " + next->model + ": the tracks are " +
         times;
}

}  // namespace camera_self_calibration
