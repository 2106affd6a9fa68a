#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace camera_self_calibration {

/// The projection models. Parameters, in this order everywhere (vectors, messages, files):
///  - kPinhole:     fx fy cx cy
///  - kFov:         fx fy cx cy w            (Devernay & Faugeras 2001)
///  - kRadtan:      fx fy cx cy k1 k2 p1 p2 [k3]  (ROS "plumb_bob", OpenCV)
///  - kEquidistant: fx fy cx cy k1 k2 k3 k4  (Kannala & Brandt 2006, OpenCV fisheye)
/// Pixel centres lie at integer coordinates (OpenCV, ROS).
enum class CameraModel { kPinhole, kFov, kRadtan, kEquidistant };

/// "pinhole", "fov", "radtan", "equidistant".
std::string toString(CameraModel model);

/// Accepts the names of toString and "plumb_bob" for radtan; nothing for any other string.
std::optional<CameraModel> cameraModelFromString(const std::string& name);

constexpr int kMaxIntrinsics = 9;
using Intrinsics = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxIntrinsics, 1>;
/// n_c x n_c, of the estimated parameters.
using IntrinsicsMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                                       kMaxIntrinsics, kMaxIntrinsics>;
using Matrix23d = Eigen::Matrix<double, 2, 3>;
/// d pixel / d parameters, 2 x parameters().size().
using PixelIntrinsicsJacobian =
    Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, kMaxIntrinsics>;
/// d ray / d parameters, 3 x parameters().size().
using RayIntrinsicsJacobian =
    Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxIntrinsics>;

/// A camera's model, image size and intrinsics: a plain value, cheap to copy.
/// Rays are in the optical frame of REP 103 (x right, y down, z forward).
class Camera {
 public:
  /// An empty pinhole camera of size 0 x 0: nothing projects.
  Camera() = default;

  /// `parameters` has parameterCount(model) entries (radtan: 8, or 9 with k3); any other length
  /// throws std::invalid_argument. Sizes in pixels.
  Camera(CameraModel model, int width, int height, const Intrinsics& parameters);

  /// What is assumed of an unknown lens: f = half the longer side, principal point at the image
  /// centre ((width - 1) / 2, (height - 1) / 2), fov w = 1, all other distortion 0.
  static Camera defaultGuess(CameraModel model, int width, int height);

  /// Length of a model's parameter vector (radtan without k3).
  static int parameterCount(CameraModel model);

  CameraModel model() const { return model_; }
  int width() const { return width_; }
  int height() const { return height_; }
  /// What lengths in its images are measured by: the same whichever way up it is held.
  int longerSide() const { return std::max(width_, height_); }
  const Intrinsics& parameters() const { return parameters_; }
  int parameterCount() const { return static_cast<int>(parameters_.size()); }

  /// n_c: how many parameters, from the first, an estimator changes. All, but for k3 of radtan,
  /// which is kept as given unless setEstimateK3(true).
  int estimatedCount() const { return estimated_count_; }
  /// Whether an estimator changes the same parameters of both.
  bool estimatesSameAs(const Camera& other) const {
    return model_ == other.model_ && estimated_count_ == other.estimated_count_;
  }
  /// Adds k3 (starting at 0 if absent) to the estimated parameters of a radtan camera, or holds it.
  void setEstimateK3(bool estimate);

  /// Same length as parameters(); any other length throws std::invalid_argument.
  void setParameters(const Intrinsics& parameters);

  /// "fx", "fy", ... in the order of parameters().
  std::vector<std::string> parameterNames() const;

  /// Finite values, fx, fy > 0, fov w in (0, pi).
  bool valid() const { return valid_; }

  /// Projects a point (any positive scale) to a pixel. False, and outputs undefined, where the
  /// model does not apply: the camera is not valid(), the point is not in front (pinhole, fov,
  /// radtan), beyond the radius up to which the distortion is monotonic (radtan, equidistant),
  /// where the tangential terms fold the image (radtan), or not finite. The pixel may lie outside
  /// the image. Derivatives are analytic; null pointers are skipped.
  bool project(const Eigen::Vector3d& point, Eigen::Vector2d* pixel, Matrix23d* d_point = nullptr,
               PixelIntrinsicsJacobian* d_parameters = nullptr) const;

  /// Unit ray through a pixel; nothing where no ray of the model's domain projects there.
  std::optional<Eigen::Vector3d> unproject(const Eigen::Vector2d& pixel) const;

  /// As unproject, with d ray / d parameters: J = d pixel / d ray, the ray stays of unit length,
  /// `d ray/d x_c = -J^T (J J^T)^-1 d pixel/d x_c`.
  bool unproject(const Eigen::Vector2d& pixel, Eigen::Vector3d* ray,
                 RayIntrinsicsJacobian* d_parameters) const;

  /// Whether a pixel lies between the centres of the outermost pixels, at least `border` from them.
  bool inImage(const Eigen::Vector2d& pixel, double border = 0.0) const;

 private:
  struct AxialScale;
  void updateDerived();
  bool axialScale(const Eigen::Vector3d& point, bool derivatives, AxialScale* scale) const;
  void fovScale(double r2, double z, bool derivatives, AxialScale* scale) const;
  bool equidistantScale(double r2, double z, bool derivatives, AxialScale* scale) const;
  bool projectRadtan(const Eigen::Vector3d& point, Eigen::Vector2d* pixel, Matrix23d* d_point,
                     PixelIntrinsicsJacobian* d_parameters) const;
  std::optional<Eigen::Vector3d> unprojectFov(const Eigen::Vector2d& distorted) const;
  std::optional<Eigen::Vector3d> unprojectRadtan(const Eigen::Vector2d& distorted) const;
  std::optional<Eigen::Vector3d> unprojectEquidistant(const Eigen::Vector2d& distorted) const;

  CameraModel model_ = CameraModel::kPinhole;
  int width_ = 0;
  int height_ = 0;
  int estimated_count_ = 4;
  Intrinsics parameters_ = Intrinsics::Zero(4);

  // Derived from the parameters alone, by updateDerived.
  bool valid_ = false;
  // Largest angle (equidistant: theta) or normalised radius (radtan) at which the distortion still
  // grows.
  double max_radius_ = 0.0;
  double max_radius2_ = 0.0;
  double fov_k_ = 0.0;        // k = 2 tan(w/2)
  double fov_k_by_w_ = 0.0;   // k / w
  double fov_dk_by_w_ = 0.0;  // (dk/dw - k/w) / w
};

}  // namespace camera_self_calibration
