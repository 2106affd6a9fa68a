#include "camera_self_calibration/camera/camera.h"

#include <cmath>
#include <stdexcept>

#include "camera_self_calibration/camera/image_size.h"
#include "odd_polynomial.h"

namespace camera_self_calibration {
namespace {

constexpr double kPi = 3.14159265358979323846;
// End of the domain of a radtan camera whose distortion never folds: 89.94 degrees off the axis.
constexpr double kMaxNormalisedRadius = 1e3;

// (1 - sin(w)/w) / w, by its series where the difference would cancel.
double sincDefectByW(double w) {
  if (w > 0.3) return (1.0 - std::sin(w) / w) / w;
  const double w2 = w * w;
  return w *
         (1.0 / 6.0 - w2 * (1.0 / 120.0 -
                            w2 * (1.0 / 5040.0 - w2 * (1.0 / 362880.0 - w2 * (1.0 / 39916800.0)))));
}

}  // namespace

std::string toString(CameraModel model) {
  switch (model) {
    case CameraModel::kPinhole:
      return "pinhole";
    case CameraModel::kFov:
      return "fov";
    case CameraModel::kRadtan:
      return "radtan";
    case CameraModel::kEquidistant:
      return "equidistant";
  }
  return "unknown";
}

std::optional<CameraModel> cameraModelFromString(const std::string& name) {
  if (name == "plumb_bob") return CameraModel::kRadtan;
  for (const CameraModel model : {CameraModel::kPinhole, CameraModel::kFov, CameraModel::kRadtan,
                                  CameraModel::kEquidistant}) {
    if (name == toString(model)) return model;
  }
  return std::nullopt;
}

Camera::Camera(CameraModel model, int width, int height, const Intrinsics& parameters)
    : model_(model),
      width_(width),
      height_(height),
      estimated_count_(parameterCount(model)),
      parameters_(parameters) {
  const bool with_k3 = model == CameraModel::kRadtan && parameters.size() == kMaxIntrinsics;
  if (parameters.size() != parameterCount(model) && !with_k3) {
    throw std::invalid_argument(
        "A " + toString(model) + " camera takes " + std::to_string(parameterCount(model)) +
        " parameters (radtan: 8, or 9 with k3), not " + std::to_string(parameters.size()) + ".");
  }
  updateDerived();
}

Camera Camera::defaultGuess(CameraModel model, int width, int height) {
  const double focal = 0.5 * camera_self_calibration::longerSide(width, height);
  Intrinsics parameters = Intrinsics::Zero(parameterCount(model));
  parameters.head<4>() << focal, focal, 0.5 * (width - 1), 0.5 * (height - 1);
  if (model == CameraModel::kFov) parameters[4] = 1.0;
  return Camera(model, width, height, parameters);
}

int Camera::parameterCount(CameraModel model) {
  switch (model) {
    case CameraModel::kPinhole:
      return 4;
    case CameraModel::kFov:
      return 5;
    case CameraModel::kRadtan:
    case CameraModel::kEquidistant:
      return 8;
  }
  return 0;
}

void Camera::setEstimateK3(bool estimate) {
  if (model_ != CameraModel::kRadtan) return;
  if (estimate && parameters_.size() == 8) {
    parameters_.conservativeResize(9);
    parameters_[8] = 0.0;
  }
  estimated_count_ = estimate ? 9 : 8;
}

void Camera::setParameters(const Intrinsics& parameters) {
  if (parameters.size() != parameters_.size()) {
    throw std::invalid_argument("This " + toString(model_) + " camera has " +
                                std::to_string(parameters_.size()) + " parameters, not " +
                                std::to_string(parameters.size()) + ".");
  }
  parameters_ = parameters;
  updateDerived();
}

std::vector<std::string> Camera::parameterNames() const {
  std::vector<std::string> names{"fx", "fy", "cx", "cy"};
  std::vector<std::string> more;
  if (model_ == CameraModel::kFov) more = {"w"};
  if (model_ == CameraModel::kRadtan) more = {"k1", "k2", "p1", "p2"};
  if (model_ == CameraModel::kEquidistant) more = {"k1", "k2", "k3", "k4"};
  if (parameters_.size() == kMaxIntrinsics) more.push_back("k3");
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

bool Camera::inImage(const Eigen::Vector2d& pixel, double border) const {
  return pixel.x() >= border && pixel.x() <= width_ - 1 - border && pixel.y() >= border &&
         pixel.y() <= height_ - 1 - border;
}

void Camera::updateDerived() {
  const Intrinsics& p = parameters_;
  valid_ = p.allFinite() && p[0] > 0.0 && p[1] > 0.0;
  if (model_ == CameraModel::kFov) valid_ = valid_ && p[4] > 0.0 && p[4] < kPi;
  if (!valid_) return;
  if (model_ == CameraModel::kFov) {
    const double w = p[4];
    fov_k_ = 2.0 * std::tan(0.5 * w);
    fov_k_by_w_ = fov_k_ / w;
    // dk/dw = 1/cos^2(w/2), hence dk/dw - k/w = (1 - sin(w)/w) / cos^2(w/2).
    fov_dk_by_w_ = sincDefectByW(w) * (1.0 + 0.25 * fov_k_ * fov_k_);
  } else if (model_ == CameraModel::kRadtan) {
    const OddPolynomial radial{{p[4], p[5], p.size() == kMaxIntrinsics ? p[8] : 0.0, 0.0}};
    max_radius_ = radial.monotonicLimit(kMaxNormalisedRadius);
  } else if (model_ == CameraModel::kEquidistant) {
    max_radius_ = OddPolynomial{{p[4], p[5], p[6], p[7]}}.monotonicLimit(kPi);
  }
  max_radius2_ = max_radius_ * max_radius_;
}

}  // namespace camera_self_calibration
