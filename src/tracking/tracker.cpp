#include "camera_self_calibration/tracking/tracker.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "camera_self_calibration/tracking/field_mask.h"
#include "camera_self_calibration/tracking/flow_prediction.h"
#include "camera_self_calibration/tracking/harris.h"
#include "camera_self_calibration/tracking/local_motion.h"
#include "camera_self_calibration/tracking/patch_registration.h"
#include "camera_self_calibration/tracking/pyramid.h"
#include "camera_self_calibration/tracking/stripes.h"
#include "camera_self_calibration/tracking/track_gate.h"
#include "camera_self_calibration/tracking/usable_area.h"
#include "camera_self_calibration/tracking/zoom_search.h"

namespace camera_self_calibration {
namespace {

constexpr double kAnchorReach = 2.0;  // [px] From a patch's centre to the tracked point.
// [px] Around a corner when detected.
constexpr int kBorder = ReferencePatch::kRawRadius + static_cast<int>(kAnchorReach) + 1;
constexpr int kMaskRadius = ReferencePatch::kRawRadius;
constexpr double kNeighbourhood = 0.15;             // [image widths]
constexpr int kSaturated = 250;                     // [gray]
constexpr double kMaxSaturatedShare = 0.25;         // Of a patch.
constexpr double kMaxSigma = 0.2;                   // [px] Of a new track.
constexpr double kSameCorner = kAnchorReach + 1.0;  // [px] From the tip to the detector's maximum.
constexpr double kSpread = 0.4;  // Least distance, against that of features on a square grid.

bool saturated(const cv::Mat& image, int x, int y) {
  constexpr int r = PatchPoints::kRadius;
  int count = 0;
  for (int row = y - r; row <= y + r; ++row) {
    const std::uint8_t* pixels = image.ptr<std::uint8_t>(row);
    for (int column = x - r; column <= x + r; ++column) count += pixels[column] >= kSaturated;
  }
  return count > kMaxSaturatedShare * (2 * r + 1) * (2 * r + 1);
}

}  // namespace

struct Tracker::Impl {
  // Beside the public Track of the same index.
  struct State {
    Warp warp;
    Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  // [px per image]
    std::size_t patch = 0;                               // Index in patches.
  };

  explicit Impl(const TrackerOptions& o) : options(o), usable_area(o.mask, kMaskRadius) {
    const auto capacity = static_cast<std::size_t>(options.max_features);
    patches.resize(capacity);
    for (std::size_t i = capacity; i > 0; --i) free_patches.push_back(i - 1);
  }

  double minDistance() const;
  void restart();
  void load(const ImageView& image);
  void advance();
  void predict();
  bool registerTrack(std::size_t i, PatchRegistration* worker);
  bool registerFrom(std::size_t i, const Warp& start, PatchRegistration* worker);
  void registerAll();
  template <typename Keep>
  void keepIf(const Keep& keep);
  int cell() const;
  bool allowed(const Corner& corner) const;
  bool crowded(const Eigen::Vector2d& pixel, double distance) const;
  bool cut(const Corner& corner, ReferencePatch* patch, Warp* warp) const;
  bool begin(const Corner& corner);

  TrackerOptions options;
  bool usable = false;  // Whether the image tracked last was an image.
  std::int64_t next_id = 0;
  TrackedFrame frame;
  TrackedFrame nothing;
  std::vector<State> states;
  std::vector<ReferencePatch> patches;
  std::vector<std::size_t> free_patches;

  ImagePyramid previous;
  ImagePyramid current;
  FieldMask mask;  // Kept over a restart: the lens is the same.
  UsableArea usable_area;
  FlowPrediction flow;
  ZoomSearch zoom_search;
  LocalMotion local_motion;
  std::array<PatchRegistration, kStripes> registrations;
  TrackGate gate;
  HarrisDetector harris;
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> predicted;
  // Of all tracks of an image, whether they were registered and how; of those that were.
  std::vector<char> found;
  std::vector<Registration> registered;
  std::vector<Registration> accepted;
};

double Tracker::Impl::minDistance() const {
  if (options.min_distance_px > 0.0) return options.min_distance_px;
  const double area = static_cast<double>(frame.width) * frame.height;
  return kSpread * std::sqrt(area / options.max_features);
}

void Tracker::Impl::restart() {
  keepIf([](std::size_t) { return false; });
  current.clear();
  previous.clear();
  gate.reset();
}

void Tracker::Impl::load(const ImageView& image) {
  if (current.size() != cv::Size(image.width, image.height)) restart();
  std::swap(previous, current);
  current.build(image);
  usable_area.setImageSize(image.width, image.height);
  mask.add(current);
  frame.stamp_ns = image.stamp_ns;
  frame.width = image.width;
  frame.height = image.height;
}

void Tracker::Impl::predict() {
  from.clear();
  predicted.clear();
  for (const State& state : states) {
    const Eigen::Vector2f at = state.warp.pixel.cast<float>();
    const Eigen::Vector2f guess = (state.warp.pixel + state.velocity).cast<float>();
    from.emplace_back(at.x(), at.y());
    predicted.emplace_back(guess.x(), guess.y());
  }
  flow.run(previous, current, from, &predicted);
  zoom_search.run(previous, current, from, &flow, &predicted);
  local_motion.fit(
      from, predicted, [this](std::size_t i) { return flow.found(i); },
      kNeighbourhood * frame.width);
}

// By the flow, or else by the motion of the neighbours: where a feature nears the image's edge, or
// its surroundings change, the flow fails first. Tracks do not touch each other's state.
bool Tracker::Impl::registerTrack(std::size_t i, PatchRegistration* worker) {
  const State& state = states[i];
  const LocalMotion::Motion motion = local_motion.at(state.warp.pixel);
  const Eigen::Matrix2d linear = motion.linear * state.warp.linear;
  if (flow.found(i) && registerFrom(i, {{predicted[i].x, predicted[i].y}, linear}, worker)) {
    return true;
  }
  return registerFrom(i, {motion.pixel, linear}, worker);
}

bool Tracker::Impl::registerFrom(std::size_t i, const Warp& start, PatchRegistration* worker) {
  State& state = states[i];
  const Registration result = worker->run(&patches[state.patch], current, start);
  if (!gate.accepts(result)) return false;
  state.velocity = result.warp.pixel - state.warp.pixel;
  state.warp = result.warp;
  frame.tracks[i].pixel = result.pixel;
  frame.tracks[i].sigma = gate.sigma(result);
  registered[i] = result;
  return true;
}

void Tracker::Impl::registerAll() {
  found.assign(states.size(), 0);
  registered.resize(states.size());
  inStripes(static_cast<int>(states.size()), [this](int stripe, int begin, int end) {
    PatchRegistration* worker = &registrations[static_cast<std::size_t>(stripe)];
    for (int i = begin; i < end; ++i) {
      const auto track = static_cast<std::size_t>(i);
      found[track] = registerTrack(track, worker);
    }
  });
}

void Tracker::Impl::advance() {
  predict();
  registerAll();
  accepted.clear();
  keepIf([this](std::size_t i) {
    if (found[i] == 0) return false;
    accepted.push_back(registered[i]);
    return usable_area.contains(registered[i].pixel.x(), registered[i].pixel.y());
  });
  gate.learn(accepted);
  for (PatchRegistration& worker : registrations) worker.setNoise(gate.whiteNoise());
}

// Calls keep(i) once for each track, in order, and ends those for which it is false.
template <typename Keep>
void Tracker::Impl::keepIf(const Keep& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (keep(i)) {
      states[kept] = states[i];
      frame.tracks[kept++] = frame.tracks[i];
    } else {
      free_patches.push_back(states[i].patch);
    }
  }
  states.resize(kept);
  frame.tracks.resize(kept);
}

int Tracker::Impl::cell() const {
  const double area = static_cast<double>(frame.width) * frame.height;
  return std::max(1, static_cast<int>(std::sqrt(area / options.max_features)));
}

// Whether a feature may be there.
bool Tracker::Impl::allowed(const Corner& corner) const {
  return !mask.touches(corner.x, corner.y, kMaskRadius) &&
         usable_area.contains(corner.x, corner.y) &&
         !saturated(current.level(0), corner.x, corner.y);
}

bool Tracker::Impl::crowded(const Eigen::Vector2d& pixel, double distance) const {
  return std::any_of(frame.tracks.begin(), frame.tracks.end(), [&](const Track& track) {
    return (track.pixel - pixel).squaredNorm() < distance * distance;
  });
}

// Cuts the patch at the corner's tip, which lies beside the maximum of the detector's response.
bool Tracker::Impl::cut(const Corner& corner, ReferencePatch* patch, Warp* warp) const {
  Eigen::Vector2i centre(corner.x, corner.y);
  for (int pass = 0; pass < 2; ++pass) {
    patch->cut(current.level(0), centre.x(), centre.y());
    if (!registrations[0].prepare(patch)) return false;
    patch->chooseAnchor(kAnchorReach);
    warp->pixel = centre.cast<double>();
    const Eigen::Vector2i step = patch->anchor().array().round().cast<int>();
    if (step.isZero()) return true;
    centre += step;
  }
  return true;
}

bool Tracker::Impl::begin(const Corner& corner) {
  const std::size_t slot = free_patches.back();
  Warp warp;
  if (!cut(corner, &patches[slot], &warp)) return false;
  const Eigen::Vector2d pixel = warp.pixel + patches[slot].anchor();
  if (crowded(pixel, minDistance())) return false;
  // Registered on itself: what sigma the next images are to expect.
  const Registration itself = registrations[0].run(&patches[slot], current, warp);
  if (!gate.accepts(itself) || gate.sigma(itself) > kMaxSigma) return false;
  free_patches.pop_back();
  states.push_back({warp, Eigen::Vector2d::Zero(), slot});
  frame.tracks.push_back({next_id++, pixel, pixel, gate.sigma(itself)});
  return true;
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
  impl_->usable = ImagePyramid::usable(image);
  if (!impl_->usable) {
    impl_->nothing.stamp_ns = image.stamp_ns;
    return impl_->nothing;
  }
  impl_->load(image);
  impl_->advance();
  return impl_->frame;
}

std::vector<Track> Tracker::detect() {
  std::vector<Track> started;
  if (!impl_->usable || impl_->free_patches.empty()) return started;
  impl_->mask.update();
  impl_->frame.field = impl_->mask.field(impl_->frame.width, impl_->frame.height);
  for (const Corner& corner : impl_->harris.detect(impl_->current, kBorder, impl_->cell())) {
    if (impl_->free_patches.empty()) break;
    if (impl_->crowded({corner.x, corner.y}, impl_->minDistance())) continue;
    if (!impl_->allowed(corner)) continue;
    if (impl_->begin(corner)) started.push_back(impl_->frame.tracks.back());
  }
  return started;
}

std::vector<Eigen::Vector2d> Tracker::corners(int count) {
  if (!impl_->usable) return {};
  std::vector<Eigen::Vector2d> found;
  for (const Corner& corner : impl_->harris.detect(impl_->current, kBorder, impl_->cell())) {
    if (static_cast<int>(found.size()) >= count) break;
    if (impl_->crowded({corner.x, corner.y}, kSameCorner) || !impl_->allowed(corner)) continue;
    found.emplace_back(corner.x, corner.y);
  }
  return found;
}

void Tracker::drop(const std::vector<std::int64_t>& ids) {
  impl_->keepIf([&](std::size_t i) {
    return std::find(ids.begin(), ids.end(), impl_->frame.tracks[i].id) == ids.end();
  });
}

void Tracker::reset() {
  impl_->restart();
  impl_->usable = false;
}

std::vector<std::string> TrackerOptions::problems() const {
  std::vector<std::string> found;
  if (max_features < 1 || max_features > 10000) {
    found.push_back("max_features must lie between 1 and 10000; it is " +
                    std::to_string(max_features) + ".");
  }
  if (!(min_distance_px >= 0.0 && std::isfinite(min_distance_px))) {
    found.push_back(
        "min_distance_px must be 0 (chosen automatically) or a positive number of "
        "pixels.");
  }
  return found;
}

}  // namespace camera_self_calibration
