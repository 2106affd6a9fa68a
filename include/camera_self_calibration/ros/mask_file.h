#pragma once

#include <optional>
#include <string>

#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

/// Either a mask or, in words, why there is none.
struct MaskReading {
  std::optional<ImageView> mask;
  std::string error;  ///< Empty if there is a mask, or none was asked for.
};

/// Reads an image, in which black forbids features. A relative path starts from the working
/// directory.
MaskReading readMask(const std::string& path);

/// The same for file:///PATH, package://PACKAGE/PATH or a path, of which a relative one starts from
/// ROS_HOME, as those of all parameters. An empty URL asks for none.
MaskReading readMaskUrl(const std::string& url);

/// Why a mask does not fit images of this size [px], in words; empty if it does: it is of the same
/// shape and may be scaled.
std::string maskMisfit(const ImageView& mask, int width, int height);

}  // namespace camera_self_calibration
