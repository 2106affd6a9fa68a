#include "camera_self_calibration/reference/residuals.h"

#include <Eigen/Geometry>

#include "camera_self_calibration/reference/rotation_derivative.h"

namespace camera_self_calibration {
namespace {

using Vector3Map = Eigen::Map<const Eigen::Vector3d>;
using QuaternionMap = Eigen::Map<const Eigen::Quaterniond>;

// Stores a derivative of the residual in Ceres' layout; null blocks are not wanted.
template <typename Derived>
void write(const Eigen::MatrixBase<Derived>& d, double* block) {
  if (!block) return;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < d.cols(); ++column) *block++ = d(row, column);
  }
}

// d (R(q)^T v) / d q: the conjugate has the vector part -u.
Matrix34d inverseRotationDerivative(const Eigen::Quaterniond& q, const Eigen::Vector3d& v) {
  Matrix34d d = rotationDerivative(q.conjugate(), v);
  d.leftCols<3>() *= -1.0;
  return d;
}

// The point of the landmark in the observing camera and the derivative of the residual by it.
struct Transfer {
  QuaternionMap q_i;
  Vector3Map t_i;
  QuaternionMap q_r;
  Vector3Map t_r;
  double rho;
  Eigen::Vector3d d;

  Transfer(double const* const* parameters, const Eigen::Vector3d& bearing)
      : q_i(parameters[0]),
        t_i(parameters[1]),
        q_r(parameters[2]),
        t_r(parameters[3]),
        rho(parameters[4][0]),
        d(bearing) {}

  Eigen::Matrix3d fromWorld() const { return q_i.toRotationMatrix().transpose(); }
  Eigen::Vector3d inWorld() const { return q_r.toRotationMatrix() * d + rho * (t_r - t_i); }

  // Eq. (1), up to scale: x = R_i^T (R_r d + rho (t_r - t_i)).
  Eigen::Vector3d point() const { return fromWorld() * inWorld(); }

  // Derivatives by q_i, t_i, q_r, t_r and rho, the first five blocks.
  void writeJacobians(const Matrix23d& r_x, double** jacobians) const {
    const Matrix23d r_world = r_x * fromWorld();
    write((r_x * inverseRotationDerivative(q_i, inWorld())).eval(), jacobians[0]);
    write(-rho * r_world, jacobians[1]);
    write((r_world * rotationDerivative(q_r, d)).eval(), jacobians[2]);
    write(rho * r_world, jacobians[3]);
    write((r_world * (t_r - t_i)).eval(), jacobians[4]);
  }

  Matrix23d byBearing(const Matrix23d& r_x) const {
    return r_x * fromWorld() * q_r.toRotationMatrix();
  }
};

// A copy of `camera` with the intrinsics of a parameter block.
Camera withParameters(const Camera& camera, const double* intrinsics) {
  Camera moved = camera;
  moved.setParameters(Eigen::Map<const Eigen::VectorXd>(intrinsics, camera.parameterCount()));
  return moved;
}

// The contribution of a point that cannot be projected.
bool writeZeros(const ceres::CostFunction& cost, double* residual, double** jacobians) {
  residual[0] = residual[1] = 0.0;
  if (!jacobians) return true;
  const auto& sizes = cost.parameter_block_sizes();
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (jacobians[i]) Eigen::Map<Eigen::VectorXd>(jacobians[i], 2 * sizes[i]).setZero();
  }
  return true;
}

}  // namespace

AnchoredResidual::AnchoredResidual(const Camera& camera, const Eigen::Vector2d& reference_pixel,
                                   const Eigen::Vector2d& pixel, double sigma)
    : camera_(camera), reference_pixel_(reference_pixel), pixel_(pixel), sigma_(sigma) {
  set_num_residuals(2);
  *mutable_parameter_block_sizes() = {4, 3, 4, 3, 1, camera.parameterCount()};
}

bool AnchoredResidual::Evaluate(double const* const* parameters, double* residual,
                                double** jacobians) const {
  const Camera camera = withParameters(camera_, parameters[5]);
  if (!camera.valid()) return false;
  Eigen::Vector3d ray;
  RayIntrinsicsJacobian ray_c;
  if (!camera.unproject(reference_pixel_, &ray, &ray_c)) {
    return writeZeros(*this, residual, jacobians);
  }
  const Transfer transfer(parameters, ray);
  Eigen::Vector2d projected;
  Matrix23d p_x;
  PixelIntrinsicsJacobian p_c;
  if (!camera.project(transfer.point(), &projected, &p_x, &p_c)) {
    return writeZeros(*this, residual, jacobians);
  }
  // Eq. (2)
  Eigen::Map<Eigen::Vector2d>(residual, 2) = (pixel_ - projected) / sigma_;
  if (!jacobians) return true;
  const Matrix23d r_x = -p_x / sigma_;
  transfer.writeJacobians(r_x, jacobians);
  // The intrinsics enter twice: through the projection and through the reference ray.
  write((-p_c / sigma_ + transfer.byBearing(r_x) * ray_c).eval(), jacobians[5]);
  return true;
}

InheritedResidual::InheritedResidual(const Camera& camera, const Eigen::Vector2d& pixel,
                                     double sigma)
    : camera_(camera), pixel_(pixel), sigma_(sigma) {
  set_num_residuals(2);
  *mutable_parameter_block_sizes() = {4, 3, 4, 3, 1, 3, camera.parameterCount()};
}

bool InheritedResidual::Evaluate(double const* const* parameters, double* residual,
                                 double** jacobians) const {
  const Camera camera = withParameters(camera_, parameters[6]);
  if (!camera.valid()) return false;
  const Transfer transfer(parameters, Vector3Map(parameters[5]));
  Eigen::Vector2d projected;
  Matrix23d p_x;
  PixelIntrinsicsJacobian p_c;
  if (!camera.project(transfer.point(), &projected, &p_x, &p_c)) {
    return writeZeros(*this, residual, jacobians);
  }
  // Eq. (2)
  Eigen::Map<Eigen::Vector2d>(residual, 2) = (pixel_ - projected) / sigma_;
  if (!jacobians) return true;
  const Matrix23d r_x = -p_x / sigma_;
  transfer.writeJacobians(r_x, jacobians);
  write(transfer.byBearing(r_x), jacobians[5]);
  write(-p_c / sigma_, jacobians[6]);
  return true;
}

FirstObservationResidual::FirstObservationResidual(const Camera& camera,
                                                   const Eigen::Vector2d& pixel, double sigma)
    : camera_(camera), pixel_(pixel), sigma_(sigma) {
  set_num_residuals(2);
  *mutable_parameter_block_sizes() = {3, camera.parameterCount()};
}

bool FirstObservationResidual::Evaluate(double const* const* parameters, double* residual,
                                        double** jacobians) const {
  const Camera camera = withParameters(camera_, parameters[1]);
  if (!camera.valid()) return false;
  Eigen::Vector2d projected;
  Matrix23d p_x;
  PixelIntrinsicsJacobian p_c;
  if (!camera.project(Vector3Map(parameters[0]), &projected, &p_x, &p_c)) {
    return writeZeros(*this, residual, jacobians);
  }
  Eigen::Map<Eigen::Vector2d>(residual, 2) = (pixel_ - projected) / sigma_;
  if (!jacobians) return true;
  write(-p_x / sigma_, jacobians[0]);
  write(-p_c / sigma_, jacobians[1]);
  return true;
}

}  // namespace camera_self_calibration
