#pragma once

#include <cstdint>
#include <memory>

namespace camera_self_calibration {

/// A gray image, 8 bits a pixel, that somebody else owns: no copy on the way from the topic.
struct ImageView {
  std::shared_ptr<const void> owner;  ///< Keeps `data` alive; may be null if the caller does.
  const std::uint8_t* data = nullptr;
  int width = 0;   ///< [px]
  int height = 0;  ///< [px]
  int stride = 0;  ///< Bytes from one row to the next.
  std::int64_t stamp_ns = 0;
};

}  // namespace camera_self_calibration
