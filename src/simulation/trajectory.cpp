#include "camera_self_calibration/simulation/trajectory.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>

#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

struct Knot {
  double time = 0.0;
  Rigid3 pose;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          // in the world [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // in the body [rad/s]
};

Eigen::Vector3d rotationStep(const Knot& from, const Knot& to) {
  return logSo3(from.pose.rotation.conjugate() * to.pose.rotation);
}

// d rotation vector / d body angle at the end of a rotation by `v`: inverse right Jacobian of
// SO(3).
Eigen::Matrix3d inverseRightJacobian(const Eigen::Vector3d& v) {
  const double angle = v.norm();
  double c = 1.0 / 12.0;
  if (angle > 1e-3) c = 1.0 / (angle * angle) - 0.5 / (angle * std::tan(0.5 * angle));
  const Eigen::Matrix3d cross = skew(v);
  return Eigen::Matrix3d::Identity() + 0.5 * cross + c * cross * cross;
}

// Slope at the middle of three points of uneven distance in time (Catmull-Rom).
Eigen::Vector3d slope(const Eigen::Vector3d& step0, double dt0, const Eigen::Vector3d& step1,
                      double dt1) {
  return (step0 * (dt1 / dt0) + step1 * (dt0 / dt1)) / (dt0 + dt1);
}

void setVelocities(std::vector<Knot>* knots) {
  const std::size_t last = knots->size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    Knot& here = (*knots)[i];
    const Knot& before = (*knots)[i == 0 ? 0 : i - 1];
    const Knot& after = (*knots)[i == last ? last : i + 1];
    if (i == 0 || i == last) {
      const double dt = after.time - before.time;
      here.velocity = (after.pose.translation - before.pose.translation) / dt;
      here.angular_velocity = rotationStep(before, after) / dt;
      continue;
    }
    const double dt0 = here.time - before.time;
    const double dt1 = after.time - here.time;
    here.velocity = slope(here.pose.translation - before.pose.translation, dt0,
                          after.pose.translation - here.pose.translation, dt1);
    here.angular_velocity = slope(rotationStep(before, here), dt0, rotationStep(here, after), dt1);
  }
}

// Cubic on [0, 1] with the given values and slopes at the ends.
Eigen::Vector3d hermite(double s, const Eigen::Vector3d& p0, const Eigen::Vector3d& m0,
                        const Eigen::Vector3d& p1, const Eigen::Vector3d& m1) {
  const double s2 = s * s;
  const double s3 = s2 * s;
  return (2.0 * s3 - 3.0 * s2 + 1.0) * p0 + (s3 - 2.0 * s2 + s) * m0 + (3.0 * s2 - 2.0 * s3) * p1 +
         (s3 - s2) * m1;
}

Rigid3 between(const Knot& a, const Knot& b, double time) {
  const double dt = b.time - a.time;
  const double s = (time - a.time) / dt;
  const Eigen::Vector3d step = rotationStep(a, b);
  const Eigen::Vector3d rotation =
      hermite(s, Eigen::Vector3d::Zero(), dt * a.angular_velocity, step,
              dt * (inverseRightJacobian(step) * b.angular_velocity));
  return {(a.pose.rotation * expSo3(rotation)).normalized(),
          hermite(s, a.pose.translation, dt * a.velocity, b.pose.translation, dt * b.velocity)};
}

}  // namespace

Rigid3 Trajectory::worldFromCamera(double time_s) const {
  return pose_(std::clamp(time_s, 0.0, duration_s_));
}

Vector6d Trajectory::velocity(double time_s) const {
  const double h = std::min(1e-3, 0.25 * duration_s_);
  const double middle = std::clamp(time_s, h, duration_s_ - h);
  return logSe3(worldFromCamera(middle - h).inverse() * worldFromCamera(middle + h)) / (2.0 * h);
}

Trajectory interpolate(const std::vector<StampedPose>& poses) {
  if (poses.size() < 2) throw std::invalid_argument("a trajectory needs at least two poses");
  auto knots = std::make_shared<std::vector<Knot>>();
  for (const StampedPose& pose : poses) {
    Knot knot;
    knot.time = pose.time_s - poses.front().time_s;
    knot.pose = pose.world_from_body;
    if (!knots->empty() && !(knot.time > knots->back().time)) {
      throw std::invalid_argument("the times of a trajectory must increase; pose number " +
                                  std::to_string(knots->size() + 1) + " does not");
    }
    knots->push_back(knot);
  }
  setVelocities(knots.get());
  const auto pose_at = [knots](double time) {
    const auto after = std::upper_bound(knots->begin() + 1, knots->end() - 1, time,
                                        [](double t, const Knot& knot) { return t < knot.time; });
    return between(*(after - 1), *after, time);
  };
  return Trajectory(pose_at, knots->back().time);
}

}  // namespace camera_self_calibration
