#include "picture_head.h"

#include <algorithm>
#include <array>
#include <initializer_list>

namespace camera_self_calibration {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kMark = 0xFF;
constexpr std::uint8_t kStartOfScan = 0xDA;

bool beginsWith(const Bytes& data, std::initializer_list<std::uint8_t> begin) {
  return data.size() >= begin.size() && std::equal(begin.begin(), begin.end(), data.begin());
}

bool isJpeg(const Bytes& data) { return data.size() > 2 && beginsWith(data, {kMark, 0xD8}); }

/// The most significant byte first.
std::int64_t number(const Bytes& data, std::size_t at, std::size_t bytes) {
  std::int64_t value = 0;
  for (std::size_t i = at; i < at + bytes; ++i) value = value << 8 | data[i];
  return value;
}

/// SOF0 to SOF15, among which three are no starts of a frame.
bool startsFrame(std::uint8_t kind) {
  return kind >= 0xC0 && kind <= 0xCF && kind != 0xC4 && kind != 0xC8 && kind != 0xCC;
}

/// Where the first segment of a JPEG's head begins whose kind `wanted` likes; else where the head
/// ends. Segments may hold a preview with marks of its own.
template <typename Wanted>
std::size_t segment(const Bytes& data, Wanted wanted) {
  std::size_t at = 2;
  while (at + 3 < data.size() && data[at] == kMark && !wanted(data[at + 1]) &&
         data[at + 1] != kStartOfScan) {
    at += data[at + 1] == kMark ? 1 : 2 + static_cast<std::size_t>(number(data, at + 2, 2));
  }
  return std::min(at, data.size());
}

bool isWebP(const Bytes& data) {
  return beginsWith(data, {'R', 'I', 'F', 'F'}) && data.size() >= 12 &&
         std::equal(data.begin() + 8, data.begin() + 12, "WEBP");
}

bool isPnm(const Bytes& data) {
  return beginsWith(data, {'P'}) && data.size() > 2 && data[1] >= '1' && data[1] <= '6';
}

}  // namespace

bool isPicture(const Bytes& data) {
  return isJpeg(data) || beginsWith(data, {0x89, 'P', 'N', 'G'}) || beginsWith(data, {'B', 'M'}) ||
         isPnm(data) || isWebP(data) || beginsWith(data, {'I', 'I', 42, 0}) ||
         beginsWith(data, {'M', 'M', 0, 42});
}

std::optional<PictureSize> claimedSize(const Bytes& data) {
  if (beginsWith(data, {0x89, 'P', 'N', 'G'}) && data.size() >= 24) {
    return PictureSize{number(data, 16, 4), number(data, 20, 4)};
  }
  if (!isJpeg(data)) return std::nullopt;
  const std::size_t frame = segment(data, startsFrame);
  if (frame + 9 > data.size() || !startsFrame(data[frame + 1])) return std::nullopt;
  return PictureSize{number(data, frame + 7, 2), number(data, frame + 5, 2)};
}

bool isTruncatedJpeg(const Bytes& data) {
  if (!isJpeg(data)) return false;
  constexpr std::array<std::uint8_t, 2> kEndOfImage = {kMark, 0xD9};
  const std::size_t pixels = segment(data, [](std::uint8_t) { return false; });
  const auto begin = data.begin() + static_cast<std::ptrdiff_t>(pixels);
  return std::search(begin, data.end(), kEndOfImage.begin(), kEndOfImage.end()) == data.end();
}

}  // namespace camera_self_calibration
