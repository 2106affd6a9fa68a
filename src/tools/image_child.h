#pragma once

#include <functional>

#include "camera_self_calibration/tools/image_source.h"

namespace camera_self_calibration {

/// The source that `open` opens, opened and read in a process of its own, which hands on its
/// images. What ends that process, such as a damaged file that a library does not survive, throws
/// std::runtime_error here, as do its exceptions: `crashed` is the text for the former.
ImageSource openInChild(const std::function<ImageSource()>& open, const std::string& crashed);

}  // namespace camera_self_calibration
