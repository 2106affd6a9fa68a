#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "camera_self_calibration/base/angle.h"
#include "tracking/track_errors.h"

namespace camera_self_calibration {
namespace {

Camera pinhole() {
  Intrinsics parameters(4);
  parameters << 300.0, 300.0, 319.5, 239.5;
  return Camera(CameraModel::kPinhole, 640, 480, parameters);
}

// 140 degrees across the width.
Camera wideLens() {
  Intrinsics parameters(5);
  const double w = 1.0;
  const double f = 319.5 * w / std::atan(2.0 * std::tan(0.5 * w) * std::tan(70.0 * kDegree));
  parameters << f, f, 319.5, 239.5, w;
  return Camera(CameraModel::kFov, 640, 480, parameters);
}

BoxRenderer::Photometry withNoise(double noise) {
  BoxRenderer::Photometry photometry;
  photometry.noise = noise;
  return photometry;
}

struct Summary {
  std::vector<double> lengths;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double z2 = 0.0;

  void add(const TrackSample& sample) {
    lengths.push_back(sample.error.norm());
    sum += sample.error;
    z2 += 0.5 * sample.error.squaredNorm() / (sample.sigma * sample.sigma);
  }
  double count() const { return static_cast<double>(lengths.size()); }
  double zRms() const { return std::sqrt(z2 / count()); }
};

// By age in steps of ten images.
std::map<int, Summary> byAge(const std::vector<TrackSample>& samples) {
  std::map<int, Summary> ages;
  for (const TrackSample& sample : samples) {
    if (!sample.hidden) ages[sample.age / 10].add(sample);
  }
  for (const auto& [age, summary] : ages) {
    std::printf("age %2d..%2d: n %5.0f, median error %.4f px, mean (%+.4f %+.4f), z rms %.2f\n",
                10 * age, 10 * age + 9, summary.count(), medianOf(summary.lengths),
                summary.sum.x() / summary.count(), summary.sum.y() / summary.count(),
                summary.zRms());
  }
  return ages;
}

Summary all(const std::vector<TrackSample>& samples) {
  Summary summary;
  for (const TrackSample& sample : samples) {
    if (!sample.hidden) summary.add(sample);
  }
  return summary;
}

std::vector<TrackSample> handHeld(double noise, int images) {
  static const BoxRenderer renderer(TexturedBox(7), pinhole(), 3);
  BoxSequence options;
  options.images = images;
  options.world_from_camera = [](int i) {
    return handHeldPose(i, {0.35, 0.3, 0.4}, {0.25, 0.3, 0.25}, 60.0);
  };
  options.photometry = [noise](int) { return withNoise(noise); };
  return trackSequence(renderer, options);
}

TEST(TrackerAccuracy, StaysSubPixelAndDoesNotDrift) {
  const std::map<int, Summary> ages = byAge(handHeld(1.0, 45));
  ASSERT_GT(ages.at(3).count(), 200);
  EXPECT_LT(medianOf(ages.at(3).lengths), 0.05);
  EXPECT_LT(medianOf(ages.at(4).lengths), 0.05);
  // Error that added up from image to image would grow with the square root of age at least.
  EXPECT_LT(medianOf(ages.at(3).lengths), 1.5 * medianOf(ages.at(1).lengths));
  const Summary total = all(handHeld(1.0, 20));
  EXPECT_LT((total.sum / total.count()).norm(), 0.01);
}

TEST(TrackerAccuracy, SigmaIsHonestAtAnyNoise) {
  for (const double noise : {0.5, 1.0, 2.0, 4.0}) {
    const Summary summary = all(handHeld(noise, 20));
    std::printf("noise %.1f: median error %.4f px, z rms %.2f\n", noise, medianOf(summary.lengths),
                summary.zRms());
    EXPECT_GT(summary.zRms(), 0.6) << noise;
    EXPECT_LT(summary.zRms(), 1.3) << noise;
  }
}

TEST(TrackerAccuracy, WideLensShowsNoSignedError) {
  const BoxRenderer renderer(TexturedBox(8), wideLens(), 3);
  BoxSequence options;
  options.images = 80;
  options.world_from_camera = [](int i) {
    return handHeldPose(i, {0.3, 0.3, 0.3}, {0.6, 0.9, 0.4}, 80.0);
  };
  const std::vector<TrackSample> samples = trackSequence(renderer, options);
  const std::map<int, Summary> ages = byAge(samples);
  EXPECT_LT(medianOf(ages.at(3).lengths), 0.05);
  const Eigen::Vector2d centre(319.5, 239.5);
  const auto outwards = byRadius(samples, centre, true), inwards = byRadius(samples, centre, false);
  EXPECT_GT(outwards.at(3).count, 200.0);
  EXPECT_GT(outwards.at(4).count, 200.0);
  EXPECT_GT(inwards.at(0).count, 200.0);
  EXPECT_LT(worstMean(outwards, "outwards", 50.0), 0.015);
  EXPECT_LT(worstMean(inwards, "inwards", 50.0), 0.015);
}

}  // namespace
}  // namespace camera_self_calibration
