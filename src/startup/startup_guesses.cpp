// When a batch does not fit: the part of Startup that tries other first guesses.

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "camera_self_calibration/base/parallel.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "camera_self_calibration/map/segment_edit.h"
#include "camera_self_calibration/startup/startup.h"

namespace camera_self_calibration {
namespace {

constexpr int kComparedKeyframes = 12;  // at most, in the comparison of guesses
constexpr int kRetryBudget = 24;        // keyframes grown from other guesses with each new one
constexpr double kClearlyLess = 0.98;   // of a cost: another minimum, not the same one again

// Default guesses of the model of `initial`, but with other focal lengths.
std::vector<Camera> otherGuesses(const Camera& initial) {
  std::vector<Camera> guesses;
  const double side = initial.longerSide();
  for (const double focal : {0.35, 0.5, 0.75, 1.1}) {
    for (const double w : {1.0, 0.6}) {
      Intrinsics parameters =
          Camera::defaultGuess(initial.model(), initial.width(), initial.height()).parameters();
      parameters(0) = parameters(1) = focal * side;
      if (initial.model() == CameraModel::kFov) parameters(4) = w;
      Camera camera(initial.model(), initial.width(), initial.height(), parameters);
      if (initial.estimatedCount() == kMaxIntrinsics) camera.setEstimateK3(true);
      guesses.push_back(camera);
      if (initial.model() != CameraModel::kFov) break;
    }
  }
  return guesses;
}

std::vector<Camera> otherGuesses(const Camera& initial, bool choose_model) {
  if (!choose_model) return otherGuesses(initial);
  std::vector<Camera> guesses;
  for (const CameraModel model : {CameraModel::kPinhole, CameraModel::kFov}) {
    for (const Camera& guess :
         otherGuesses(Camera::defaultGuess(model, initial.width(), initial.height()))) {
      guesses.push_back(guess);
    }
  }
  return guesses;
}

}  // namespace

// Some at a time, and at last the best of them at a keyframe of its own: what each costs is
// bounded.
void Startup::tryOtherGuesses() {
  const std::vector<Camera> guesses = otherGuesses(initial_, options_.choose_model);
  const std::size_t count = std::min<std::size_t>(guesses.size() - next_guess_,
                                                  1 + (kRetryBudget - 1) / comparedKeyframes());
  std::vector<Trial> trials(count);
  parallelFor(options_.threads, static_cast<int>(count),
              [&](int i) { trials[i] = tryGuess(guesses[next_guess_ + i], false); });
  for (std::size_t i = 0; i < count; ++i) {
    const Trial& trial = trials[i];
    const double cost = trial.cost / static_cast<double>(trial.segment.observations.size());
    if (!trial.better || (best_guess_ && best_guess_->cost <= cost)) continue;
    best_guess_ = Guess{guesses[next_guess_ + i], cost};
  }
  next_guess_ += count;
  if (next_guess_ < guesses.size() || (best_guess_ && count > 0)) return;
  next_guess_ = 0;
  next_retry_ = next_retry_ * 3 / 2;
  if (best_guess_) adopt(tryGuess(best_guess_->camera, true));
  best_guess_.reset();
}

// The first ones, whatever the length of the batch.
int Startup::comparedKeyframes() const {
  const int all = static_cast<int>(segment_.keyframes.size());
  return std::clamp(all, 1, kComparedKeyframes);
}

Startup::Trial Startup::tryGuess(const Camera& guess, bool two_views) const {
  Trial trial;
  trial.segment = prefixOf(segment_, comparedKeyframes(), 1, &trial.landmark_index);
  const double present =
      usable_ ? robustCost(freeBlock(&trial.segment, camera_), camera_, kHuberThreshold)
              : std::numeric_limits<double>::infinity();
  GrowthOptions growth = options_.growth;
  growth.prior = vaguePrior(guess);
  growth.two_views = two_views;
  trial.camera = guess;
  const double needed = kClearlyLess * present;
  trial.cost = bootstrap(growth, &trial.segment, &trial.camera, needed);
  trial.better = trial.cost < needed && !ranAway(trial.camera);
  return trial;
}

void Startup::adopt(const Trial& trial) {
  if (!trial.better) return;
  const Startup before = *this;
  goOnWith(trial.camera);
  best_.reset();  // of the solution that is given up
  options_.growth.prior = vaguePrior(camera_);
  adoptPrefix(trial.segment, trial.landmark_index, &segment_);
  const int keyframes = static_cast<int>(segment_.keyframes.size());
  for (int k = static_cast<int>(trial.segment.keyframes.size()); k < keyframes; ++k) {
    growByKeyframe(options_.growth, k, &segment_, &camera_);
  }
  judge();
  // What fits the first keyframes better by chance does not fit the others.
  const bool worse = !usable_ || residual_scale_ > before.residual_scale_;
  if (before.isInformative() && worse) *this = before;
}

}  // namespace camera_self_calibration
