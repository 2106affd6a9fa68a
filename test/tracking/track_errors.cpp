#include "tracking/track_errors.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

// What is true of a track, from the image of its detection on.
struct TrueTrack {
  int first_image = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
};

TrackSample compare(const BoxRenderer& renderer, const Rigid3& pose, const Track& track, int image,
                    TrueTrack* true_track) {
  TrackSample sample;
  sample.id = track.id;
  sample.image = image;
  sample.age = image - true_track->first_image;
  sample.reference = track.reference_pixel;
  sample.sigma = track.sigma;
  sample.last_truth = true_track->last;
  const auto truth = renderer.project(pose, true_track->point);
  sample.hidden = !truth;
  if (truth) {
    sample.truth = *truth;
    sample.error = track.pixel - *truth;
    true_track->last = *truth;
  }
  return sample;
}

}  // namespace

std::vector<TrackSample> trackSequence(const BoxRenderer& renderer,
                                       const SequenceOptions& options) {
  std::mt19937_64 random(options.noise_seed);
  Tracker tracker(options.tracker);
  std::map<std::int64_t, TrueTrack> truth;
  std::vector<TrackSample> samples;
  for (int i = 0; i < options.images; ++i) {
    const Rigid3 pose = options.world_from_camera(i);
    const TestImage image = renderer.render(pose, options.photometry(i), &random);
    const TrackedFrame& frame = tracker.track(image.view(i));
    for (const Track& track : frame.tracks) {
      samples.push_back(compare(renderer, pose, track, i, &truth.at(track.id)));
    }
    if (i % options.detect_every != 0) continue;
    for (const Track& track : tracker.detect()) {
      const auto hit = renderer.hit(pose, track.pixel);
      truth[track.id] = {i, hit->point, track.pixel};
    }
  }
  return samples;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Rigid3 handHeldPose(int image, const Eigen::Vector3d& translation, const Eigen::Vector3d& rotation,
                    double period_images) {
  const double phase = 2.0 * M_PI * image / period_images;
  const Eigen::Vector3d wave(std::sin(phase), std::sin(1.31 * phase + 0.5),
                             std::sin(0.77 * phase + 1.1));
  const Eigen::Vector3d other(std::sin(0.9 * phase + 0.3), std::sin(1.13 * phase),
                              std::sin(0.61 * phase + 0.2));
  return {expSo3(rotation.cwiseProduct(other)), translation.cwiseProduct(wave)};
}

}  // namespace camera_self_calibration
