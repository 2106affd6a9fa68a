#include "rig_residual.h"

#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/reference/rotation_derivative.h"

namespace camera_self_calibration {
namespace {

template <int kColumns>
using Rows2 = Eigen::Matrix<double, 2, kColumns, Eigen::RowMajor>;

// With q = (u, w) as x y z w, `a (x) b = left(a) b = right(b) a`.
Eigen::Matrix4d product(const Eigen::Quaterniond& q, double sign) {
  Eigen::Matrix4d m = q.w() * Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() += sign * skew(q.vec());
  m.topRightCorner<3, 1>() = q.vec();
  m.bottomLeftCorner<1, 3>() = -q.vec().transpose();
  return m;
}

Eigen::Matrix4d left(const Eigen::Quaterniond& q) { return product(q, 1.0); }
Eigen::Matrix4d right(const Eigen::Quaterniond& q) { return product(q, -1.0); }

Rigid3 poseAt(double const* const* parameters, int number) {
  if (number == RigResidual::Roles::kNone) return {};
  return {Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(parameters[2 * number])),
          Eigen::Map<const Eigen::Vector3d>(parameters[2 * number + 1])};
}

template <int kColumns>
void add(const Rows2<kColumns>& d, double* block) {
  if (block) Eigen::Map<Rows2<kColumns>>(block) += d;
}

// From derivatives by a camera's pose to those by the two that make it up: q = q_w (x) q_c,
// t = t_w + R(q_w) t_c.
void addPoses(const Rows2<4>& by_rotation, const Rows2<3>& by_position, const Rigid3& rig, int w,
              const Rigid3& camera, int c, double** jacobians) {
  if (w >= 0) {
    add<4>(by_rotation * right(camera.rotation) +
               by_position * rotationDerivative(rig.rotation, camera.translation),
           jacobians[2 * w]);
    add<3>(by_position, jacobians[2 * w + 1]);
  }
  if (c >= 0) {
    add<4>(by_rotation * left(rig.rotation), jacobians[2 * c]);
    add<3>(by_position * rig.rotation.toRotationMatrix(), jacobians[2 * c + 1]);
  }
}

}  // namespace

RigResidual::RigResidual(const Camera& camera, const Roles& roles,
                         const Eigen::Vector3d& base_bearing, const Eigen::Vector2d& pixel,
                         double sigma)
    : inner_(camera, pixel, sigma),
      roles_(roles),
      base_(base_bearing),
      tangent_(tangentBasis(base_bearing)) {
  set_num_residuals(2);
  for (int i = 0; i < roles.count; ++i) {
    mutable_parameter_block_sizes()->push_back(4);
    mutable_parameter_block_sizes()->push_back(3);
  }
  mutable_parameter_block_sizes()->push_back(3);
  mutable_parameter_block_sizes()->push_back(camera.parameterCount());
}

bool RigResidual::Evaluate(double const* const* parameters, double* residual,
                           double** jacobians) const {
  const Rigid3 rig_i = poseAt(parameters, roles_.observing_rig);
  const Rigid3 camera_i = poseAt(parameters, roles_.observing_camera);
  const Rigid3 rig_r = poseAt(parameters, roles_.reference_rig);
  const Rigid3 camera_r = poseAt(parameters, roles_.reference_camera);
  // Without the product's normalisation, whose derivative is another one.
  const Eigen::Quaterniond q_i = rig_i.rotation * camera_i.rotation;
  const Eigen::Quaterniond q_r = rig_r.rotation * camera_r.rotation;
  const Eigen::Vector3d t_i = rig_i * camera_i.translation;
  const Eigen::Vector3d t_r = rig_r * camera_r.translation;
  const double* landmark = parameters[2 * roles_.count];
  const Eigen::Vector3d along = base_ + tangent_ * Eigen::Map<const Eigen::Vector2d>(landmark);
  const double length = along.norm();
  const Eigen::Vector3d bearing = along / length;
  const double* blocks[] = {q_i.coeffs().data(),
                            t_i.data(),
                            q_r.coeffs().data(),
                            t_r.data(),
                            landmark + 2,
                            bearing.data(),
                            parameters[2 * roles_.count + 1]};
  if (!jacobians) return inner_.Evaluate(blocks, residual, nullptr);

  Rows2<4> by_q_i, by_q_r;
  Rows2<3> by_t_i, by_t_r, by_bearing;
  Eigen::Vector2d by_depth = Eigen::Vector2d::Zero();
  double* inner_jacobians[] = {by_q_i.data(),
                               by_t_i.data(),
                               by_q_r.data(),
                               by_t_r.data(),
                               by_depth.data(),
                               by_bearing.data(),
                               jacobians[2 * roles_.count + 1]};
  if (!inner_.Evaluate(blocks, residual, inner_jacobians)) return false;
  for (int b = 0; b < 2 * roles_.count; ++b) {
    if (jacobians[b]) Eigen::Map<Eigen::VectorXd>(jacobians[b], b % 2 == 0 ? 8 : 6).setZero();
  }
  addPoses(by_q_i, by_t_i, rig_i, roles_.observing_rig, camera_i, roles_.observing_camera,
           jacobians);
  addPoses(by_q_r, by_t_r, rig_r, roles_.reference_rig, camera_r, roles_.reference_camera,
           jacobians);
  if (double* block = jacobians[2 * roles_.count]) {
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - bearing * bearing.transpose();
    Eigen::Map<Rows2<3>> by_landmark(block);
    by_landmark.leftCols<2>() = by_bearing * (across / length) * tangent_;
    by_landmark.col(2) = by_depth;
  }
  return true;
}

}  // namespace camera_self_calibration
