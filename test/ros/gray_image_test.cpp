#include "camera_self_calibration/ros/gray_image.h"

#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <array>
#include <boost/make_shared.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

namespace camera_self_calibration {
namespace {

namespace encodings = sensor_msgs::image_encodings;

constexpr int kWidth = 32;
constexpr int kHeight = 24;
constexpr std::int64_t kStampNs = 1700000000123456789;

/// A smooth picture, so that Bayer and JPEG reproduce it well: gray = 40 + 4 x + y.
int expectedGray(int x, int y) { return 40 + 4 * x + y; }

sensor_msgs::ImagePtr makeMessage(const std::string& encoding, int bytes_per_pixel,
                                  int padding = 0) {
  const auto message = boost::make_shared<sensor_msgs::Image>();
  message->header.stamp = ros::Time(1700000000, 123456789);
  message->encoding = encoding;
  message->width = kWidth;
  message->height = kHeight;
  message->step = static_cast<std::uint32_t>(kWidth * bytes_per_pixel + padding);
  message->data.assign(message->step * kHeight, 0);
  return message;
}

/// Sets each pixel's bytes through `bytes(x, y, channel)`.
template <typename Bytes>
sensor_msgs::ImagePtr fill(sensor_msgs::ImagePtr message, int bytes_per_pixel, Bytes bytes) {
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < bytes_per_pixel; ++c) {
        const std::size_t offset = static_cast<std::size_t>(y) * message->step +
                                   static_cast<std::size_t>(x * bytes_per_pixel + c);
        message->data[offset] = static_cast<std::uint8_t>(bytes(x, y, c));
      }
    }
  }
  return message;
}

void expectPicture(const GrayImage& image, int tolerance, int border = 0) {
  ASSERT_TRUE(image.view) << image.error;
  EXPECT_TRUE(image.error.empty());
  const ImageView& view = *image.view;
  ASSERT_EQ(view.width, kWidth);
  ASSERT_EQ(view.height, kHeight);
  EXPECT_EQ(view.stamp_ns, kStampNs);
  for (int y = border; y < kHeight - border; ++y) {
    for (int x = border; x < kWidth - border; ++x) {
      ASSERT_NEAR(view.data[y * view.stride + x], expectedGray(x, y), tolerance)
          << "at " << x << ", " << y;
    }
  }
}

int gray(int x, int y, int) { return expectedGray(x, y); }

TEST(GrayImage, Mono8IsNotCopiedAndOutlivesTheMessage) {
  sensor_msgs::ImagePtr message = fill(makeMessage(encodings::MONO8, 1, 5), 1, gray);
  const std::uint8_t* data = message->data.data();
  const GrayImage image = GrayConverter().convert(message);
  message.reset();
  ASSERT_TRUE(image.view);
  EXPECT_EQ(image.view->data, data);
  EXPECT_EQ(image.view->stride, kWidth + 5);
  expectPicture(image, 0);
}

TEST(GrayImage, ConvertsColourAndBayer) {
  GrayConverter converter;
  for (const std::string& encoding : {encodings::BGR8, encodings::RGB8}) {
    expectPicture(converter.convert(fill(makeMessage(encoding, 3, 2), 3, gray)), 1);
  }
  for (const std::string& encoding : {encodings::BGRA8, encodings::RGBA8}) {
    expectPicture(converter.convert(fill(makeMessage(encoding, 4), 4, gray)), 1);
  }
  for (const std::string& encoding : {encodings::BAYER_RGGB8, encodings::BAYER_BGGR8,
                                      encodings::BAYER_GBRG8, encodings::BAYER_GRBG8}) {
    expectPicture(converter.convert(fill(makeMessage(encoding, 1), 1, gray)), 2, 2);
  }
}

TEST(GrayImage, WeighsColoursByBrightness) {
  const auto red = [](int, int, int c) { return c == 0 ? 200 : 0; };
  const GrayImage as_rgb = GrayConverter().convert(fill(makeMessage(encodings::RGB8, 3), 3, red));
  const GrayImage as_bgr = GrayConverter().convert(fill(makeMessage(encodings::BGR8, 3), 3, red));
  ASSERT_TRUE(as_rgb.view && as_bgr.view);
  EXPECT_NEAR(as_rgb.view->data[0], 0.299 * 200, 1.0);
  EXPECT_NEAR(as_bgr.view->data[0], 0.114 * 200, 1.0);
}

TEST(GrayImage, ConvertsYuv422) {
  // Order U Y V Y.
  const auto bytes = [](int x, int y, int c) { return c == 0 ? 128 : expectedGray(x, y); };
  expectPicture(GrayConverter().convert(fill(makeMessage(encodings::YUV422, 2), 2, bytes)), 2);
}

TEST(GrayImage, ConvertsYuyvAndColoursWithoutAName) {
  const auto bytes = [](int x, int y, int c) { return c == 1 ? 128 : expectedGray(x, y); };
  expectPicture(GrayConverter().convert(fill(makeMessage("yuv422_yuy2", 2), 2, bytes)), 0);
  expectPicture(GrayConverter().convert(fill(makeMessage(encodings::TYPE_8UC3, 3), 3, gray)), 1);
  expectPicture(GrayConverter().convert(fill(makeMessage(encodings::TYPE_8UC4, 4), 4, gray)), 1);
  sensor_msgs::ImagePtr truncated = makeMessage("yuv422_yuy2", 2);
  truncated->data.resize(100);
  EXPECT_NE(GrayConverter().convert(truncated).error.find("truncated"), std::string::npos);
}

TEST(GrayImage, ScalesDeepColourAndBayerByTheirSignificantBits) {
  // A camera of 12 bits.
  const auto bytes = [](int x, int y, int c) {
    const int value = 16 * expectedGray(x, y);
    return c % 2 == 0 ? value % 256 : value / 256;
  };
  for (const std::string& encoding : {encodings::BGR16, encodings::RGB16}) {
    expectPicture(GrayConverter().convert(fill(makeMessage(encoding, 6), 6, bytes)), 1);
  }
  for (const std::string& encoding : {encodings::BAYER_RGGB16, encodings::BAYER_GBRG16}) {
    expectPicture(GrayConverter().convert(fill(makeMessage(encoding, 2), 2, bytes)), 2, 2);
  }
}

TEST(GrayImage, DecodesPicturesOf16BitsByTheirSignificantBits) {
  cv::Mat deep(kHeight, kWidth, CV_16UC1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      deep.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>(16 * expectedGray(x, y));
    }
  }
  sensor_msgs::CompressedImage message;
  message.header.stamp = ros::Time(1700000000, 123456789);
  message.format = "png";
  cv::imencode(".png", deep, message.data);
  expectPicture(GrayConverter().convert(message), 1);
}

TEST(GrayImage, ScalesMono16ByItsSignificantBits) {
  // A camera of 12 bits: the brightest pixel is close to 4095.
  const auto bytes = [](int x, int y, int c) {
    const int value = 16 * expectedGray(x, y);
    return c == 0 ? value % 256 : value / 256;
  };
  expectPicture(GrayConverter().convert(fill(makeMessage(encodings::MONO16, 2), 2, bytes)), 1);
}

TEST(GrayImage, Mono16ScaleDoesNotFlicker) {
  GrayConverter converter;
  const auto constant = [](int value) {
    return [value](int, int, int c) { return c == 0 ? value % 256 : value / 256; };
  };
  converter.convert(fill(makeMessage(encodings::MONO16, 2), 2, constant(4000)));
  const GrayImage dark =
      converter.convert(fill(makeMessage(encodings::MONO16, 2), 2, constant(500)));
  ASSERT_TRUE(dark.view);
  EXPECT_NEAR(dark.view->data[0], 500.0 * 255 / 4095, 1.0);
}

TEST(GrayImage, RefusesMalformedMessages) {
  GrayConverter converter;
  sensor_msgs::ImagePtr truncated = makeMessage(encodings::BGR8, 3);
  truncated->data.resize(truncated->data.size() - 1);
  sensor_msgs::ImagePtr narrow = makeMessage(encodings::MONO8, 1);
  narrow->step = kWidth - 1;
  const sensor_msgs::ImagePtr depth = makeMessage(encodings::TYPE_32FC1, 4);
  const sensor_msgs::ImagePtr unknown = makeMessage("h264", 1);
  const sensor_msgs::ImagePtr empty = boost::make_shared<sensor_msgs::Image>();
  const std::vector<std::pair<sensor_msgs::ImagePtr, std::string>> cases = {
      {truncated, "truncated"},
      {narrow, "truncated"},
      {depth, "32FC1"},
      {unknown, "h264"},
      {empty, "empty"}};
  for (const auto& [message, word] : cases) {
    const GrayImage image = converter.convert(message);
    EXPECT_FALSE(image.view);
    EXPECT_NE(image.error.find(word), std::string::npos) << image.error;
  }
}

sensor_msgs::CompressedImage compressed(const std::string& extension) {
  cv::Mat picture(kHeight, kWidth, CV_8UC1);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      picture.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(expectedGray(x, y));
    }
  }
  sensor_msgs::CompressedImage message;
  message.header.stamp = ros::Time(1700000000, 123456789);
  message.format = extension.substr(1);
  cv::imencode(extension, picture, message.data);
  return message;
}

TEST(GrayImage, DecodesCompressedImages) {
  expectPicture(GrayConverter().convert(compressed(".png")), 0);
  expectPicture(GrayConverter().convert(compressed(".jpg")), 4);
}

TEST(GrayImage, RefusesDamagedCompressedImages) {
  GrayConverter converter;
  sensor_msgs::CompressedImage truncated = compressed(".jpg");
  truncated.data.resize(truncated.data.size() / 2);
  EXPECT_NE(converter.convert(truncated).error.find("truncated"), std::string::npos);
  sensor_msgs::CompressedImage garbage;
  garbage.data.assign(100, 7);
  EXPECT_NE(converter.convert(garbage).error.find("decoded"), std::string::npos);
  EXPECT_NE(converter.convert(sensor_msgs::CompressedImage()).error.find("empty"),
            std::string::npos);
}

TEST(GrayImage, FormatsThatNoCameraSendsAreNotDecoded) {
  sensor_msgs::CompressedImage radiance;
  const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n";
  radiance.data.assign(head.begin(), head.end());
  radiance.data.resize(head.size() + 4, 100);
  EXPECT_NE(GrayConverter().convert(radiance).error.find("no JPEG, PNG"), std::string::npos);
  for (const char* extension : {".bmp", ".pgm", ".tiff", ".webp"}) {
    expectPicture(GrayConverter().convert(compressed(extension)), 4);
  }
}

/// Writes a number of so many bytes, the most significant first.
void overwrite(std::size_t at, std::size_t bytes, std::uint32_t value,
               std::vector<std::uint8_t>* data) {
  for (std::size_t i = 0; i < bytes; ++i) {
    data->at(at + i) = static_cast<std::uint8_t>(value >> 8 * (bytes - 1 - i));
  }
}

// A few bytes may claim gigabytes of pixels.
TEST(GrayImage, RefusesPicturesThatClaimImpossibleSizes) {
  sensor_msgs::CompressedImage png = compressed(".png");
  overwrite(16, 4, 32768, &png.data);
  overwrite(20, 4, 32768, &png.data);
  EXPECT_NE(GrayConverter().convert(png).error.find("32768x32768"), std::string::npos);
  sensor_msgs::CompressedImage jpeg = compressed(".jpg");
  const std::array<std::uint8_t, 2> start_of_frame = {0xFF, 0xC0};
  const auto frame =
      std::search(jpeg.data.begin(), jpeg.data.end(), start_of_frame.begin(), start_of_frame.end());
  ASSERT_NE(frame, jpeg.data.end());
  overwrite(static_cast<std::size_t>(frame - jpeg.data.begin()) + 5, 4, 0xFFFFFFFF, &jpeg.data);
  EXPECT_NE(GrayConverter().convert(jpeg).error.find("65535x65535"), std::string::npos);
  sensor_msgs::CompressedImage bmp = compressed(".bmp");
  overwrite(18, 4, 0x00800000, &bmp.data);  // its numbers have the least significant byte first
  overwrite(22, 4, 0x0080FFFF, &bmp.data);
  EXPECT_NE(GrayConverter().convert(bmp).error.find("32768x32768"), std::string::npos);
}

TEST(GrayImage, RefusesImpossibleSizesOfHeadsAlone) {
  using namespace std::string_literals;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"BM"s + std::string(12, '\0') + "\x0C\0\0\0\xFF\xFF\xFF\xFF"s + std::string(8, '\0'),
       "65535x65535"},
      {"P5\n# a comment\n40000 # another\n40000\n255\n", "40000x40000"},
      {"RIFF\0\0\0\0WEBPVP8X\x0A\0\0\0\0\0\0\0\xFF\xFF\xFF\xFF\xFF\xFF"s, "16777216x16777216"},
      {"RIFF\0\0\0\0WEBPVP8L\x0A\0\0\0\x2F\xFF\xFF\xFF\x0F\0\0\0\0\0"s, "16384x16384"},
      {"RIFF\0\0\0\0WEBPVP8 \x0A\0\0\0\0\0\0\x9D\x01\x2A\xFF\x3F\xFF\x3F"s, "16383x16383"}};
  for (const auto& [head, size] : cases) {
    sensor_msgs::CompressedImage message;
    message.data.assign(head.begin(), head.end());
    EXPECT_NE(GrayConverter().convert(message).error.find("claims the size " + size),
              std::string::npos)
        << size << ": " << GrayConverter().convert(message).error;
  }
}

TEST(GrayImage, ThePreviewOfAJpegIsNotTakenForItsEnd) {
  cv::Mat noise(48, 64, CV_8UC1);
  cv::randu(noise, 0, 255);
  sensor_msgs::CompressedImage message;
  cv::imencode(".jpg", noise, message.data);
  const std::vector<std::uint8_t> preview = {0xFF, 0xE1, 0, 6, 0xFF, 0xD9, 0, 0};
  message.data.insert(message.data.begin() + 2, preview.begin(), preview.end());
  EXPECT_TRUE(GrayConverter().convert(message).view);
  message.data.resize(message.data.size() / 2);
  EXPECT_NE(GrayConverter().convert(message).error.find("truncated"), std::string::npos);
}

}  // namespace
}  // namespace camera_self_calibration
