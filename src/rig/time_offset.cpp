#include "camera_self_calibration/rig/time_offset.h"

#include <Eigen/Dense>
#include <cmath>
#include <optional>

#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/geometry/so3.h"
#include "robust_weights.h"

namespace camera_self_calibration {
namespace {

constexpr double kHarmful = 1e-3;  // [s]
constexpr std::size_t kMinRates = 30;
// Rates over two images overlap, and accelerations are differences of those: so many residuals in
// a row share their errors.
constexpr double kCorrelated = 4.0;
// Sigma along an axis over what reweight() makes of the median norm in three dimensions, which is
// 1.54 sigmas.
constexpr double kPerAxis = 1.0 / (1.48 * 1.54);

// Rates of both cameras in the middle of three images [rad/s].
struct Rates {
  double time_s = 0.0;
  Eigen::Vector3d rig;
  Eigen::Vector3d camera;
};

struct Sample {
  Rates rates;
  Eigen::Vector3d acceleration;  // of the camera [rad/s^2]
};

double secondsBetween(const RotationPair& a, const RotationPair& b) {
  return toSeconds(b.stamp_ns - a.stamp_ns);
}

// Nothing where images are missing between the two, or a map begins.
std::optional<Rates> ratesBetween(const RotationPair& a, const RotationPair& b, double usual_s) {
  const double seconds = secondsBetween(a, b);
  if (a.rig_map != b.rig_map || a.camera_map != b.camera_map || !(seconds < 1.5 * usual_s)) {
    return std::nullopt;
  }
  return Rates{toSeconds(a.stamp_ns) + 0.5 * seconds,
               logSo3(a.world_from_rig.conjugate() * b.world_from_rig) / seconds,
               logSo3(a.world_from_camera.conjugate() * b.world_from_camera) / seconds};
}

std::vector<Sample> samplesOf(const std::vector<RotationPair>& rotations) {
  std::vector<Sample> samples;
  if (rotations.size() < 5) return samples;
  const double usual_s = 2.0 * secondsBetween(rotations.front(), rotations.back()) /
                         static_cast<double>(rotations.size() - 1);
  for (std::size_t i = 2; i + 2 < rotations.size(); ++i) {
    const auto before = ratesBetween(rotations[i - 2], rotations[i], usual_s);
    const auto now = ratesBetween(rotations[i - 1], rotations[i + 1], usual_s);
    const auto after = ratesBetween(rotations[i], rotations[i + 2], usual_s);
    if (!before || !now || !after) continue;
    samples.push_back({*now, (after->camera - before->camera) / (after->time_s - before->time_s)});
  }
  return samples;
}

}  // namespace

bool TimeOffset::harms() const {
  return std::abs(seconds) > kHarmful && std::abs(seconds) > 3.0 * sigma;
}

TimeOffset timeOffset(const std::vector<RotationPair>& rotations) {
  TimeOffset result;
  const std::vector<Sample> samples = samplesOf(rotations);
  if (samples.size() < kMinRates) return result;
  Eigen::Matrix3d r = Eigen::Matrix3d::Identity();
  std::vector<double> weights(samples.size(), 1.0);
  std::vector<double> residuals(samples.size());
  for (int round = 0; round < kReweightingRounds; ++round) {
    // The rotation for this offset, then the offset for this rotation: they hardly depend on each
    // other.
    Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
    const auto shifted = [&](const Sample& sample) {
      return Eigen::Vector3d(sample.rates.camera - result.seconds * sample.acceleration);
    };
    for (std::size_t i = 0; i < samples.size(); ++i) {
      correlation += weights[i] * samples[i].rates.rig * shifted(samples[i]).transpose();
    }
    r = nearestRotation(correlation);
    double product = 0.0;
    double square = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Eigen::Vector3d without =
          r.transpose() * samples[i].rates.rig - samples[i].rates.camera;
      product -= weights[i] * samples[i].acceleration.dot(without);
      square += weights[i] * samples[i].acceleration.squaredNorm();
    }
    if (!(square > 0.0)) return {};
    result.seconds = product / square;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      residuals[i] = (samples[i].rates.rig - r * shifted(samples[i])).norm();
    }
    const double sigma = reweight(residuals, &weights);
    result.sigma = kPerAxis * sigma * std::sqrt(kCorrelated / square);
  }
  return result;
}

}  // namespace camera_self_calibration
