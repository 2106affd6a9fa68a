#include "camera_self_calibration/tools/image_source.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <vector>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/ros/stamps.h"

namespace camera_self_calibration {
namespace {

namespace fs = std::filesystem;

constexpr double kDefaultRateHz = 30.0;

bool isImageFile(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static const std::vector<std::string> kKnown = {".png", ".jpg", ".jpeg", ".pgm", ".ppm",
                                                  ".bmp", ".tif", ".tiff", ".webp"};
  return std::find(kKnown.begin(), kKnown.end(), extension) != kKnown.end();
}

std::vector<fs::path> sortedImages(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && isImageFile(entry.path())) files.push_back(entry.path());
  }
  // img2 before img10, as people count.
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return ::strverscmp(a.filename().c_str(), b.filename().c_str()) < 0;
  });
  return files;
}

std::string orderText(const std::vector<fs::path>& files, double rate) {
  if (files.empty()) return {};
  constexpr std::size_t kNamed = 3;
  std::string names;
  for (std::size_t i = 0; i < std::min(kNamed, files.size()); ++i) {
    names += (i > 0 ? ", " : "") + files[i].filename().string();
  }
  if (files.size() > kNamed) names += ", ..., " + files.back().filename().string();
  return std::to_string(files.size()) + " images in the order " + names +
         formatted(", taken as %g Hz, from 0 s on.", rate);
}

GrayImage imageIn(const fs::path& file, std::int64_t stamp_ns, GrayConverter* converter) {
  const FileContents contents = readFile(file.string());
  if (!contents.error.empty()) return {std::nullopt, contents.error};
  sensor_msgs::CompressedImage message;
  message.header.stamp = toRosTime(stamp_ns);
  message.format = file.extension().string();
  message.data.assign(contents.bytes.begin(), contents.bytes.end());
  GrayImage image = converter->convert(message);
  if (!image.view) image.error = file.string() + ": " + image.error;
  return image;
}

/// The indices of the images of `total` that lie between start and start + duration.
struct IndexRange {
  std::int64_t begin = 0;
  std::int64_t end = 0;
};

IndexRange indexRange(const SourceOptions& options, double rate, std::int64_t total) {
  const auto index = [&](double seconds) {
    const double count = std::ceil(seconds * rate - 1e-6);
    return static_cast<std::int64_t>(std::clamp(count, 0.0, static_cast<double>(total)));
  };
  IndexRange range;
  range.begin = index(options.start_seconds);
  range.end = total;
  if (options.duration_seconds > 0.0) {
    range.end = index(options.start_seconds + options.duration_seconds);
  }
  return range;
}

std::int64_t stampOf(std::int64_t index, double rate) {
  return std::llround(static_cast<double>(index) * 1e9 / rate);
}

/// A bag by another name would pass for a video of the JPEG pictures in it.
bool beginsAsBag(const fs::path& path) {
  const std::string expected = "#ROSBAG V";
  std::string begin(expected.size(), '\0');
  std::ifstream(path, std::ios::binary)
      .read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin == expected;
}

}  // namespace

ImageSource openFolder(const SourceOptions& options) {
  const double rate = options.rate > 0.0 ? options.rate : kDefaultRateHz;
  const auto files = std::make_shared<const std::vector<fs::path>>(sortedImages(options.path));
  const IndexRange range = indexRange(options, rate, static_cast<std::int64_t>(files->size()));
  ImageSource source;
  source.name = options.path;
  source.count = range.end - range.begin;
  source.description = orderText(*files, rate);
  source.next = [files, rate, range, index = range.begin,
                 converter = GrayConverter()]() mutable -> std::optional<GrayImage> {
    if (index >= range.end) return std::nullopt;
    const fs::path& file = (*files)[static_cast<std::size_t>(index)];
    return imageIn(file, stampOf(index++, rate), &converter);
  };
  return source;
}

ImageSource openImages(const SourceOptions& options) {
  const fs::path path(options.path);
  if (!fs::exists(path)) throw std::runtime_error("there is no file or folder " + options.path);
  if (::access(path.c_str(), R_OK) != 0) {
    throw std::runtime_error(options.path + " cannot be read: " + std::strerror(errno));
  }
  const bool folder = fs::is_directory(path);
  const bool bag = !folder && (path.extension() == ".bag" || beginsAsBag(path));
  if (bag && options.rate > 0.0) {
    throw std::runtime_error(
        "the images of a bag have times of their own: --rate is for folders and videos. Leave it "
        "out");
  }
  if (!bag && !options.topic.empty()) {
    throw std::runtime_error("--topic chooses images of a bag, which " + options.path +
                             " is not. Leave it out");
  }
  if (bag) return openBag(options);
  return folder ? openFolder(options) : openVideo(options);
}

}  // namespace camera_self_calibration
