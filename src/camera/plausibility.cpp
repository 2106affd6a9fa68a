#include "camera_self_calibration/camera/plausibility.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/image_size.h"

namespace camera_self_calibration {
namespace {

constexpr double kShortest = 0.1;  // focal length over the longer side of the image
constexpr double kLongest = 50.0;
constexpr double kMostAnamorphic = 4.0;  // ratio of the focal lengths

constexpr double kFarthest = 20.0;  // principal point outside the image, in image sizes

// What a coefficient moves the image's farthest corner by, over its distance from the principal
// point.
constexpr double kStrongest = 1000.0;

bool isNear(double position, int size) {
  return position >= -kFarthest * size && position <= (1.0 + kFarthest) * size;
}

/// Distance of the farthest corner from the principal point, in focal lengths.
double reach(const Camera& camera) {
  const Intrinsics& p = camera.parameters();
  const double x = std::max(std::abs(p(2)), std::abs(camera.width() - p(2))) / p(0);
  const double y = std::max(std::abs(p(3)), std::abs(camera.height() - p(3))) / p(1);
  return std::hypot(x, y);
}

/// Why a coefficient of the distortion cannot be one of a lens; empty if they all can.
std::string strongDistortion(const Camera& camera) {
  constexpr std::array<int, 5> kRadtan = {2, 4, 1, 1, 6};  // the radius counts with these powers
  constexpr std::array<int, 5> kEquidistant = {2, 4, 6, 8};
  const bool radtan = camera.model() == CameraModel::kRadtan;
  if (!radtan && camera.model() != CameraModel::kEquidistant) return "";
  const double radius = reach(camera);
  for (int i = 4; i < camera.parameterCount(); ++i) {
    const double coefficient = camera.parameters()(i);
    const int power = (radtan ? kRadtan : kEquidistant)[static_cast<std::size_t>(i - 4)];
    if (std::abs(coefficient) * std::pow(radius, power) <= kStrongest) continue;
    return formatted("no lens has a distortion of %s = %.4g",
                     camera.parameterNames()[static_cast<std::size_t>(i)].c_str(), coefficient);
  }
  return "";
}

}  // namespace

std::string implausibility(const Camera& camera) {
  if (!camera.valid()) return "the values are not valid ones of the model";
  if (camera.width() == 0 || camera.height() == 0) return "the image size is missing";
  if (!isImageSize(camera.width(), camera.height())) {
    return formatted("images of %d x %d are too large for a camera", camera.width(),
                     camera.height());
  }
  const Intrinsics& p = camera.parameters();
  const double longer = camera.longerSide();
  for (const double focal_length : {p(0), p(1)}) {
    if (focal_length >= kShortest * longer && focal_length <= kLongest * longer) continue;
    return formatted(
        "no camera with images of %d x %d has a focal length of %.4g px; it must lie between %.0f "
        "and %.0f pixels (not millimetres)",
        camera.width(), camera.height(), focal_length, kShortest * longer, kLongest * longer);
  }
  if (std::max(p(0), p(1)) > kMostAnamorphic * std::min(p(0), p(1))) {
    return formatted("focal lengths of %.4g and %.4g px are too different", p(0), p(1));
  }
  if (!isNear(p(2), camera.width()) || !isNear(p(3), camera.height())) {
    return formatted("the principal point (%.4g, %.4g) lies far outside the image of %d x %d", p(2),
                     p(3), camera.width(), camera.height());
  }
  return strongDistortion(camera);
}

}  // namespace camera_self_calibration
