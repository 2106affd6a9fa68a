#pragma once

#include <algorithm>
#include <cstdint>

namespace camera_self_calibration {

/// Longest side of an image [px], and most pixels of one: beyond any camera of a robot, and within
/// what memory stands.
constexpr int kLargestSide = 32768;
constexpr std::int64_t kMostPixels = std::int64_t{1} << 26;

/// Whether a camera can have images of this size [px].
constexpr bool isImageSize(std::int64_t width, std::int64_t height) {
  return width > 0 && height > 0 && width <= kLargestSide && height <= kLargestSide &&
         width * height <= kMostPixels;
}

/// What lengths in an image are measured by [px]: the same whichever way up the camera is held.
constexpr int longerSide(int width, int height) { return std::max(width, height); }

}  // namespace camera_self_calibration
