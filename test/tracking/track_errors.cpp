#include "tracking/track_errors.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

// What is true of a track, from the image of its detection on.
struct TrueTrack {
  int first_image = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector2d last = Eigen::Vector2d::Zero();
};

TrackSample compare(const ExactScene& scene, const Track& track, int image, TrueTrack* true_track) {
  TrackSample sample;
  sample.id = track.id;
  sample.image = image;
  sample.age = image - true_track->first_image;
  sample.reference = track.reference_pixel;
  sample.sigma = track.sigma;
  sample.last_truth = true_track->last;
  const auto truth = scene.pixel(image, true_track->point);
  sample.hidden = !truth;
  if (truth) {
    sample.truth = *truth;
    sample.error = track.pixel - *truth;
    true_track->last = *truth;
  }
  return sample;
}

}  // namespace

std::vector<TrackSample> trackScene(const ExactScene& scene, int images, int detect_every) {
  Tracker tracker{TrackerOptions()};
  std::map<std::int64_t, TrueTrack> truth;
  std::vector<TrackSample> samples;
  for (int i = 0; i < images; ++i) {
    const TestImage image = scene.image(i);
    for (const Track& track : tracker.track(image.view(i)).tracks) {
      const auto known = truth.find(track.id);
      if (known != truth.end()) samples.push_back(compare(scene, track, i, &known->second));
    }
    if (i % detect_every != 0) continue;
    for (const Track& track : tracker.detect()) {
      const auto point = scene.point(i, track.pixel);
      if (point) truth[track.id] = {i, *point, track.pixel};
    }
  }
  return samples;
}

std::vector<TrackSample> trackSequence(const BoxRenderer& renderer, const BoxSequence& sequence) {
  std::mt19937_64 random(sequence.noise_seed);
  ExactScene scene;
  scene.image = [&](int i) {
    return renderer.render(sequence.world_from_camera(i), sequence.photometry(i), &random);
  };
  scene.point = [&](int i, const Eigen::Vector2d& pixel) -> std::optional<Eigen::Vector3d> {
    const auto hit = renderer.hit(sequence.world_from_camera(i), pixel);
    if (!hit) return std::nullopt;
    return hit->point;
  };
  scene.pixel = [&](int i, const Eigen::Vector3d& point) {
    return renderer.project(sequence.world_from_camera(i), point);
  };
  return trackScene(scene, sequence.images, sequence.detect_every);
}

std::map<int, RadialBin> byRadius(const std::vector<TrackSample>& samples,
                                  const Eigen::Vector2d& centre, bool outwards) {
  std::map<int, RadialBin> bins;
  for (const TrackSample& sample : samples) {
    if (sample.hidden) continue;
    const double radius = (sample.truth - centre).norm();
    const double travelled = radius - (sample.reference - centre).norm();
    if ((outwards ? travelled : -travelled) < 100.0) continue;
    RadialBin& bin = bins[static_cast<int>(radius) / 75];
    bin.count += 1.0;
    bin.radial += sample.error.dot(sample.truth - centre) / radius;
    bin.along_motion += sample.error.dot((sample.truth - sample.last_truth).normalized());
    bin.from_reference += sample.error.dot((sample.truth - sample.reference).normalized());
  }
  for (auto& [key, bin] : bins) {
    bin.radial /= bin.count;
    bin.along_motion /= bin.count;
    bin.from_reference /= bin.count;
  }
  return bins;
}

double worstMean(const std::map<int, RadialBin>& bins, const char* direction, double least) {
  double worst = 0.0;
  for (const auto& [key, bin] : bins) {
    std::printf(
        "%s, radius %3d..%3d px: n %5.0f, radial %+.4f, along the motion %+.4f, away from "
        "the reference %+.4f px\n",
        direction, 75 * key, 75 * key + 74, bin.count, bin.radial, bin.along_motion,
        bin.from_reference);
    if (bin.count < least) continue;
    worst = std::max(
        {worst, std::abs(bin.radial), std::abs(bin.along_motion), std::abs(bin.from_reference)});
  }
  return worst;
}

double medianOf(std::vector<double> values) {
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
