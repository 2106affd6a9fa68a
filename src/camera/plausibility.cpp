#include "camera_self_calibration/camera/plausibility.h"

#include <algorithm>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/image_size.h"

namespace camera_self_calibration {
namespace {

constexpr double kShortest = 0.1;  // focal length over the longer side of the image
constexpr double kLongest = 50.0;
constexpr double kMostAnamorphic = 4.0;  // ratio of the focal lengths

constexpr double kFarthest = 20.0;  // principal point outside the image, in image sizes

bool isNear(double position, int size) {
  return position >= -kFarthest * size && position <= (1.0 + kFarthest) * size;
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
  const double longer = std::max(camera.width(), camera.height());
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
  return "";
}

}  // namespace camera_self_calibration
