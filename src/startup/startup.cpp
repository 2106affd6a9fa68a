#include "camera_self_calibration/startup/startup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "camera_self_calibration/base/parallel.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/rigid_gate.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/map/rolling_shutter.h"
#include "camera_self_calibration/map/segment_edit.h"
#include "camera_self_calibration/queue/weak_directions.h"

namespace camera_self_calibration {
namespace {

// Other guesses are tried after so many keyframes, and again each time there are 3/2 as many.
constexpr int kFirstRetry = 6;
constexpr int kNewBatchKeyframes = 12;  // at most, where one begins again
constexpr int kMostNew = 3;  // of a full batch: it is solved again when one part in so many is new
const double kHalfTheInformation = std::sqrt(2.0);  // in sigmas
constexpr double kPriorSigmas = 5.0;  // of what is known from elsewhere: a batch can contradict it
// Of the likelihood ratio that k3 needs: promised to first order, it may turn out twice as large.
constexpr double kWorthAFit = 0.5;

int countAfter(std::int64_t id, const Segment& segment) {
  return static_cast<int>(
      std::count_if(segment.keyframes.begin(), segment.keyframes.end(),
                    [id](const Keyframe& keyframe) { return keyframe.id > id; }));
}

// The likelihood ratio that k3 has to offer at a solution without it, to first order (score test).
double promisedByK3(Segment segment, Camera camera) {
  camera.setEstimateK3(true);
  const Problem problem{&camera, true, {freeBlock(&segment, camera)}};
  const Marginal marginal = marginalize(problem, kHuberThreshold, 1);
  const double step = marginal.remainingStep();
  return step * step / std::max(1.0, marginal.designEffect());
}

// Whether the newest solved keyframe is among those of the history.
bool continues(const Segment& solved, const Segment& history) {
  if (solved.keyframes.empty()) return false;
  const std::int64_t newest = solved.keyframes.back().id;
  return std::any_of(history.keyframes.begin(), history.keyframes.end(),
                     [newest](const Keyframe& keyframe) { return keyframe.id == newest; });
}

}  // namespace

IntrinsicsPrior vaguePrior(const Camera& about) {
  IntrinsicsPrior prior{about.parameters(), about.parameters()};
  const double side = about.longerSide();
  prior.sigma.fill(about.model() == CameraModel::kEquidistant ? 0.3 : 1.0);
  prior.sigma.head<2>().fill(0.7 * side);
  prior.sigma.segment<2>(2).fill(0.2 * side);
  if (about.model() == CameraModel::kRadtan) prior.sigma.segment<2>(6).fill(0.1);
  prior.aspect_sigma = 0.2;  // square, as analog video (1.09), as anamorphic lenses (1.33)
  return prior;
}

Startup::Startup(const StartupOptions& options, const Camera& initial) : options_(options) {
  reset(initial);
}

void Startup::reset(const Camera& initial) {
  initial_ = camera_ = trusted_ = initial;
  options_.growth.prior = vaguePrior(initial);
  next_.reset();
  segment_ = gated_ = Segment();
  information_ = covariance_ = earlier_covariance_ = IntrinsicsMatrix();
  whole_image_uncertainty_ = PixelError::unknown();
  residual_scale_ = 1.0;
  usable_ = false;
  told_ = false;
  ran_away_ = false;
  added_ = 0;
  next_solve_ = next_k3_ = 0;
  next_retry_ = kFirstRetry;
  next_guess_ = 0;
  best_guess_.reset();
  best_.reset();
  finished_.reset();
}

void Startup::switchModel(const Camera& camera, const std::vector<Segment>& solved) {
  initial_ = camera;
  next_.reset();
  goOnWith(camera);
  for (const Segment& segment : solved) adoptSolved(segment);
  judge();
}

// What is known of another model's parameters says nothing of these.
void Startup::goOnWith(const Camera& camera) {
  const bool other = !camera.estimatesSameAs(trusted_);
  camera_ = camera;
  if (!other) return;
  next_k3_ = 0;
  next_.reset();
  best_.reset();
  finished_.reset();
  trusted_ = camera;
  options_.growth.prior = vaguePrior(camera);
  information_ = covariance_ = IntrinsicsMatrix();
  whole_image_uncertainty_ = PixelError::unknown();
  told_ = usable_ = false;
}

void Startup::resume(const Camera& camera, const IntrinsicsMatrix& information,
                     const Segment& solved, const IntrinsicsMatrix& earlier_covariance) {
  reset(camera);
  segment_ = solved;
  earlier_covariance_ = earlier_covariance;
  setInformation(information);
  usable_ = true;
  told_ = isInformative();
  added_ = static_cast<int>(solved.keyframes.size());
}

void Startup::beginNextFrom(const Camera& camera, const IntrinsicsMatrix& covariance) {
  next_ = FirstGuess{camera, vaguePrior(camera)};
  Intrinsics& sigma = next_->prior.sigma;
  for (int i = 0; i < covariance.rows(); ++i) {
    sigma(i) = std::min(sigma(i), kPriorSigmas * std::sqrt(covariance(i, i)));
  }
}

Camera Startup::heldCamera() const {
  if (isInformative()) return camera_;
  Camera trusted = trusted_;
  trusted.setEstimateK3(camera_.estimatedCount() == kMaxIntrinsics);
  return withWeakDirectionsHeld(camera_, information_, trusted,
                                options_.useless_uncertainty_share * camera_.longerSide());
}

bool Startup::isInformative() const {
  return usable_ &&
         whole_image_uncertainty_.rms < options_.useless_uncertainty_share * camera_.longerSide();
}

void Startup::add(const Segment& history) {
  if (history.keyframes.size() < 2) return;
  const Camera solved = camera_;
  if (!continues(segment_, history)) {
    beginBatch(history);
  } else if (ran_away_) {
    beginAgain(history);
  } else {
    extend(history);
  }
  const bool full = static_cast<int>(segment_.keyframes.size()) > options_.max_keyframes;
  if (!usable_ || !full || added_ >= next_solve_) {
    judge();
    next_solve_ = added_ + std::min(static_cast<int>(kWorthASolve * added_),
                                    options_.max_keyframes / kMostNew);
  } else {
    camera_ = solved;  // what is known of it goes on to belong together
  }
  if (added_ >= next_retry_ &&
      (!usable_ || residual_scale_ * residual_scale_ > options_.retry_cost)) {
    tryOtherGuesses();
  }
  while (static_cast<int>(segment_.keyframes.size()) > options_.max_keyframes) {
    segment_ = withoutKeyframe(segment_, leastInformative(options_.choice, segment_, camera_,
                                                          options_.growth.prior, options_.threads));
  }
}

// A lost map is no reason to forget the lens.
void Startup::beginBatch(const Segment& history) {
  finishBatch();
  next_solve_ = next_k3_ = 0;
  next_retry_ = kFirstRetry;
  next_guess_ = 0;
  best_guess_.reset();
  if (next_) {
    camera_ = next_->camera;
    options_.growth.prior = next_->prior;
    next_retry_ = std::numeric_limits<int>::max();  // others would be less than what is known
  } else if (!usable_) {
    goOnWith(trusted_);
  }
  segment_ = connectedToNewest(history);
  bootstrap(options_.growth, &segment_, &camera_);
  added_ = static_cast<int>(history.keyframes.size());
}

// With what is known of the lens from before, and from few keyframes: bounded time.
void Startup::beginAgain(const Segment& history) {
  added_ += countAfter(segment_.keyframes.back().id, history);
  next_solve_ = next_k3_ = 0;
  camera_ = next_ ? next_->camera : trusted_;
  options_.growth.prior = next_ ? next_->prior : vaguePrior(camera_);
  segment_ = connectedToNewest(newestKeyframes(history, kNewBatchKeyframes));
  bootstrap(options_.growth, &segment_, &camera_);
}

void Startup::extend(const Segment& history) {
  const std::int64_t newest = segment_.keyframes.back().id;
  removeLandmarks(givenUp(segment_, history), &segment_);
  segment_ = connectedToNewest(extended(segment_, history, camera_));
  const int keyframes = static_cast<int>(segment_.keyframes.size());
  const int known = keyframes - countAfter(newest, segment_);
  if (known == 0) {
    next_solve_ = 0;
    bootstrap(options_.growth, &segment_, &camera_);
  } else {
    for (int k = known; k < keyframes; ++k) {
      growByKeyframe(options_.growth, k, &segment_, &camera_);
    }
  }
  added_ += countAfter(newest, history);
}

void Startup::judge() {
  usable_ = ran_away_ = false;
  whole_image_uncertainty_ = PixelError::unknown();
  if (static_cast<int>(segment_.keyframes.size()) < options_.growth.free_after_keyframes) return;
  Segment gated = segment_;
  Camera camera = camera_;
  removeLandmarks(nonRigidTracks(&gated, camera), &gated);
  SegmentFitOptions options;
  // From the solution of one keyframe ago. What tells nothing has no sharp optimum to look for.
  options.max_iterations = told_ ? 10 : 4;
  options.precision = kEstimatePrecision;
  options.prior = options_.growth.prior;
  options.inverse_depth_noise = InverseDepthNoise::kDiscounted;
  const SegmentFit fit = fitSegment(options, &gated, &camera);
  ran_away_ = !fit.usable || ranAway(camera);
  if (ran_away_) return finishBatch();
  camera_ = camera;
  residual_scale_ = fit.residual_scale;
  setInformation(fit.marginal);
  usable_ = true;
  if (fit.unexplained_sigma > 0.0 && isInformative()) considerK3(&gated);
  told_ = isInformative();
  if (told_) {
    trusted_ = camera_;
    options_.growth.prior.mean = camera_.parameters();
  }
  adoptSolved(gated);
  gated_ = std::move(gated);
  noteBest();
}

// The gated solution is the better one; tracks that did not fit stay with their old depth, since
// they may fit later.
void Startup::adoptSolved(const Segment& solved) {
  if (segment_.keyframes.empty() || solved.keyframes.size() != segment_.keyframes.size() ||
      solved.keyframes.back().id != segment_.keyframes.back().id) {
    return;
  }
  std::map<std::int64_t, const Landmark*> known;
  for (const Landmark& landmark : solved.landmarks) known[landmark.track_id] = &landmark;
  segment_.keyframes = solved.keyframes;
  for (Landmark& landmark : segment_.landmarks) {
    const auto found = known.find(landmark.track_id);
    if (found != known.end()) landmark = *found->second;
  }
}

bool Startup::comparable() const {
  return usable_ && static_cast<int>(gated_.keyframes.size()) >= kFirstRetry;
}

void Startup::setInformation(const Marginal& marginal) {
  const double scale = marginal.sigmaScale();
  setInformation(IntrinsicsMatrix(marginal.information / (scale * scale)));
}

// An error of the earlier lens, which is held, shows in the present one about as large.
void Startup::setInformation(const IntrinsicsMatrix& information) {
  information_ = information;
  covariance_ = covarianceFromInformation(information_).value_or(IntrinsicsMatrix());
  if (earlierKeyframes(segment_) > 0 && covariance_.size() > 0 &&
      covariance_.size() == earlier_covariance_.size()) {
    covariance_ += earlier_covariance_;
    information_ = covarianceFromInformation(covariance_).value_or(information_);
  }
  whole_image_uncertainty_ = pixelUncertainty(camera_, covariance_);
}

void Startup::setLineDelay(double line_delay_s) {
  setLineDelayOfScene(line_delay_s, camera_, &segment_);
  if (usable_) judge();
}

LineDelayEstimate Startup::lineDelay() const {
  if (!isInformative() || gated_.keyframes.empty()) return LineDelayEstimate();
  Segment segment = gated_;
  return estimateLineDelay({freeBlock(&segment, camera_)}, camera_, options_.growth.prior, 1);
}

std::vector<Segment> Startup::halves() const {
  if (!usable_ || gated_.keyframes.empty()) return {};
  return partsOfPresentLens(gated_, 2);
}

void Startup::noteBest() {
  const double rms = isInformative() ? whole_image_uncertainty_.rms : INFINITY;
  if (best_ && best_->camera.estimatedCount() != camera_.estimatedCount()) best_.reset();
  if (best_ && rms > kHalfTheInformation * best_->rms) finishBatch();
  if (isInformative() && (!best_ || rms < best_->rms)) best_ = Solution{gated_, camera_, rms};
}

void Startup::finishBatch() {
  if (best_) finished_ = std::exchange(best_, std::nullopt);
}

std::optional<Startup::Solution> Startup::takeFinished() {
  if (finished_) finished_->segment = partsOfPresentLens(finished_->segment, 1).front();
  return std::exchange(finished_, std::nullopt);
}

void Startup::considerK3(Segment* gated) {
  if (camera_.model() != CameraModel::kRadtan ||
      camera_.estimatedCount() > Camera::parameterCount(CameraModel::kRadtan) ||
      static_cast<int>(gated->keyframes.size()) < kFirstRetry) {
    return;
  }
  if (added_ < next_k3_) return;
  if (promisedByK3(*gated, camera_) < kWorthAFit * options_.k3_likelihood_ratio) return;
  next_k3_ = added_ + static_cast<int>(std::ceil(kWorthASolve * added_));
  std::array<ComparedFit, 2> fits = {ComparedFit{*gated, camera_, {}},
                                     ComparedFit{*gated, camera_, {}}};
  ComparedFit& with = fits.back();
  with.camera.setEstimateK3(true);
  parallelFor(options_.threads, 2, [&fits](int i) { fits[i].solve(); });
  if (!with.fit.usable || !with.camera.valid()) return;
  if (!demandsK3(fits.front(), with)) return;
  // The other fit may only have stopped earlier on the way to the same minimum.
  const int fewer = Camera::parameterCount(CameraModel::kRadtan);
  ComparedFit without{with.segment,
                      Camera(with.camera.model(), with.camera.width(), with.camera.height(),
                             with.camera.parameters().head(fewer)),
                      {}};
  without.solve();
  if (!demandsK3(without, with)) return;
  camera_ = with.camera;
  *gated = with.segment;
  options_.growth.prior = vaguePrior(camera_);  // k3 has one too
  const Problem problem{&camera_, true, {freeBlock(gated, camera_)}, options_.growth.prior};
  setInformation(marginalize(problem, kHuberThreshold, 1, InverseDepthNoise::kDiscounted));
}

bool Startup::demandsK3(const ComparedFit& without, const ComparedFit& with) const {
  const double ratio = 2.0 * (without.fit.marginal.cost - with.fit.marginal.cost) /
                       std::max(1.0, without.fit.marginal.designEffect());
  return without.fit.usable && ratio >= options_.k3_likelihood_ratio;
}

}  // namespace camera_self_calibration
