#include "camera_self_calibration/ros/camera_info.h"

#include <sensor_msgs/distortion_models.h>

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/camera/image_size.h"
#include "camera_self_calibration/camera/plausibility.h"
#include "camera_self_calibration/camera/rational_fit.h"

namespace camera_self_calibration {
namespace {

constexpr std::size_t kPlumbBobCount = 5;
constexpr std::size_t kEquidistantCount = 4;
constexpr std::size_t kRationalCount = 8;

bool isZero(double value) { return value == 0.0; }

bool isRational(const sensor_msgs::CameraInfo& info) {
  return info.distortion_model == sensor_msgs::distortion_models::RATIONAL_POLYNOMIAL &&
         (info.D.empty() || info.D.size() == kRationalCount);
}

/// One of images; a width or height that is not given (0) may be anything that they have.
bool hasPossibleSize(const sensor_msgs::CameraInfo& info) {
  return isImageSize(std::max(info.width, 1u), std::max(info.height, 1u));
}

void setMatrices(const Intrinsics& p, sensor_msgs::CameraInfo* info) {
  info->K = {p[0], 0.0, p[2], 0.0, p[1], p[3], 0.0, 0.0, 1.0};
  info->R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info->P = {p[0], 0.0, p[2], 0.0, 0.0, p[1], p[3], 0.0, 0.0, 0.0, 1.0, 0.0};
}

/// A camera whose model has a standard name.
sensor_msgs::CameraInfo exactInfo(const Camera& camera) {
  sensor_msgs::CameraInfo info = uncalibratedCameraInfo(camera.width(), camera.height());
  const Intrinsics& p = camera.parameters();
  const bool equidistant = camera.model() == CameraModel::kEquidistant;
  info.distortion_model = equidistant ? sensor_msgs::distortion_models::EQUIDISTANT
                                      : sensor_msgs::distortion_models::PLUMB_BOB;
  info.D.assign(equidistant ? kEquidistantCount : kPlumbBobCount, 0.0);
  std::copy(p.data() + 4, p.data() + p.size(), info.D.begin());
  setMatrices(p, &info);
  return info;
}

std::optional<CameraInfoConversion> rationalInfo(const Camera& camera) {
  const std::optional<RationalFit> fit = fitRationalPolynomial(camera);
  if (!fit) return std::nullopt;
  const RationalPolynomial& fitted = fit->camera;
  sensor_msgs::CameraInfo info = uncalibratedCameraInfo(camera.width(), camera.height());
  info.distortion_model = sensor_msgs::distortion_models::RATIONAL_POLYNOMIAL;
  info.D.assign(fitted.coefficients.begin(), fitted.coefficients.end());
  Intrinsics k(4);
  k << fitted.fx, fitted.fy, fitted.cx, fitted.cy;
  setMatrices(k, &info);
  return CameraInfoConversion{info, fit->error};
}

/// The model that is written, and that a camera of another one is fitted with.
CameraModel writtenModel(CameraModel model, OutputModel output) {
  const bool polynomial = model == CameraModel::kPinhole || model == CameraModel::kRadtan;
  if (output == OutputModel::kEquidistant) return CameraModel::kEquidistant;
  if (output == OutputModel::kPlumbBob) return polynomial ? model : CameraModel::kRadtan;
  return polynomial ? model : CameraModel::kEquidistant;
}

}  // namespace

std::optional<OutputModel> outputModelFromString(const std::string& name) {
  if (name == "auto") return OutputModel::kAuto;
  if (name == "plumb_bob") return OutputModel::kPlumbBob;
  if (name == "rational_polynomial") return OutputModel::kRationalPolynomial;
  if (name == "equidistant") return OutputModel::kEquidistant;
  return std::nullopt;
}

std::optional<CameraInfoConversion> toCameraInfo(const Camera& camera, OutputModel output) {
  if (!camera.valid()) return std::nullopt;
  if (output == OutputModel::kRationalPolynomial) return rationalInfo(camera);
  const CameraModel model = writtenModel(camera.model(), output);
  if (model == camera.model()) return CameraInfoConversion{exactInfo(camera), {}};
  const std::optional<CameraFit> fit = fitCamera(camera, model);
  if (!fit) return std::nullopt;
  return CameraInfoConversion{exactInfo(fit->camera), fit->error};
}

sensor_msgs::CameraInfo uncalibratedCameraInfo(int width, int height) {
  sensor_msgs::CameraInfo info;
  info.width = static_cast<std::uint32_t>(width);
  info.height = static_cast<std::uint32_t>(height);
  return info;
}

std::optional<Camera> toCamera(const sensor_msgs::CameraInfo& info) {
  if (!(info.K[0] > 0.0 && info.K[4] > 0.0) || !hasPossibleSize(info)) return std::nullopt;
  const bool rational = isRational(info);
  const bool plumb_bob = info.distortion_model == sensor_msgs::distortion_models::PLUMB_BOB;
  const bool equidistant = info.distortion_model == sensor_msgs::distortion_models::EQUIDISTANT;
  const std::size_t count = equidistant ? kEquidistantCount : kPlumbBobCount;
  std::vector<double> d = info.D;
  // Some drivers leave k3 out, others write zeros up to k6.
  if (plumb_bob && d.size() == kPlumbBobCount - 1) d.push_back(0.0);
  if (!equidistant && d.size() > kPlumbBobCount &&
      std::all_of(d.begin() + kPlumbBobCount, d.end(), isZero)) {
    d.resize(count);
  }
  if (!(plumb_bob || equidistant || rational) || (!d.empty() && d.size() != count)) {
    return std::nullopt;
  }
  std::vector<double> values = {info.K[0], info.K[4], info.K[2], info.K[5]};
  CameraModel model = equidistant ? CameraModel::kEquidistant : CameraModel::kPinhole;
  if (equidistant) {
    d.resize(kEquidistantCount, 0.0);
    values.insert(values.end(), d.begin(), d.end());
  } else if (!std::all_of(d.begin(), d.end(), isZero)) {
    model = CameraModel::kRadtan;
    values.insert(values.end(), d.begin(), d.end() - (isZero(d.back()) ? 1 : 0));
  }
  const Camera camera(
      model, static_cast<int>(info.width), static_cast<int>(info.height),
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  return camera.valid() ? std::optional<Camera>(camera) : std::nullopt;
}

Camera undistorted(const sensor_msgs::CameraInfo& info) {
  return Camera(CameraModel::kPinhole, static_cast<int>(info.width), static_cast<int>(info.height),
                Eigen::Vector4d(info.K[0], info.K[4], info.K[2], info.K[5]));
}

std::optional<CameraFit> toCamera(const sensor_msgs::CameraInfo& info,
                                  std::optional<CameraModel> model) {
  if (const std::optional<Camera> camera = toCamera(info)) return CameraFit{*camera, {}};
  if (!isRational(info) || !implausibility(undistorted(info)).empty()) return std::nullopt;
  RationalPolynomial polynomial{info.K[0], info.K[4], info.K[2], info.K[5], {}};
  std::copy(info.D.begin(), info.D.end(), polynomial.coefficients.begin());
  const std::optional<CameraFit> fit =
      fitCamera(polynomial, static_cast<int>(info.width), static_cast<int>(info.height),
                model.value_or(CameraModel::kEquidistant));
  // A lens that cannot project the whole image would later pass for a change of it.
  return fit && std::isfinite(fit->error.max) ? fit : std::nullopt;
}

bool isOfAPair(const sensor_msgs::CameraInfo& info) {
  const bool turned = info.R[1] != 0.0 || info.R[2] != 0.0 || info.R[5] != 0.0;
  return turned || info.P[3] != 0.0 || info.P[7] != 0.0;
}

}  // namespace camera_self_calibration
