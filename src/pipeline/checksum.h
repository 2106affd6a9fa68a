#pragma once

#include <cstddef>
#include <cstdint>

namespace camera_self_calibration {

/// FNV-1a: finds damage, not malice.
inline std::uint64_t checksum(const char* bytes, std::size_t size) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (std::size_t i = 0; i < size; ++i) {
    hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 1099511628211ULL;
  }
  return hash;
}

}  // namespace camera_self_calibration
