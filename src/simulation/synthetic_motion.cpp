#include "camera_self_calibration/simulation/synthetic_motion.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

using Eigen::Vector3d;

constexpr std::array<const char*, 7> kNames = {
    "handheld", "planar", "yaw_driving", "rotation_only", "forward_only", "sideways_only", "still"};

// A sum of sinusoids of random phase whose value stays in [-1, 1].
class Wave {
 public:
  // `frequency` [Hz] of the slowest and largest of the three parts.
  Wave(double frequency, Random* random) {
    const double ratio[] = {1.0, 2.3, 4.7};
    const double amplitude[] = {0.68, 0.23, 0.09};
    for (int i = 0; i < 3; ++i) {
      amplitude_[i] = amplitude[i];
      omega_[i] = 2.0 * M_PI * frequency * ratio[i] * random->uniform(0.85, 1.15);
      phase_[i] = random->uniform(0.0, 2.0 * M_PI);
    }
  }
  double operator()(double time) const {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) sum += amplitude_[i] * std::sin(omega_[i] * time + phase_[i]);
    return sum;
  }

 private:
  std::array<double, 3> amplitude_, omega_, phase_;
};

// Camera (x right, y down, z forward) that looks along `yaw` in the horizontal plane, raised by
// `pitch` and turned about its optical axis by `roll` [rad].
Eigen::Quaterniond orientation(double yaw, double pitch, double roll) {
  Eigen::Matrix3d world_from_level;  // looks along x
  world_from_level << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  return (Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Eigen::Quaterniond(world_from_level) *
          Eigen::AngleAxisd(pitch, Vector3d::UnitX()) * Eigen::AngleAxisd(roll, Vector3d::UnitZ()))
      .normalized();
}

Vector3d inside(const Eigen::AlignedBox3d& box, double x, double y, double z) {
  return box.center() + 0.5 * box.sizes().cwiseProduct(Vector3d(x, y, z));
}

// Sinusoids for position and for the three angles, their sizes by the kind of motion.
Trajectory waves(const SyntheticMotionOptions& o, bool moves, bool upright) {
  Random random(mixSeed(o.seed, 17));
  const double f = o.speed;
  const Wave x(0.065 * f, &random), y(0.08 * f, &random), z(0.11 * f, &random);
  const Wave yaw(0.06 * f, &random), pitch(0.13 * f, &random), roll(0.11 * f, &random);
  const double heading = random.uniform(0.0, 2.0 * M_PI);
  const double tilt = upright ? 0.0 : 1.0;
  const auto pose = [=](double t) {
    const Vector3d position =
        moves ? inside(o.box, x(t), y(t), upright ? 0.0 : z(t)) : Vector3d(o.box.center());
    return Rigid3(
        orientation(heading + 2.4 * yaw(t), tilt * (0.55 * pitch(t) - 0.2), tilt * 0.75 * roll(t)),
        position);
  };
  return Trajectory(pose, o.duration_s);
}

// Round the middle of the box, nearer and farther, in one direction.
Trajectory driving(const SyntheticMotionOptions& o) {
  Random random(mixSeed(o.seed, 18));
  const double rate = 2.0 * M_PI * 0.07 * o.speed;
  const double phase = random.uniform(0.0, 2.0 * M_PI);
  const double wobble_phase = random.uniform(0.0, 2.0 * M_PI);
  const Eigen::AlignedBox3d box = o.box;
  const auto pose = [=](double t) {
    const double angle = rate * t + phase;
    const double wobble = 0.37 * angle + wobble_phase;
    const double radius = 0.82 + 0.18 * std::sin(wobble);
    const double radius_slope = 0.18 * 0.37 * std::cos(wobble);
    const Vector3d position = inside(box, radius * std::cos(angle), radius * std::sin(angle), 0.0);
    const double dx = radius_slope * std::cos(angle) - radius * std::sin(angle);
    const double dy = radius_slope * std::sin(angle) + radius * std::cos(angle);
    const double heading = std::atan2(box.sizes().y() * dy, box.sizes().x() * dx);
    return Rigid3(orientation(heading, 0.0, 0.0), position);
  };
  return Trajectory(pose, o.duration_s);
}

// Along one axis of the camera, which looks along the world's x.
Trajectory straight(const SyntheticMotionOptions& o, bool sideways) {
  Random random(mixSeed(o.seed, 19));
  const Eigen::AlignedBox3d box = o.box;
  const double rate = 2.0 * M_PI * 0.06 * o.speed;
  const double phase = random.uniform(-0.3, 0.3);
  const double across = random.uniform(-0.5, 0.5);
  const double height = random.uniform(-0.5, 0.5);
  const auto pose = [=](double t) {
    const double along = -std::cos(rate * t + phase);
    return Rigid3(orientation(0.0, 0.0, 0.0), sideways ? inside(box, across, along, height)
                                                       : inside(box, along, across, height));
  };
  return Trajectory(pose, o.duration_s);
}

}  // namespace

std::string toString(MotionKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

std::optional<MotionKind> motionKindFromString(const std::string& name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<MotionKind>(i);
  }
  return std::nullopt;
}

std::vector<std::string> SyntheticMotionOptions::problems() const {
  std::vector<std::string> found;
  if (!(duration_s > 0.0)) found.push_back("the duration of a motion must be positive [s]");
  if (!(speed > 0.0 && speed <= 20.0)) found.push_back("the speed of a motion must be in (0, 20]");
  if (box.isEmpty()) found.push_back("the box of a motion must not be empty");
  return found;
}

Trajectory syntheticMotion(const SyntheticMotionOptions& options) {
  const std::vector<std::string> problems = options.problems();
  if (!problems.empty()) throw std::invalid_argument(problems.front());
  switch (options.kind) {
    case MotionKind::kPlanar:
      return waves(options, true, true);
    case MotionKind::kYawDriving:
      return driving(options);
    case MotionKind::kRotationOnly:
      return waves(options, false, false);
    case MotionKind::kForwardOnly:
      return straight(options, false);
    case MotionKind::kSidewaysOnly:
      return straight(options, true);
    case MotionKind::kStill: {
      const Rigid3 pose = waves(options, true, false).worldFromCamera(0.0);
      return Trajectory([pose](double) { return pose; }, options.duration_s);
    }
    case MotionKind::kHandheld:
      break;
  }
  return waves(options, true, false);
}

}  // namespace camera_self_calibration
