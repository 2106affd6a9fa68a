#include "camera_self_calibration/simulation/feature_tracks.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace camera_self_calibration {
namespace {

constexpr double kSmallestOutlierPx = 3.0;
constexpr int kDetectionTrials = 30;  // places tried per missing track

Eigen::Vector2d direction(Random* random) {
  const double angle = random->uniform(0.0, 2.0 * M_PI);
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

std::vector<std::string> FeatureTracksOptions::problems() const {
  std::vector<std::string> found;
  const auto share = [&found](double value, const char* name) {
    if (!(value >= 0.0 && value <= 1.0)) found.push_back(std::string(name) + " must be in [0, 1]");
  };
  const auto size = [&found](double value, const char* name) {
    if (!(value >= 0.0)) found.push_back(std::string(name) + " must not be negative");
  };
  if (max_features < 1) found.push_back("max_features must be at least 1");
  size(pixel_sigma, "pixel_sigma");
  size(reported_sigma, "reported_sigma");
  size(reference_sigma, "reference_sigma");
  size(border_px, "border_px");
  size(line_delay_s, "line_delay_s");
  share(outlier_share, "outlier_share");
  share(drifting_share, "drifting_share");
  share(loss_probability, "loss_probability");
  if (!(outlier_px >= kSmallestOutlierPx)) found.push_back("outlier_px must be at least 3");
  return found;
}

FeatureTracks::FeatureTracks(World world, Lens lens, Trajectory trajectory,
                             const FeatureTracksOptions& options)
    : world_(std::move(world)),
      lens_(std::move(lens)),
      trajectory_(std::move(trajectory)),
      options_(options),
      random_(mixSeed(options.seed, 4)) {
  std::string message;
  for (const std::string& problem : options.problems()) message += problem + "; ";
  if (!lens_.camera.valid()) message += "the simulated camera's parameters are not valid; ";
  if (!message.empty()) throw std::invalid_argument("feature tracks: " + message);
}

Rigid3 FeatureTracks::poseOfRow(double row) const {
  return trajectory_.worldFromCamera(time_s_ + row * options_.line_delay_s);
}

std::optional<Eigen::Vector2d> FeatureTracks::project(const Eigen::Vector3d& point,
                                                      double time_s) const {
  const Camera camera = lens_.at(time_s);
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Rigid3 world_from_camera;
  // The row of a point depends on when it is seen; few steps settle it.
  const int steps = options_.line_delay_s > 0.0 ? 4 : 1;
  for (int i = 0; i < steps; ++i) {
    world_from_camera = trajectory_.worldFromCamera(time_s + pixel.y() * options_.line_delay_s);
    if (!camera.project(world_from_camera.inverse() * point, &pixel)) return std::nullopt;
  }
  if (!camera.inImage(pixel, options_.border_px)) return std::nullopt;
  if (options_.occlusion && !world_.visible(world_from_camera.translation, point)) {
    return std::nullopt;
  }
  return pixel;
}

// Measures a track in the current frame; false if it ends.
bool FeatureTracks::advance(Live* live) {
  const bool lost = random_.chance(options_.loss_probability);
  const Eigen::Vector2d noise = options_.pixel_sigma * random_.normal2();
  const bool outlier = random_.chance(options_.outlier_share);
  const std::optional<Eigen::Vector2d> pixel = project(live->point, time_s_);
  if (lost || !pixel) return false;
  live->drift += live->drift_per_frame;
  live->track.pixel = *pixel + noise + live->drift;
  if (outlier) {
    const double size = random_.uniform(kSmallestOutlierPx, options_.outlier_px);
    live->track.pixel += size * direction(&random_);
  }
  if (outlier || !live->drift.isZero()) outliers_.insert(live->track.id);
  return lens_.camera.inImage(live->track.pixel, options_.border_px);
}

const TrackedFrame& FeatureTracks::track(std::int64_t stamp_ns) {
  time_s_ = timeOf(stamp_ns);
  outliers_.clear();
  frame_.stamp_ns = stamp_ns;
  frame_.width = lens_.camera.width();
  frame_.height = lens_.camera.height();
  frame_.tracks.clear();
  std::vector<Live> still_live;
  for (Live& live : live_) {
    if (!advance(&live)) continue;
    still_live.push_back(live);
    frame_.tracks.push_back(live.track);
  }
  live_ = std::move(still_live);
  return frame_;
}

bool FeatureTracks::isFree(const Eigen::Vector2d& pixel) const {
  const double area = static_cast<double>(frame_.width) * frame_.height;
  const double distance = 0.6 * std::sqrt(area / options_.max_features);
  return std::all_of(live_.begin(), live_.end(), [&](const Live& live) {
    return (live.track.pixel - pixel).norm() >= distance;
  });
}

// One trial: nothing where the place is taken or nothing is seen.
std::optional<FeatureTracks::Live> FeatureTracks::startTrack() {
  const double border = options_.border_px;
  const Eigen::Vector2d pixel(random_.uniform(border, frame_.width - 1 - border),
                              random_.uniform(border, frame_.height - 1 - border));
  const std::optional<Eigen::Vector3d> ray = lens_.at(time_s_).unproject(pixel);
  if (!ray || !isFree(pixel)) return std::nullopt;
  const Rigid3 world_from_camera = poseOfRow(pixel.y());
  const Eigen::Vector3d direction_in_world = world_from_camera.rotation * *ray;
  const std::optional<Hit> hit = world_.castRay(world_from_camera.translation, direction_in_world);
  if (!hit) return std::nullopt;
  Live live;
  live.point = world_from_camera.translation + hit->distance * direction_in_world;
  live.track.id = next_id_++;
  live.track.reference_pixel = pixel + options_.reference_sigma * random_.normal2();
  live.track.pixel = live.track.reference_pixel;
  live.track.sigma = options_.reported_sigma > 0.0 ? options_.reported_sigma
                     : options_.pixel_sigma > 0.0  ? options_.pixel_sigma
                                                   : 0.1;
  if (random_.chance(options_.drifting_share)) {
    live.drift_per_frame = random_.uniform(1.0, 3.0) * direction(&random_);
  }
  return live;
}

std::vector<Track> FeatureTracks::detect() {
  std::vector<Track> started;
  if (frame_.width == 0) return started;  // nothing tracked yet
  const int missing = options_.max_features - static_cast<int>(live_.size());
  for (int trial = 0; trial < kDetectionTrials * missing; ++trial) {
    if (static_cast<int>(live_.size()) >= options_.max_features) break;
    const std::optional<Live> live = startTrack();
    if (!live) continue;
    live_.push_back(*live);
    started.push_back(live->track);
  }
  return started;
}

void FeatureTracks::drop(const std::vector<std::int64_t>& ids) {
  const std::unordered_set<std::int64_t> gone(ids.begin(), ids.end());
  live_.erase(std::remove_if(live_.begin(), live_.end(),
                             [&](const Live& live) { return gone.count(live.track.id) > 0; }),
              live_.end());
}

void FeatureTracks::reset() { live_.clear(); }

std::optional<Eigen::Vector3d> FeatureTracks::point(std::int64_t id) const {
  const auto found = std::find_if(live_.begin(), live_.end(),
                                  [id](const Live& live) { return live.track.id == id; });
  if (found == live_.end()) return std::nullopt;
  return found->point;
}

}  // namespace camera_self_calibration
