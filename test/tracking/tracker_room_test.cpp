// The tracker on rendered images of a furnished room: depth edges, glancing surfaces, plain walls.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/simulation/simulated_sequence.h"
#include "tracking/track_errors.h"

namespace camera_self_calibration {
namespace {

// 140 degrees across the width.
Camera wideLens() {
  Intrinsics parameters(5);
  const double w = 1.0;
  const double f = 319.5 * w / std::atan(2.0 * std::tan(0.5 * w) * std::tan(70.0 * kDegree));
  parameters << f, f, 319.5, 239.5, w;
  return Camera(CameraModel::kFov, 640, 480, parameters);
}

ExactScene sceneOf(const SimulatedSequence& sequence) {
  ExactScene scene;
  scene.image = [&](int i) {
    const cv::Mat image = sequence.frame(i).image;
    return TestImage{
        image.cols, image.rows,
        std::vector<std::uint8_t>(image.begin<std::uint8_t>(), image.end<std::uint8_t>())};
  };
  scene.point = [&](int i, const Eigen::Vector2d& pixel) -> std::optional<Eigen::Vector3d> {
    const Rigid3 pose = sequence.worldFromCamera(i);
    const auto ray = sequence.camera(i).unproject(pixel);
    if (!ray) return std::nullopt;
    const Eigen::Vector3d direction = pose.rotation * *ray;
    const auto hit = sequence.world().castRay(pose.translation, direction);
    if (!hit) return std::nullopt;
    return Eigen::Vector3d(pose.translation + hit->distance * direction);
  };
  scene.pixel = [&](int i, const Eigen::Vector3d& point) -> std::optional<Eigen::Vector2d> {
    const Rigid3 pose = sequence.worldFromCamera(i);
    Eigen::Vector2d pixel;
    if (!sequence.world().visible(pose.translation, point)) return std::nullopt;
    if (!sequence.camera(i).project(pose.inverse() * point, &pixel)) return std::nullopt;
    return pixel;
  };
  return scene;
}

// Whether a patch lies on one surface of the world; the other corners are those of creases and of
// silhouettes, where what is seen is no point of the world.
bool onOneSurface(const SimulatedSequence& sequence, int image, const Eigen::Vector2d& pixel) {
  const Rigid3 pose = sequence.worldFromCamera(image);
  std::optional<int> surface;
  for (int k = 0; k < 16; ++k) {
    const double angle = k * M_PI / 8.0;
    const auto ray = sequence.camera(image).unproject(
        pixel + 7.0 * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    if (!ray) return false;
    const auto hit = sequence.world().castRay(pose.translation, pose.rotation * *ray);
    if (!hit || hit->surface != surface.value_or(hit->surface)) return false;
    surface = hit->surface;
  }
  return true;
}

struct Errors {
  std::vector<double> lengths;
  std::vector<double> after_30;
  double off = 0.0;  // By more than 1 px.
  double z2 = 0.0;

  void add(const TrackSample& sample) {
    lengths.push_back(sample.error.norm());
    if (sample.age >= 30) after_30.push_back(sample.error.norm());
    off += sample.error.norm() > 1.0;
    z2 += 0.5 * std::min(sample.error.squaredNorm() / (sample.sigma * sample.sigma), 25.0);
  }
  double offShare() const { return off / static_cast<double>(lengths.size()); }
  void print(const char* name) const {
    std::printf(
        "%s: n %zu, median error %.4f px, after 30 images (n %zu) %.4f px; off by more than "
        "1 px %.4f; z rms %.2f\n",
        name, lengths.size(), medianOf(lengths), after_30.size(), medianOf(after_30), offShare(),
        std::sqrt(z2 / static_cast<double>(lengths.size())));
  }
};

TEST(TrackerRoom, WideLensInAFurnishedRoom) {
  SequenceOptions options;
  options.lens.camera = wideLens();
  options.motion.kind = MotionKind::kHandheld;
  options.motion.seed = 4;
  options.rate_hz = 30.0;
  options.duration_s = 8.0;
  const SimulatedSequence sequence(options);
  Errors whole, other;
  std::vector<TrackSample> good;
  for (const TrackSample& sample : trackScene(sceneOf(sequence), sequence.size(), 6)) {
    if (sample.hidden) continue;
    const bool one = onOneSurface(sequence, sample.image - sample.age, sample.reference);
    (one ? whole : other).add(sample);
    if (one && sample.error.norm() < 1.0) good.push_back(sample);
  }
  whole.print("one surface in the patch");
  other.print("creases and silhouettes");
  ASSERT_GT(whole.after_30.size(), 500u);
  EXPECT_LT(medianOf(whole.after_30), 0.15);
  EXPECT_LT(medianOf(other.after_30), 0.15);
  EXPECT_LT(whole.offShare(), 0.005);
  // A coarse patch shows more of what is beside its own surface.
  EXPECT_LT(other.offShare(), 0.06);
  const Eigen::Vector2d centre(319.5, 239.5);
  EXPECT_LT(worstMean(byRadius(good, centre, true), "outwards", 100.0), 0.03);
  EXPECT_LT(worstMean(byRadius(good, centre, false), "inwards", 100.0), 0.03);
}

}  // namespace
}  // namespace camera_self_calibration
