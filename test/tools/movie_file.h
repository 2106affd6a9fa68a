#pragma once

#include <cstdint>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

namespace camera_self_calibration {

/// Bytes of a QuickTime file, numbers with the highest byte first.
class MovieBytes {
 public:
  MovieBytes& number(std::uint32_t value, int bytes = 4) {
    for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(value >> (8 * i));
    return *this;
  }
  MovieBytes& numbers(const std::vector<std::uint32_t>& values) {
    for (const std::uint32_t value : values) number(value);
    return *this;
  }
  MovieBytes& zeros(std::size_t count) {
    text.append(count, '\0');
    return *this;
  }
  MovieBytes& add(const std::string& more) {
    text += more;
    return *this;
  }
  std::string box(const std::string& type) const {
    return MovieBytes()
        .number(static_cast<std::uint32_t>(text.size() + 8))
        .add(type)
        .add(text)
        .text;
  }
  std::string text;
};

/// A video as a phone writes it: each image (of one size, as JPEG) is shown for its own time, and
/// players are asked to turn all of them by 90 degrees.
struct MovieFile {
  std::vector<cv::Mat> images;
  std::vector<std::uint32_t> milliseconds;  ///< For which each image is shown.

  void write(const std::string& path) const {
    const std::string type = MovieBytes().add("qt  ").zeros(4).add("qt  ").box("ftyp");
    std::string data;
    std::vector<std::uint32_t> sizes = {0, 0, static_cast<std::uint32_t>(images.size())};
    std::vector<std::uint32_t> times = {0, static_cast<std::uint32_t>(images.size())};
    std::uint32_t duration = 0;
    for (std::size_t i = 0; i < images.size(); ++i) {
      std::vector<std::uint8_t> jpeg;
      cv::imencode(".jpg", images[i], jpeg, {cv::IMWRITE_JPEG_QUALITY, 98});
      data.append(jpeg.begin(), jpeg.end());
      sizes.push_back(static_cast<std::uint32_t>(jpeg.size()));
      times.insert(times.end(), {1, milliseconds[i]});
      duration += milliseconds[i];
    }
    const std::string tables =
        MovieBytes().numbers({0, 1}).add(sample()).box("stsd") +
        MovieBytes().numbers(times).box("stts") +
        MovieBytes().numbers({0, 1, 1, sizes[2], 1}).box("stsc") +
        MovieBytes().numbers(sizes).box("stsz") +
        MovieBytes().numbers({0, 1, static_cast<std::uint32_t>(type.size() + 8)}).box("stco");
    std::ofstream(path, std::ios::binary)
        << type << MovieBytes().add(data).box("mdat") << movie(tables, duration);
  }

 private:
  std::string sample() const {
    const auto width = static_cast<std::uint32_t>(images[0].cols);
    const auto height = static_cast<std::uint32_t>(images[0].rows);
    return MovieBytes()
        .zeros(6)
        .number(1, 2)
        .zeros(16)
        .number(width, 2)
        .number(height, 2)
        .numbers({0x480000, 0x480000, 0})
        .number(1, 2)
        .zeros(32)
        .number(24, 2)
        .number(0xFFFF, 2)
        .box("jpeg");
  }
  std::string movie(const std::string& tables, std::uint32_t duration) const {
    constexpr std::uint32_t kOne = 0x10000;
    constexpr std::uint32_t kPerSecond = 1000;
    const std::string self = MovieBytes().number(1).box("url ");
    const std::string media =
        MovieBytes().numbers({0, 0, 0, kPerSecond, duration, 0}).box("mdhd") +
        MovieBytes().numbers({0, 0}).add("vide").zeros(13).box("hdlr") +
        MovieBytes()
            .add(MovieBytes().number(1).zeros(8).box("vmhd"))
            .add(MovieBytes().add(MovieBytes().numbers({0, 1}).add(self).box("dref")).box("dinf"))
            .add(MovieBytes().add(tables).box("stbl"))
            .box("minf");
    const std::string head =
        MovieBytes()
            .numbers({0xF, 0, 0, 1, 0, duration, 0, 0, 0, 0})
            .numbers({0, kOne, 0, static_cast<std::uint32_t>(-static_cast<int>(kOne)), 0, 0})
            .numbers({static_cast<std::uint32_t>(images[0].rows) * kOne, 0, 0x40000000})
            .numbers({static_cast<std::uint32_t>(images[0].cols) * kOne,
                      static_cast<std::uint32_t>(images[0].rows) * kOne})
            .box("tkhd");
    const std::string track =
        MovieBytes().add(head).add(MovieBytes().add(media).box("mdia")).box("trak");
    return MovieBytes()
        .add(MovieBytes()
                 .numbers({0, 0, 0, kPerSecond, duration, kOne})
                 .number(0x100, 2)
                 .zeros(10)
                 .numbers({kOne, 0, 0, 0, kOne, 0, 0, 0, 0x40000000})
                 .zeros(24)
                 .number(2)
                 .box("mvhd"))
        .add(track)
        .box("moov");
  }
};

}  // namespace camera_self_calibration
