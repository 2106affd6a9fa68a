#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tracker_impl.h"

namespace camera_self_calibration {
namespace {

constexpr double kAnchorReach = 2.0;  // [px] From a patch's centre to the tracked point.
constexpr int kMaskRadius = ReferencePatch::kRawRadius;
// [px] Around a corner when detected.
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

// Whether a feature may be there.
bool Tracker::Impl::allowed(const Corner& corner) const {
  return !mask_.touches(corner.x, corner.y, kMaskRadius) &&
         usable_area_.contains(corner.x, corner.y) &&
         !saturated(current_.level(0), corner.x, corner.y);
}

// Features in reserve keep no others away, but from the very same corner.
bool Tracker::Impl::crowded(const Eigen::Vector2d& pixel, double distance) const {
  return std::any_of(features.begin(), features.end(), [&](const Feature& feature) {
    const double reach = feature.good() ? distance : std::min(distance, kSameCorner);
    return (feature.place() - pixel).squaredNorm() < reach * reach;
  });
}

// Cuts the patch at the corner's tip, which lies beside the maximum of the detector's response.
bool Tracker::Impl::cut(const Corner& corner, ReferencePatch* patch, Warp* warp) const {
  Eigen::Vector2i centre(corner.x, corner.y);
  for (int pass = 0; pass < 2; ++pass) {
    patch->cut(current_.level(0), centre.x(), centre.y());
    if (!registrations_[0].prepare(patch)) return false;
    patch->chooseAnchor(kAnchorReach);
    warp->pixel = centre.cast<double>();
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
      registrations_[0].run(&patches_[feature->patch], previous_, {pixel, motion.linear.inverse()});
  if (before.status == Registration::Status::kOutside) return true;
  if (!gate_.accepts(before) || !gate_.looksTheSame(before)) return false;
  feature->velocity = feature->warp.pixel - before.warp.pixel;
  return true;
}

bool Tracker::Impl::begin(const Corner& corner) {
  Feature feature;
  feature.patch = free_patches_.back();
  ReferencePatch& patch = patches_[feature.patch];
  if (!cut(corner, &patch, &feature.warp)) return false;
  feature.reference_pixel = feature.pixel = feature.warp.pixel + patch.anchor();
  if (crowded(feature.pixel, minDistance())) return false;
  // Registered on itself: what sigma the next images are to expect.
  const Registration itself = registrations_[0].run(&patch, current_, feature.warp);
  if (!gate_.accepts(itself) || gate_.sigma(itself) > kGoodTrackSigma) return false;
  if (!seenBefore(&feature)) return false;
  feature.sigma = gate_.sigma(itself);
  feature.id = next_id_++;
  free_patches_.pop_back();
  features.push_back(feature);
  return true;
}

std::vector<Track> Tracker::Impl::detect() {
  std::vector<Track> started;
  mask_.update();
  frame.field = mask_.field(frame.width, frame.height);
  const auto good = std::count_if(features.begin(), features.end(),
                                  [](const Feature& feature) { return feature.good(); });
  const auto wanted =
      static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, options.max_features - good));
  if (wanted == 0) return started;
  std::size_t tries = kTriesPerFeature * wanted;
  for (const Corner& corner : harris_.detect(current_, kBorder, cell())) {
    if (started.size() == wanted || tries == 0) break;
    if (crowded({corner.x, corner.y}, minDistance()) || !allowed(corner)) continue;
    --tries;
    if (!begin(corner)) continue;
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
    if (crowded({corner.x, corner.y}, kSameCorner) || !allowed(corner)) continue;
    found.emplace_back(corner.x, corner.y);
  }
  return found;
}

}  // namespace camera_self_calibration
