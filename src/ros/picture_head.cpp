#include "picture_head.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <initializer_list>
#include <sstream>
#include <string>

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

/// The least significant byte first.
std::int64_t littleNumber(const Bytes& data, std::size_t at, std::size_t bytes) {
  std::int64_t value = 0;
  for (std::size_t i = at + bytes; i > at; --i) value = value << 8 | data[i - 1];
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

bool isPng(const Bytes& data) { return beginsWith(data, {0x89, 'P', 'N', 'G'}); }

bool isBmp(const Bytes& data) { return beginsWith(data, {'B', 'M'}); }

std::optional<PictureSize> pngSize(const Bytes& data) {
  if (data.size() < 24) return std::nullopt;
  return PictureSize{number(data, 16, 4), number(data, 20, 4)};
}

std::optional<PictureSize> jpegSize(const Bytes& data) {
  const std::size_t frame = segment(data, startsFrame);
  if (frame + 9 > data.size() || !startsFrame(data[frame + 1])) return std::nullopt;
  return PictureSize{number(data, frame + 7, 2), number(data, frame + 5, 2)};
}

std::optional<PictureSize> bmpSize(const Bytes& data) {
  if (data.size() < 26) return std::nullopt;
  const bool oldest = littleNumber(data, 14, 4) == 12;  // of OS/2
  if (oldest) return PictureSize{littleNumber(data, 18, 2), littleNumber(data, 20, 2)};
  // Negative where the first row is the topmost.
  const auto height = static_cast<std::int32_t>(littleNumber(data, 22, 4));
  return PictureSize{littleNumber(data, 18, 4), std::abs(std::int64_t{height})};
}

std::optional<PictureSize> pnmSize(const Bytes& data) {
  constexpr std::size_t kHead = 4096;  // comments and all; not the pixels
  std::istringstream head(std::string(
      data.begin() + 2, data.begin() + static_cast<std::ptrdiff_t>(std::min(data.size(), kHead))));
  PictureSize size;
  for (std::int64_t* side : {&size.width, &size.height}) {
    for (std::string comment; (head >> std::ws).peek() == '#';) std::getline(head, comment);
    if (!(head >> *side)) return std::nullopt;
  }
  return size;
}

std::optional<PictureSize> webPSize(const Bytes& data) {
  if (data.size() < 30) return std::nullopt;
  constexpr std::int64_t kSide = 0x3FFF;
  const std::string kind(data.begin() + 12, data.begin() + 16);
  if (kind == "VP8X") {
    return PictureSize{littleNumber(data, 24, 3) + 1, littleNumber(data, 27, 3) + 1};
  }
  if (kind == "VP8L") {
    const std::int64_t sides = littleNumber(data, 21, 4);
    return PictureSize{(sides & kSide) + 1, (sides >> 14 & kSide) + 1};
  }
  return PictureSize{littleNumber(data, 26, 2) & kSide, littleNumber(data, 28, 2) & kSide};
}

}  // namespace

bool isPicture(const Bytes& data) {
  return isJpeg(data) || isPng(data) || isBmp(data) || isPnm(data) || isWebP(data) ||
         beginsWith(data, {'I', 'I', 42, 0}) || beginsWith(data, {'M', 'M', 0, 42});
}

std::optional<PictureSize> claimedSize(const Bytes& data) {
  if (isJpeg(data)) return jpegSize(data);
  if (isPng(data)) return pngSize(data);
  if (isBmp(data)) return bmpSize(data);
  if (isPnm(data)) return pnmSize(data);
  return isWebP(data) ? webPSize(data) : std::nullopt;
}

bool isTruncatedJpeg(const Bytes& data) {
  if (!isJpeg(data)) return false;
  constexpr std::array<std::uint8_t, 2> kEndOfImage = {kMark, 0xD9};
  const std::size_t pixels = segment(data, [](std::uint8_t) { return false; });
  const auto begin = data.begin() + static_cast<std::ptrdiff_t>(pixels);
  return std::search(begin, data.end(), kEndOfImage.begin(), kEndOfImage.end()) == data.end();
}

}  // namespace camera_self_calibration
