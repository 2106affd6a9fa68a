#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

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
  const double f = 319.5 * w / std::atan(2.0 * std::tan(0.5 * w) * std::tan(70.0 * M_PI / 180.0));
  parameters << f, f, 319.5, 239.5, w;
  return Camera(CameraModel::kFov, 640, 480, parameters);
}

struct Summary {
  std::vector<double> lengths;
  double z2 = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();

  void add(const TrackSample& sample) {
    lengths.push_back(sample.error.norm());
    z2 += sample.error.squaredNorm() / (2.0 * sample.sigma * sample.sigma);
    sum += sample.error;
  }
  double count() const { return static_cast<double>(lengths.size()); }
  double zRms() const { return std::sqrt(z2 / count()); }
  double share(double limit) const {
    double n = 0;
    for (const double e : lengths) n += e > limit;
    return n / count();
  }
};

double percentile(std::vector<double> v, double p) {
  if (v.empty()) return 0;
  std::sort(v.begin(), v.end());
  return v[static_cast<std::size_t>(p * (v.size() - 1))];
}

void printByAge(const std::vector<TrackSample>& samples) {
  std::map<int, Summary> by_age;
  std::vector<double> sig;
  for (const TrackSample& s : samples) {
    if (!s.hidden) by_age[s.age / 5 * 5].add(s);
    sig.push_back(s.sigma);
  }
  for (auto& [age, summary] : by_age) {
    std::printf(
        "age %3d n %5.0f median %.4f p90 %.4f p99 %.4f max %.2f mean (%+.4f %+.4f) z %.2f >1px "
        "%.4f\n",
        age, summary.count(), median(summary.lengths), percentile(summary.lengths, .9),
        percentile(summary.lengths, .99), percentile(summary.lengths, 1),
        summary.sum.x() / summary.count(), summary.sum.y() / summary.count(), summary.zRms(),
        summary.share(1));
  }
  std::printf("median sigma %.4f hidden %d\n", median(sig),
              (int)std::count_if(samples.begin(), samples.end(), [](auto& s) { return s.hidden; }));
}

TEST(TrackerAccuracy, Pinhole) {
  const TexturedBox box(7);
  const BoxRenderer renderer(box, pinhole(), 3);
  SequenceOptions options;
  options.images = 45;
  options.world_from_camera = [](int i) {
    return handHeldPose(i, {0.35, 0.3, 0.4}, {0.25, 0.3, 0.25}, 60.0);
  };
  printByAge(trackSequence(renderer, options));
}

TEST(TrackerAccuracy, Wide) {
  const TexturedBox box(8);
  const BoxRenderer renderer(box, wideLens(), 3);
  SequenceOptions options;
  options.images = 80;
  options.world_from_camera = [](int i) {
    return handHeldPose(i, {0.3, 0.3, 0.3}, {0.6, 0.9, 0.4}, 80.0);
  };
  const auto samples = trackSequence(renderer, options);
  printByAge(samples);
  struct Bin {
    double n = 0, radial = 0, motion = 0, fromref = 0, r2 = 0;
    std::vector<double> len;
  };
  std::map<int, Bin> bins;
  const Eigen::Vector2d centre(319.5, 239.5);
  for (const TrackSample& s : samples) {
    if (s.hidden || s.error.norm() > 1) continue;
    const double r = (s.truth - centre).norm(), r0 = (s.reference - centre).norm();
    if (std::abs(r - r0) < 100) continue;
    Bin& b = bins[(int)r / 50 * 50 + (r > r0 ? 1000 : 0)];
    const double radial = s.error.dot((s.truth - centre) / r);
    b.n += 1;
    b.radial += radial;
    b.r2 += radial * radial;
    b.motion += s.error.dot((s.truth - s.last_truth).normalized());
    b.fromref += s.error.dot((s.truth - s.reference).normalized());
    b.len.push_back(s.error.norm());
  }
  for (auto& [r, b] : bins)
    std::printf("%s r %3d n %5.0f radial %+.4f +- %.4f motion %+.4f from ref %+.4f med %.4f\n",
                r >= 1000 ? "out" : "in ", r % 1000, b.n, b.radial / b.n, std::sqrt(b.r2) / b.n,
                b.motion / b.n, b.fromref / b.n, median(b.len));
}

}  // namespace
}  // namespace camera_self_calibration
