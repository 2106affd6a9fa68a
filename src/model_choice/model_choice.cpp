#include "camera_self_calibration/model_choice/model_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <set>

#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/map/rolling_shutter.h"
#include "camera_self_calibration/model_choice/held_out.h"

namespace camera_self_calibration {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kGoodShare = 0.9;        // of the most tracks that any model keeps
constexpr std::int64_t kMinInterval = 5;  // keyframes between comparisons
constexpr std::int64_t kMaxInterval = 100;

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

std::string nameOf(const Hypothesis& hypothesis) {
  return toString(hypothesis.model) + (hypothesis.with_k3 ? " with k3" : "");
}

bool describes(const Hypothesis& hypothesis, const Camera& camera) {
  return hypothesis.model == camera.model() &&
         hypothesis.with_k3 == (camera.estimatedCount() == kMaxIntrinsics);
}

// What `present` is in another model, as a start.
std::optional<Camera> startOf(const Hypothesis& hypothesis, const Camera& present) {
  if (describes(hypothesis, present)) return present;
  const std::optional<CameraFit> fit = fitCamera(present, hypothesis.model);
  if (!fit) return std::nullopt;
  Camera camera = fit->camera;
  if (hypothesis.model != CameraModel::kRadtan) return camera;
  const int count = Camera::parameterCount(CameraModel::kRadtan);
  camera = Camera(camera.model(), camera.width(), camera.height(), camera.parameters().head(count));
  if (hypothesis.with_k3) camera.setEstimateK3(true);
  return camera;
}

struct Trial {
  JointFit fit;
  double held_out = kInfinity;  // cost
};

std::vector<Trial> fitAll(const std::vector<Segment>& segments, const Camera& present,
                          int threads) {
  std::vector<Trial> trials(kHypotheses.size());
  for (std::size_t h = 0; h < trials.size(); ++h) {
    const std::optional<Camera> start = startOf(kHypotheses[h], present);
    if (start) trials[h].fit = fitJointly(segments, *start, threads);
  }
  return trials;
}

// What all answer for: the tracks that every model keeps that can explain nearly as many as any,
// with the least error that one of these leaves unexplained.
std::vector<ComparedTracks> commonTracks(const std::vector<Trial>& trials) {
  int most = 0;
  for (const Trial& trial : trials) most = std::max(most, trial.fit.trackCount());
  std::vector<ComparedTracks> common;
  for (const Trial& trial : trials) {
    if (!trial.fit.usable || trial.fit.trackCount() < kGoodShare * most) continue;
    if (common.empty()) common = trial.fit.tracks;
    for (std::size_t i = 0; i < common.size(); ++i) {
      const ComparedTracks& own = trial.fit.tracks[i];
      std::set<std::int64_t> both;
      std::set_intersection(common[i].ids.begin(), common[i].ids.end(), own.ids.begin(),
                            own.ids.end(), std::inserter(both, both.begin()));
      common[i].ids = both;
      common[i].unexplained_sigma = std::min(common[i].unexplained_sigma, own.unexplained_sigma);
    }
  }
  return common;
}

void holdOut(const std::vector<Segment>& segments, int threads, std::vector<Trial>* trials) {
  const std::vector<ComparedTracks> common = commonTracks(*trials);
  double best = kInfinity;
  double design_effect = 1.0;  // of the best
  for (Trial& trial : *trials) {
    if (!trial.fit.usable) continue;
    const HeldOut held = leaveOneOut(segments, common, trial.fit, threads);
    if (!held.usable) continue;
    trial.held_out = held.total();
    if (trial.held_out >= best) continue;
    best = trial.held_out;
    design_effect = std::max(1.0, held.design_effect);
  }
  for (Trial& trial : *trials) trial.held_out /= design_effect;
}

// The simplest hypothesis that is not clearly worse than the best.
std::size_t simplestGood(const std::vector<Trial>& trials, double negligible) {
  double best = kInfinity;
  for (const Trial& trial : trials) best = std::min(best, trial.held_out);
  for (std::size_t h = 0; h < trials.size(); ++h) {
    if (trials[h].held_out <= best + negligible) return h;
  }
  return 0;
}

}  // namespace

void ModelChoice::observe(const Segment& candidate) {
  if (candidate.earlier_camera ||
      static_cast<int>(candidate.keyframes.size()) < options_.segment_keyframes) {
    return;
  }
  if (!kept_.empty() && candidate.beginNs() <= kept_.back().endNs()) return;
  kept_.push_back(candidate);
  if (static_cast<int>(kept_.size()) > options_.max_segments) kept_.erase(kept_.begin());
}

void ModelChoice::setRowTime(double row_time_s, const Camera& camera) {
  for (Segment& segment : kept_) {
    setRowTimeOfScene(row_time_s, camera, &segment);
  }
}

std::optional<Camera> ModelChoice::consider(std::int64_t keyframes,
                                            const std::vector<Segment>& queue,
                                            const Camera& present, int threads) {
  const std::vector<Segment>& segments = queue.size() < kept_.size() ? kept_ : queue;
  if (keyframes < next_ || static_cast<int>(segments.size()) < options_.min_segments) {
    return std::nullopt;
  }
  next_ = keyframes + std::clamp(keyframes / 4, kMinInterval, kMaxInterval);
  const std::optional<Camera> other = compare(segments, present, threads);
  if (other) next_ = keyframes + kMinInterval;  // to be confirmed soon
  return other;
}

std::optional<Camera> ModelChoice::compare(const std::vector<Segment>& segments,
                                           const Camera& present, int threads) {
  std::vector<Trial> trials = fitAll(segments, present, threads);
  holdOut(segments, threads, &trials);
  std::size_t now = 0;
  while (!describes(kHypotheses[now], present)) ++now;
  const std::size_t good = simplestGood(trials, options_.negligible);
  if (!std::isfinite(trials[good].held_out)) return std::nullopt;  // nothing fits
  const double lead = trials[now].held_out - trials[good].held_out;
  const bool simpler = trials[good].fit.camera.estimatedCount() < present.estimatedCount();
  const double needed = simpler ? -options_.negligible : options_.decisive * (1 + switches_);
  const bool change = good != now && lead > needed;
  const std::size_t chosen = change ? good : now;
  evidence_.clear();
  for (std::size_t h = 0; h < trials.size(); ++h) {
    const double behind = trials[h].held_out - trials[chosen].held_out;
    evidence_.push_back({nameOf(kHypotheses[h]), h == chosen, h == chosen ? 0.0 : behind});
  }
  settled_ = !change;
  if (!change) return std::nullopt;
  ++switches_;
  return trials[good].fit.camera;
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
  if (chosen == nullptr || next == nullptr) return "";
  char text[200];
  std::snprintf(text, sizeof(text),
                "lens model %s, %.1f nats %s the next best, %s, on held-out observations",
                chosen->model.c_str(), std::abs(next->behind),
                next->behind < 0.0 ? "behind (and simpler than)" : "ahead of", next->model.c_str());
  return text;
}

}  // namespace camera_self_calibration
