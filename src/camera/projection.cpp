// Camera::project: the innermost call of every estimator.

#include <cmath>

#include "camera_self_calibration/camera/camera.h"

namespace camera_self_calibration {
namespace {

// Angle to the axis divided by the radius, a(R, z) = atan2(R, z) / R, and its derivatives.
struct AngleRatio {
  double value;
  double slope;          // (da/dR) / R
  double inverse_norm2;  // 1 / (R^2 + z^2) = -da/dz
};

// atan2(y, x) for y >= 0, x > 0, to rounding. The library's spends most of its time on cases that
// do not occur here. Turned back by the nearest multiple of pi/8, what is left has a tangent of at
// most tan(pi/16); there atan(t) = t (1 + t^2 p(t^2)), with p the polynomial of smallest error
// (3e-19, by Chebyshev's method).
inline double angleInQuadrant(double y, double x) {
  constexpr double kBorder[4] = {0.19891236737965801, 0.66817863791929888, 1.4966057626654889,
                                 5.0273394921258463};
  constexpr double kCosine[5] = {1, 0.92387953251128674, 0.70710678118654757, 0.38268343236508984,
                                 0.0};
  constexpr double kSine[5] = {0.0, 0.38268343236508978, 0.70710678118654746, 0.92387953251128674,
                               1.0};
  constexpr double kAngle[5] = {0.0, 0.39269908169872414, 0.78539816339744828, 1.1780972450961724,
                                1.5707963267948966};
  const int k =
      (y > kBorder[0] * x) + (y > kBorder[1] * x) + (y > kBorder[2] * x) + (y > kBorder[3] * x);
  const double t = (kCosine[k] * y - kSine[k] * x) / (kCosine[k] * x + kSine[k] * y);
  const double s = t * t;
  // In pairs, so that the processor need not wait for one product after the other.
  const double s2 = s * s;
  const double low = (-0.333333333333333325 + 0.199999999999972875 * s) +
                     s2 * (-0.142857142842727075 + 0.111111108188559309 * s);
  const double high = (-0.0909087994065675021 + 0.0769072401685326053 * s) +
                      s2 * (-0.0661872342171513241 + 0.0511567552325832353 * s);
  const double p = low + s2 * s2 * high;
  return kAngle[k] + (t + t * s * p);
}

// By series in (R/z)^2 near the axis, where the closed forms cancel or divide 0 by 0. Truncation
// and cancellation are both below 1e-12 at the branch.
inline AngleRatio angleRatio(double radius2, double z, bool derivatives) {
  AngleRatio ratio;
  if (z > 0.0 && radius2 < 2.5e-3 * z * z) {
    const double inverse_z = 1.0 / z;
    const double t = -radius2 * inverse_z * inverse_z;
    ratio.value =
        inverse_z *
        (1.0 + t * (1.0 / 3 + t * (1.0 / 5 + t * (1.0 / 7 + t * (1.0 / 9 + t * (1.0 / 11))))));
    if (!derivatives) return ratio;
    const double slope =
        2.0 / 3 + t * (4.0 / 5 + t * (6.0 / 7 + t * (8.0 / 9 + t * (10.0 / 11 + t * 12.0 / 13))));
    ratio.slope = -slope * inverse_z * inverse_z * inverse_z;
    ratio.inverse_norm2 = 1.0 / (radius2 + z * z);
    return ratio;
  }
  const double radius = std::sqrt(radius2);
  const double inverse_radius = 1.0 / radius;
  ratio.value = (z > 0.0 ? angleInQuadrant(radius, z) : std::atan2(radius, z)) * inverse_radius;
  if (!derivatives) return ratio;
  ratio.inverse_norm2 = 1.0 / (radius2 + z * z);
  ratio.slope = (z * ratio.inverse_norm2 - ratio.value) * inverse_radius * inverse_radius;
  return ratio;
}

inline bool isFinite(const Eigen::Vector2d& v) {
  return std::isfinite(v.x()) && std::isfinite(v.y());
}

// Columns fx, fy, cx, cy of d pixel / d parameters; the other columns stay to be written.
inline void writeLinearColumns(double u, double v, int count, PixelIntrinsicsJacobian* d) {
  d->resize(2, count);
  d->leftCols<4>() << u, 0.0, 1.0, 0.0, 0.0, v, 0.0, 1.0;
}

}  // namespace

// Models that are symmetric about the axis: pixel = f s(r, z) (x, y) + c, r^2 = x^2 + y^2.
struct Camera::AxialScale {
  double s;
  double s_r_by_r;  // (ds/dr) / r
  double s_z;       // ds/dz
  double s_k[4];    // ds / d distortion parameters
};

// s = atan2(k r, z) / (w r), k = 2 tan(w/2): finite as z -> 0+, as r -> 0 and as w -> 0.
void Camera::fovScale(double r2, double z, bool derivatives, AxialScale* scale) const {
  const double k2 = fov_k_ * fov_k_;
  const AngleRatio ratio = angleRatio(k2 * r2, z, derivatives);
  scale->s = fov_k_by_w_ * ratio.value;
  if (!derivatives) return;
  scale->s_r_by_r = fov_k_by_w_ * k2 * ratio.slope;
  scale->s_z = -fov_k_by_w_ * ratio.inverse_norm2;
  // ds/dw = (dk/dw - k/w)/w z/(k^2 r^2 + z^2) + k/w^2 (z/(k^2 r^2 + z^2) - ratio); the last
  // bracket is k^2 r^2 slope, which does not cancel.
  scale->s_k[0] = fov_dk_by_w_ * z * ratio.inverse_norm2 +
                  fov_k_by_w_ * fov_k_by_w_ * fov_k_ * r2 * ratio.slope;
}

// s = theta (1 + k1 theta^2 + ... + k4 theta^8) / r, theta = atan2(r, z).
bool Camera::equidistantScale(double r2, double z, bool derivatives, AxialScale* scale) const {
  const AngleRatio ratio = angleRatio(r2, z, derivatives);
  const double t = ratio.value * ratio.value * r2;  // theta^2
  if (!(t < max_radius2_)) return false;
  const double* k = parameters_.data() + 4;
  const double gain = 1.0 + t * (k[0] + t * (k[1] + t * (k[2] + t * k[3])));
  scale->s = ratio.value * gain;
  if (!derivatives) return true;
  // (d gain / d theta) / theta
  const double gain_slope = 2.0 * k[0] + t * (4.0 * k[1] + t * (6.0 * k[2] + t * 8.0 * k[3]));
  scale->s_r_by_r =
      ratio.slope * gain + ratio.value * ratio.value * gain_slope * z * ratio.inverse_norm2;
  scale->s_z = -(gain + t * gain_slope) * ratio.inverse_norm2;
  scale->s_k[0] = ratio.value * t;
  for (int i = 1; i < 4; ++i) scale->s_k[i] = scale->s_k[i - 1] * t;
  return true;
}

bool Camera::axialScale(const Eigen::Vector3d& point, bool derivatives, AxialScale* scale) const {
  const double r2 = point.x() * point.x() + point.y() * point.y();
  const double z = point.z();
  if (model_ == CameraModel::kEquidistant) return equidistantScale(r2, z, derivatives, scale);
  if (!(z > 0.0)) return false;
  if (model_ == CameraModel::kFov) {
    fovScale(r2, z, derivatives, scale);
    return true;
  }
  scale->s = 1.0 / z;
  scale->s_r_by_r = 0.0;
  scale->s_z = -scale->s * scale->s;
  return true;
}

bool Camera::project(const Eigen::Vector3d& point, Eigen::Vector2d* pixel, Matrix23d* d_point,
                     PixelIntrinsicsJacobian* d_parameters) const {
  if (!valid_) return false;
  if (model_ == CameraModel::kRadtan) return projectRadtan(point, pixel, d_point, d_parameters);
  AxialScale scale;
  if (!axialScale(point, d_point || d_parameters, &scale)) return false;
  const double x = point.x();
  const double y = point.y();
  const double fx = parameters_[0];
  const double fy = parameters_[1];
  *pixel << fx * scale.s * x + parameters_[2], fy * scale.s * y + parameters_[3];
  if (d_point) {
    const double q = scale.s_r_by_r;
    *d_point << fx * (scale.s + x * x * q), fx * x * y * q, fx * x * scale.s_z,  //
        fy * x * y * q, fy * (scale.s + y * y * q), fy * y * scale.s_z;
  }
  if (d_parameters) {
    writeLinearColumns(scale.s * x, scale.s * y, parameterCount(), d_parameters);
    for (int i = 4; i < parameterCount(); ++i) {
      d_parameters->col(i) << fx * x * scale.s_k[i - 4], fy * y * scale.s_k[i - 4];
    }
  }
  return isFinite(*pixel);
}

bool Camera::projectRadtan(const Eigen::Vector3d& point, Eigen::Vector2d* pixel, Matrix23d* d_point,
                           PixelIntrinsicsJacobian* d_parameters) const {
  if (!(point.z() > 0.0)) return false;
  const double inverse_z = 1.0 / point.z();
  const double a = point.x() * inverse_z;
  const double b = point.y() * inverse_z;
  const double r2 = a * a + b * b;
  if (!(r2 < max_radius2_)) return false;
  const double* p = parameters_.data();
  const double k1 = p[4], k2 = p[5], p1 = p[6], p2 = p[7];
  const double k3 = parameterCount() == kMaxIntrinsics ? p[8] : 0.0;
  const double gain = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double gain_slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3));  // (d gain/dr) / r
  const double u = a * gain + 2.0 * p1 * a * b + p2 * (r2 + 2.0 * a * a);
  const double v = b * gain + p1 * (r2 + 2.0 * b * b) + 2.0 * p2 * a * b;
  const double u_a = gain + a * a * gain_slope + 2.0 * p1 * b + 6.0 * p2 * a;
  const double u_b = a * b * gain_slope + 2.0 * p1 * a + 2.0 * p2 * b;  // = v_a
  const double v_b = gain + b * b * gain_slope + 6.0 * p1 * b + 2.0 * p2 * a;
  if (!(u_a * v_b > u_b * u_b)) return false;
  *pixel << p[0] * u + p[2], p[1] * v + p[3];
  if (d_point) {
    const double gx = p[0] * inverse_z, gy = p[1] * inverse_z;
    *d_point << gx * u_a, gx * u_b, -gx * (u_a * a + u_b * b),  //
        gy * u_b, gy * v_b, -gy * (u_b * a + v_b * b);
  }
  if (d_parameters) {
    writeLinearColumns(u, v, parameterCount(), d_parameters);
    d_parameters->col(4) << p[0] * a * r2, p[1] * b * r2;
    d_parameters->col(5) = r2 * d_parameters->col(4);
    d_parameters->col(6) << p[0] * 2.0 * a * b, p[1] * (r2 + 2.0 * b * b);
    d_parameters->col(7) << p[0] * (r2 + 2.0 * a * a), p[1] * 2.0 * a * b;
    if (parameterCount() == kMaxIntrinsics) d_parameters->col(8) = r2 * d_parameters->col(5);
  }
  return isFinite(*pixel);
}

}  // namespace camera_self_calibration
