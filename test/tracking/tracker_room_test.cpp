// The tracker on rendered images of a furnished room: depth edges, glancing surfaces, plain walls.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "camera_self_calibration/simulation/simulated_sequence.h"
#include "tracking/track_errors.h"

namespace camera_self_calibration {
namespace {

// 140 degrees across the width.
Camera wideLens() {
  Intrinsics parameters(5);
  const double w = 1.0;
  const double f = 319.5 * w / std::atan(2.0 * std::tan(0.5 * w) * std::tan(70.0 * M_PI / 180.0));
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

double share(const std::vector<double>& values, double above) {
  double count = 0.0;
  for (const double value : values) count += value > above;
  return count / static_cast<double>(values.size());
}

TEST(TrackerRoom, WideLensInAFurnishedRoom) {
  SequenceOptions options;
  options.lens.camera = wideLens();
  options.motion.kind = MotionKind::kHandheld;
  options.motion.seed = 4;
  options.rate_hz = 30.0;
  options.duration_s = 8.0;
  const SimulatedSequence sequence(options);
  const auto samples = trackScene(sceneOf(sequence), sequence.size(), 6);
  std::vector<double> errors, old_errors;
  double z2 = 0.0;
  for (const TrackSample& sample : samples) {
    if (sample.hidden) continue;
    errors.push_back(sample.error.norm());
    z2 += 0.5 * sample.error.squaredNorm() / (sample.sigma * sample.sigma);
    if (sample.age >= 30) old_errors.push_back(sample.error.norm());
  }
  const double hidden = static_cast<double>(samples.size() - errors.size());
  std::printf(
      "n %zu, median error %.4f px, after 30 images (n %zu) %.4f px; above 0.5 px %.4f; "
      "hidden %.4f; z rms %.2f\n",
      errors.size(), medianOf(errors), old_errors.size(), medianOf(old_errors), share(errors, 0.5),
      hidden / static_cast<double>(samples.size()),
      std::sqrt(z2 / static_cast<double>(errors.size())));
  ASSERT_GT(old_errors.size(), 500u);
  EXPECT_LT(medianOf(old_errors), 0.15);
  EXPECT_LT(share(errors, 0.5), 0.02);
  const Eigen::Vector2d centre(319.5, 239.5);
  EXPECT_LT(worstMean(byRadius(samples, centre, true), "outwards", 100.0), 0.03);
  EXPECT_LT(worstMean(byRadius(samples, centre, false), "inwards", 100.0), 0.03);
}

}  // namespace
}  // namespace camera_self_calibration
