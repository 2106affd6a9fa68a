#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace camera_self_calibration {

struct PictureSize {
  std::int64_t width = 0;   ///< [px]
  std::int64_t height = 0;  ///< [px]
};

/// Whether the first bytes are those of a JPEG, PNG, BMP, PNM, TIFF or WebP picture. OpenCV knows
/// more formats, which no camera sends; their decoders are less tried, and some write files of
/// their own.
bool isPicture(const std::vector<std::uint8_t>& data);

/// The size that stands in the head of a JPEG, PNG, BMP, PNM or WebP picture, so that a few bytes
/// that claim a gigabyte need not be decoded; nothing for TIFF, and where it is not found.
std::optional<PictureSize> claimedSize(const std::vector<std::uint8_t>& data);

/// Whether a JPEG picture ends before its end: a decoder fills what is missing with gray and only
/// warns. False for other formats.
bool isTruncatedJpeg(const std::vector<std::uint8_t>& data);

}  // namespace camera_self_calibration
