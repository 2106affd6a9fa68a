#include "camera_self_calibration/tracking/tracker.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/camera/image_size.h"
#include "camera_self_calibration/tracking/scene_correlation.h"
#include "tracker_impl.h"

namespace camera_self_calibration {
namespace {

// Images for which a feature that is not found is looked for: a blink, a blurred image, somebody's
// arm. Further on, what its neighbours say of where it would be has added up to nothing.
constexpr int kMaxMissed = 5;
// Correlation of an image with the one before it: 0 to 0.4 after a cut, 0.8 at least without one
// (hand-held, on a drone, driving at 10 Hz). Half of the way, no more than a quarter of the
// variance of most of the image is explained by what it showed before.
constexpr double kRelated = 0.5;
// [longer sides of the image, per image] In slow motion the flow finds several times as much, and
// an image in which it finds nothing is another one. In fast motion it may fail in most of the
// image, and what it finds in the rest is worth having.
constexpr double kSlow = 0.01;
constexpr int kSlowImages = 3;  // in a row: one that is shown twice does not move at all
// Of the features, those that moved as their neighbours did: up to one in 25 after a cut. Where
// something large passes in front of a camera that stands still, those beside it do.
constexpr double kFollowed = 0.1;
constexpr double kNeighbourhood = 0.15;  // [longer sides of the image]

}  // namespace

Tracker::Impl::Impl(const TrackerOptions& o) : options(o), usable_area_(o.mask) {
  for (int level = 0; level < ReferencePatch::kLevels; ++level) {
    gates_.emplace_back(std::ldexp(1.0, level));
  }
  // As many in reserve as are wanted.
  const std::size_t capacity = 2 * static_cast<std::size_t>(options.max_features);
  patches_.resize(capacity);
  for (std::size_t i = capacity; i > 0; --i) free_patches_.push_back(i - 1);
}

void Tracker::Impl::restart() {
  keepIf([](const Feature&) { return false; });
  listTracks();
  current_.clear();
  previous_.clear();
  for (TrackGate& gate : gates_) gate.reset();
  balance_ = LevelBalance();
  unrelated_ = slow_images_ = 0;
}

void Tracker::Impl::load(const ImageView& image) {
  if (frame.width != image.width || frame.height != image.height) {
    restart();
    carried_.clear();
  }
  std::swap(previous_, current_);
  current_.build(image);
  usable_area_.setImageSize(image.width, image.height);
  mask_.add(current_);
  frame.stamp_ns = image.stamp_ns;
  frame.width = image.width;
  frame.height = image.height;
}

// Where the flow leads those that were found in the previous image.
void Tracker::Impl::predict() {
  from_.clear();
  predicted_.clear();
  flow_index_.assign(features.size(), -1);
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (features[i].missed > 0) continue;
    flow_index_[i] = static_cast<int>(from_.size());
    const Eigen::Vector2f at = features[i].warp.pixel.cast<float>();
    const Eigen::Vector2f guess =
        (features[i].warp.pixel + steps() * features[i].velocity).cast<float>();
    from_.emplace_back(at.x(), at.y());
    predicted_.emplace_back(guess.x(), guess.y());
  }
  flow_.run(previous_, current_, from_, &predicted_);
  zoom_search_.run(previous_, current_, from_, &flow_, &predicted_);
  local_motion_.fit(
      from_, predicted_, [this](std::size_t i) { return flow_.found(i); },
      kNeighbourhood * longerSide(frame.width, frame.height));
}

// By the flow, or else by the motion of the neighbours: where a feature nears the image's edge, or
// its surroundings change, the flow fails first. Features do not touch each other's state.
void Tracker::Impl::find(std::size_t i, PatchRegistration* worker) {
  Feature& feature = features[i];
  const LocalMotion::Motion motion = local_motion_.at(feature.warp.pixel);
  const Eigen::Matrix2d linear = motion.linear * feature.warp.linear;
  const int flow = flow_index_[i];
  if (flow >= 0 && flow_.found(static_cast<std::size_t>(flow))) {
    const cv::Point2f& there = predicted_[static_cast<std::size_t>(flow)];
    if (findFrom(i, {{there.x, there.y}, linear}, motion.pixel, worker)) return;
  }
  if (findFrom(i, {motion.pixel, linear}, motion.pixel, worker)) return;
  feature.velocity = (motion.pixel - feature.warp.pixel) / steps();
  feature.warp = {motion.pixel, linear};
  ++feature.missed;
}

// Where the neighbours do not expect it, only what looks the same is the same: else it is another
// corner that resembles it.
bool Tracker::Impl::accepts(const Feature& feature, const Registration& result,
                            const Eigen::Vector2d& expected) const {
  const TrackGate& gate = gateOf(feature);
  return gate.accepts(result) &&
         ((result.warp.pixel - expected).norm() <= local_motion_.scatter() ||
          gate.looksTheSame(result));
}

bool Tracker::Impl::findFrom(std::size_t i, const Warp& start, const Eigen::Vector2d& expected,
                             PatchRegistration* worker) {
  Feature& feature = features[i];
  const Registration result = worker->run(&patches_[feature.patch], current_, start);
  if (!accepts(feature, result, expected)) return false;
  feature.velocity = (result.warp.pixel - feature.warp.pixel) / steps();
  feature.warp = result.warp;
  feature.pixel = result.pixel;
  feature.sigma = gateOf(feature).sigma(result);
  feature.missed = 0;
  registered_[i] = result;
  return true;
}

void Tracker::Impl::search() {
  registered_.resize(features.size());
  inStripes(static_cast<int>(features.size()), [this](int stripe, int begin, int end) {
    PatchRegistration* worker = &registrations_[static_cast<std::size_t>(stripe)];
    for (int i = begin; i < end; ++i) {
      find(static_cast<std::size_t>(i), worker);
    }
  });
}

bool Tracker::Impl::mayReturn(const Feature& feature) const {
  return feature.missed <= kMaxMissed &&
         usable_area_.contains(feature.place().x(), feature.place().y(), marginOf(feature));
}

// What its patch covers [px].
int Tracker::Impl::marginOf(const Feature& feature) const {
  return ReferencePatch::kRawRadius << levelOf(feature);
}

// Features that are not found, or poorly, do not keep others from starting: they are followed
// beside those wanted. Those missed longest go first, then the poorest.
void Tracker::Impl::limitReserve() {
  reserve_.clear();
  for (const Feature& feature : features) {
    if (!feature.good()) reserve_.push_back(&feature);
  }
  const auto room = static_cast<std::size_t>(options.max_features);
  if (reserve_.size() <= room) return;
  const auto better = [](const Feature* a, const Feature* b) {
    if (a->missed != b->missed) return a->missed < b->missed;
    return a->sigma != b->sigma ? a->sigma < b->sigma : a->id < b->id;
  };
  const auto last = reserve_.begin() + static_cast<std::ptrdiff_t>(room) - 1;
  std::nth_element(reserve_.begin(), last, reserve_.end(), better);
  const Feature limit = **last;
  keepIf([&](const Feature& feature) { return feature.good() || !better(&limit, &feature); });
}

// Whether the features moved little through the newest images.
bool Tracker::Impl::isSlow() {
  speeds_.clear();
  for (const Feature& feature : features) {
    // Of a new one none is known yet.
    if (feature.missed == 0 && !feature.velocity.isZero(0.0)) {
      speeds_.push_back(feature.velocity.norm());
    }
  }
  const double slow = kSlow * longerSide(frame.width, frame.height);
  slow_images_ = !speeds_.empty() && medianInPlace(&speeds_) < slow ? slow_images_ + 1 : 0;
  return slow_images_ >= kSlowImages;
}

// Whether the image shows something else: hardly a feature moved as its neighbours did, and its
// blocks are unlike those of the previous one.
bool Tracker::Impl::isUnrelated() const {
  const auto enough = static_cast<int>(kFollowed * static_cast<double>(from_.size()));
  return !local_motion_.expectsMoreThan(enough) &&
         sceneCorrelation(previous_, current_, local_motion_) < kRelated;
}

// The next image is compared with the one before a blink, as if it had not been taken. After a cut
// no image is like the one before: then all begins anew.
bool Tracker::Impl::followsPrevious() {
  if (!isSlow() || !isUnrelated()) return true;
  if (++unrelated_ <= kMaxMissed) {
    std::swap(previous_, current_);
  } else {
    restart();
  }
  return false;
}

bool Tracker::Impl::advance() {
  predict();
  frame.unrelated = !followsPrevious();
  if (frame.unrelated) {
    frame.tracks.clear();
    frame.carried.clear();
    return false;
  }
  search();
  learn();
  keepIf([this](const Feature& feature) { return mayReturn(feature); });
  limitReserve();
  listTracks();
  frame.carried = carried_.add(frame);
  if (!frame.carried.empty()) end(frame.carried);
  unrelated_ = 0;
  return true;
}

// From the features that were found: the noise, and what the features of each level tell.
void Tracker::Impl::learn() {
  balance_.forget();
  for (std::vector<Registration>& accepted : accepted_) accepted.clear();
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (features[i].missed > 0) continue;
    const int level = levelOf(features[i]);
    balance_.measured(level, features[i].sigma);
    accepted_[static_cast<std::size_t>(level)].push_back(registered_[i]);
  }
  for (int level = 0; level < ReferencePatch::kLevels; ++level) {
    TrackGate& gate = gates_[static_cast<std::size_t>(level)];
    gate.learn(accepted_[static_cast<std::size_t>(level)]);
    for (PatchRegistration& worker : registrations_) worker.setNoise(level, gate.whiteNoise());
  }
}

void Tracker::Impl::end(const std::vector<std::int64_t>& ids) {
  keepIf([&](const Feature& feature) {
    return std::find(ids.begin(), ids.end(), feature.id) == ids.end();
  });
  listTracks();
}

void Tracker::Impl::listTracks() {
  frame.tracks.clear();
  for (const Feature& feature : features) {
    if (feature.missed > 0) continue;
    frame.tracks.push_back({feature.id, feature.pixel, feature.reference_pixel, feature.sigma});
  }
}

Tracker::Tracker(const TrackerOptions& options) {
  const std::vector<std::string> problems = options.problems();
  if (!problems.empty()) {
    std::string message = "TrackerOptions:";
    for (const std::string& problem : problems) message += " " + problem;
    throw std::invalid_argument(message);
  }
  impl_ = std::make_unique<Impl>(options);
}

Tracker::~Tracker() = default;

const TrackedFrame& Tracker::track(const ImageView& image) {
  const bool is_image = ImagePyramid::usable(image);
  if (is_image) impl_->load(image);
  impl_->usable = is_image && impl_->advance();
  if (is_image) return impl_->frame;
  impl_->nothing.stamp_ns = image.stamp_ns;
  return impl_->nothing;
}

std::vector<Track> Tracker::detect() {
  return impl_->usable ? impl_->detect() : std::vector<Track>();
}

std::vector<Eigen::Vector2d> Tracker::corners(int count) {
  return impl_->usable ? impl_->corners(count) : std::vector<Eigen::Vector2d>();
}

void Tracker::drop(const std::vector<std::int64_t>& ids) { impl_->end(ids); }

void Tracker::reset() {
  impl_->restart();
  impl_->usable = false;
}

}  // namespace camera_self_calibration
