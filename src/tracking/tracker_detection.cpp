#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "tracker_impl.h"

namespace camera_self_calibration {
namespace {

// Of a patch, in its own pixels.
constexpr double kAnchorReach = 2.0;  // From the centre to the tracked point.
constexpr int kMaskRadius = ReferencePatch::kRawRadius;
constexpr int kBorder = kMaskRadius + static_cast<int>(kAnchorReach) + 1;
constexpr int kSaturated = 250;                     // [gray]
constexpr double kMaxSaturatedShare = 0.25;         // Of a patch.
constexpr double kSameCorner = kAnchorReach + 1.0;  // [px] From the tip to the detector's maximum.
constexpr double kSpread = 0.4;  // Least distance, against that of features on a square grid.
// Corners that are tried, at most, for each feature wanted: where the image holds no more that can
// be followed, looking on would cost as much as all the rest.
constexpr std::size_t kTriesPerFeature = 3;

bool saturated(const cv::Mat& image, int x, int y) {
  constexpr int r = PatchPoints::kRadius;
  int count = 0;
  for (int row = y - r; row <= y + r; ++row) {
    const std::uint8_t* pixels = image.ptr<std::uint8_t>(row);
    for (int column = x - r; column <= x + r; ++column) count += pixels[column] >= kSaturated;
  }
  return count > kMaxSaturatedShare * (2 * r + 1) * (2 * r + 1);
}

// The nearest pixel of a level.
Eigen::Vector2i atLevel(const Corner& corner, int level) {
  const int half = (1 << level) / 2;
  return {(corner.x + half) >> level, (corner.y + half) >> level};
}

bool inside(const Eigen::Vector2i& pixel, const cv::Mat& image, int border) {
  return pixel.minCoeff() >= border && pixel.x() < image.cols - border &&
         pixel.y() < image.rows - border;
}

}  // namespace

double Tracker::Impl::minDistance() const {
  if (options.min_distance_px > 0.0) return options.min_distance_px;
  const double area = static_cast<double>(frame.width) * frame.height;
  return kSpread * std::sqrt(area / options.max_features);
}

int Tracker::Impl::cell() const {
  const double area = static_cast<double>(frame.width) * frame.height;
  return std::max(1, static_cast<int>(std::sqrt(area / options.max_features)));
}

// Whether a feature of that level may be there.
bool Tracker::Impl::allowed(const Corner& corner, int level) const {
  if (level >= current_.levels()) return false;
  const cv::Mat& image = current_.level(level);
  const Eigen::Vector2i centre = atLevel(corner, level);
  const int margin = kMaskRadius << level;
  return inside(centre, image, kBorder) && !mask_.touches(corner.x, corner.y, margin) &&
         usable_area_.contains(corner.x, corner.y, margin) &&
         !carried_.near({corner.x, corner.y}, minDistance()) &&
         !saturated(image, centre.x(), centre.y());
}

// Features in reserve keep no others away, but from the very same corner.
bool Tracker::Impl::crowded(const Eigen::Vector2d& pixel, double distance) const {
  return std::any_of(features.begin(), features.end(), [&](const Feature& feature) {
    const double reach = feature.good() ? distance : std::min(distance, kSameCorner);
    return (feature.place() - pixel).squaredNorm() < reach * reach;
  });
}

// Cuts the patch at the corner's tip, which lies beside the maximum of the detector's response.
bool Tracker::Impl::cut(const Corner& corner, int level, ReferencePatch* patch, Warp* warp) const {
  const double pixel = std::ldexp(1.0, level);
  Eigen::Vector2i centre = atLevel(corner, level);
  warp->linear = pixel * Eigen::Matrix2d::Identity();
  for (int pass = 0; pass < 2; ++pass) {
    patch->cut(current_.level(level), centre.x(), centre.y(), level);
    if (!registrations_[0].prepare(patch)) return false;
    patch->chooseAnchor(kAnchorReach);
    warp->pixel = pixel * centre.cast<double>();
    const Eigen::Vector2i step = patch->anchor().array().round().cast<int>();
    if (step.isZero()) return true;
    centre += step;
  }
  return true;
}

// A corner that cannot be found in the image before, such as one of noise, or where something near
// passes in front of what is far, will not be found in the next one either. True where it cannot be
// told, since that image does not show the place.
bool Tracker::Impl::seenBefore(Feature* feature) {
  if (previous_.empty()) return true;
  const LocalMotion::Motion motion = local_motion_.at(feature->warp.pixel);
  const Eigen::Vector2d shift = motion.pixel - feature->warp.pixel;
  const Eigen::Vector2f centre = feature->warp.pixel.cast<float>();
  const Eigen::Vector2f guess = (feature->warp.pixel - shift).cast<float>();
  cv::Point2f there(guess.x(), guess.y());
  LucasKanade::Effort effort;
  effort.coarsest_level = previous_.levels() - 1;
  const bool flows = backward_.follow(current_, 1.0f / flow_.gain(), {centre.x(), centre.y()},
                                      previous_, effort, &there);
  const Eigen::Vector2d pixel = flows ? Eigen::Vector2d(there.x, there.y) : guess.cast<double>();
  const Registration before =
      registrations_[0].run(&patches_[feature->patch], previous_,
                            {pixel, motion.linear.inverse() * feature->warp.linear});
  if (before.status == Registration::Status::kOutside) return true;
  const TrackGate& gate = gateOf(*feature);
  if (!gate.accepts(before) || !gate.looksTheSame(before)) return false;
  feature->velocity = feature->warp.pixel - before.warp.pixel;
  return true;
}

bool Tracker::Impl::begin(const Corner& corner, int level) {
  Feature feature;
  feature.patch = free_patches_.back();
  ReferencePatch& patch = patches_[feature.patch];
  if (!cut(corner, level, &patch, &feature.warp)) return false;
  feature.reference_pixel = feature.pixel =
      feature.warp.pixel + feature.warp.linear * patch.anchor();
  if (crowded(feature.pixel, minDistance())) return false;
  // Registered on itself: what sigma the next images are to expect.
  const Registration itself = registrations_[0].run(&patch, current_, feature.warp);
  const TrackGate& gate = gateOf(feature);
  if (!gate.accepts(itself) || gate.sigma(itself) > kGoodTrackSigma) return false;
  if (!seenBefore(&feature)) return false;
  feature.sigma = gate.sigma(itself);
  feature.id = next_id_++;
  free_patches_.pop_back();
  features.push_back(feature);
  return true;
}

LevelBalance::Counts Tracker::Impl::goodFeatures() const {
  LevelBalance::Counts counts{};
  for (const Feature& feature : features) {
    if (feature.good()) ++counts[static_cast<std::size_t>(levelOf(feature))];
  }
  return counts;
}

// The level that is due, or else, near what is masked or the edge, a finer one; -1: none.
int Tracker::Impl::levelFor(const Corner& corner, const LevelBalance::Counts& good) const {
  int level = balance_.next(good);
  while (level >= 0 && !allowed(corner, level)) --level;
  return level;
}

std::vector<Track> Tracker::Impl::detect() {
  std::vector<Track> started;
  mask_.update();
  frame.field = mask_.field(frame.width, frame.height);
  LevelBalance::Counts good = goodFeatures();
  const std::size_t there = std::accumulate(good.begin(), good.end(), std::size_t{0});
  const auto most = static_cast<std::size_t>(options.max_features);
  const std::size_t wanted = most - std::min(most, there);
  if (wanted == 0) return started;
  std::size_t tries = kTriesPerFeature * wanted;
  for (const Corner& corner : harris_.detect(current_, kBorder, cell())) {
    if (started.size() == wanted || tries == 0) break;
    const int level = levelFor(corner, good);
    if (level < 0 || crowded({corner.x, corner.y}, minDistance())) continue;
    --tries;
    if (!begin(corner, level)) continue;
    ++good[static_cast<std::size_t>(level)];
    const Feature& feature = features.back();
    started.push_back({feature.id, feature.pixel, feature.reference_pixel, feature.sigma});
  }
  listTracks();
  return started;
}

std::vector<Eigen::Vector2d> Tracker::Impl::corners(int count) {
  std::vector<Eigen::Vector2d> found;
  for (const Corner& corner : harris_.detect(current_, kBorder, cell())) {
    if (static_cast<int>(found.size()) >= count) break;
    if (crowded({corner.x, corner.y}, kSameCorner) || !allowed(corner, 0)) continue;
    found.emplace_back(corner.x, corner.y);
  }
  return found;
}

}  // namespace camera_self_calibration
