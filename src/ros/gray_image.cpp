#include "camera_self_calibration/ros/gray_image.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include <boost/make_shared.hpp>
#include <opencv2/imgcodecs.hpp>

#include "camera_self_calibration/camera/image_size.h"
#include "camera_self_calibration/ros/stamps.h"
#include "picture_head.h"

namespace camera_self_calibration {
namespace {

namespace encodings = sensor_msgs::image_encodings;

// YUV422 of the byte order Y U Y V, which newer drivers publish; its gray is there as it is.
constexpr const char* kYuyv = "yuv422_yuy2";

GrayImage failed(std::string error) { return {std::nullopt, std::move(error)}; }

/// The matrix lives as long as the view.
GrayImage viewOf(cv::Mat gray, const ros::Time& stamp) {
  const auto owner = std::make_shared<const cv::Mat>(std::move(gray));
  return {ImageView{owner, owner->data, owner->cols, owner->rows, static_cast<int>(owner->step[0]),
                    toNanoseconds(stamp)},
          {}};
}

GrayImage viewOf(const sensor_msgs::ImageConstPtr& message) {
  const std::shared_ptr<const void> owner(message.get(), [message](const void*) {});
  return {ImageView{owner, message->data.data(), static_cast<int>(message->width),
                    static_cast<int>(message->height), static_cast<int>(message->step),
                    toNanoseconds(message->header.stamp)},
          {}};
}

std::string sizeText(const sensor_msgs::Image& message) {
  return std::to_string(message.width) + "x" + std::to_string(message.height) + " " +
         message.encoding;
}

/// Without a copy, under the encoding's proper name.
cv_bridge::CvImageConstPtr shared(const sensor_msgs::ImageConstPtr& message,
                                  const std::string& encoding) {
  if (encoding == message->encoding) return cv_bridge::toCvShare(message);
  const auto image = boost::make_shared<cv_bridge::CvImage>(*cv_bridge::toCvShare(message));
  image->encoding = encoding;
  return image;
}

/// What is wrong with the message as such, before anything reads its pixels.
std::string malformed(const sensor_msgs::Image& message) {
  if (message.width == 0 || message.height == 0) return "the image is empty (size 0)";
  if (!isImageSize(message.width, message.height)) {
    return "the image claims the size " + sizeText(message) + ", which is not plausible";
  }
  std::size_t pixel_bytes = 0;
  try {
    if (message.encoding == kYuyv) {
      pixel_bytes = 2;
    } else {
      pixel_bytes = static_cast<std::size_t>(encodings::numChannels(message.encoding)) *
                    static_cast<std::size_t>(encodings::bitDepth(message.encoding)) / 8;
    }
  } catch (const std::exception&) {
    return "the encoding '" + message.encoding + "' is not known; use mono8, bgr8 or another one";
  }
  if (message.step < message.width * pixel_bytes ||
      message.data.size() < static_cast<std::size_t>(message.step) * message.height) {
    return "the image is truncated: " + std::to_string(message.data.size()) + " bytes of " +
           std::to_string(message.step) + " a row for " + sizeText(message);
  }
  return {};
}

bool hasGray(const std::string& encoding) {
  return encodings::isMono(encoding) || encodings::isColor(encoding) ||
         encodings::isBayer(encoding) || encoding == encodings::YUV422;
}

/// What drivers without a name for the order of colours publish is OpenCV's own order.
std::string knownName(const std::string& encoding) {
  if (encoding == encodings::TYPE_8UC3) return encodings::BGR8;
  if (encoding == encodings::TYPE_8UC4) return encodings::BGRA8;
  if (encoding == encodings::TYPE_16UC3) return encodings::BGR16;
  return encoding;
}

cv::Mat luminanceOfYuyv(const sensor_msgs::Image& message) {
  // OpenCV has no matrix over constant data; it is only read.
  const cv::Mat pairs(static_cast<int>(message.height), static_cast<int>(message.width), CV_8UC2,
                      const_cast<std::uint8_t*>(message.data.data()), message.step);
  cv::Mat gray;
  cv::extractChannel(pairs, gray, 0);
  return gray;
}

std::string impossibleSize(std::int64_t width, std::int64_t height) {
  return "the compressed image claims the size " + std::to_string(width) + "x" +
         std::to_string(height) + ", which is not plausible";
}

}  // namespace

GrayImage GrayConverter::convert(const sensor_msgs::ImageConstPtr& message) {
  const std::string problem = malformed(*message);
  if (!problem.empty()) return failed(problem);
  if (message->encoding == encodings::MONO8 || message->encoding == encodings::TYPE_8UC1) {
    return viewOf(message);
  }
  try {
    if (message->encoding == encodings::MONO16 || message->encoding == encodings::TYPE_16UC1) {
      return convertMono16(message);
    }
    if (message->encoding == kYuyv) {
      return viewOf(luminanceOfYuyv(*message), message->header.stamp);
    }
    const std::string encoding = knownName(message->encoding);
    if (!hasGray(encoding)) {
      return failed("the encoding '" + message->encoding +
                    "' is no picture that can be turned gray; use mono8, bgr8 or another one");
    }
    if (encodings::bitDepth(encoding) == 16) return convertDeepColour(message, encoding);
    return viewOf(cv_bridge::cvtColor(shared(message, encoding), encodings::MONO8)->image,
                  message->header.stamp);
  } catch (const std::exception& e) {
    return failed("an image " + sizeText(*message) + " cannot be turned gray: " + e.what());
  }
}

GrayImage GrayConverter::convertMono16(const sensor_msgs::ImageConstPtr& message) {
  return viewOf(toEightBits(cv_bridge::toCvShare(message)->image), message->header.stamp);
}

GrayImage GrayConverter::convertDeepColour(const sensor_msgs::ImageConstPtr& message,
                                           const std::string& encoding) {
  cv_bridge::CvImageConstPtr image = shared(message, encoding);
  // Bayer goes by way of colour.
  if (encodings::isBayer(encoding)) image = cv_bridge::cvtColor(image, encodings::BGR16);
  image = cv_bridge::cvtColor(image, encodings::MONO16);
  return viewOf(toEightBits(image->image), message->header.stamp);
}

cv::Mat GrayConverter::toEightBits(const cv::Mat& deep) {
  double brightest = 0.0;
  cv::minMaxLoc(deep, nullptr, &brightest);
  while (significant_bits_ < 16 && brightest >= static_cast<double>(1 << significant_bits_)) {
    ++significant_bits_;
  }
  cv::Mat gray;
  deep.convertTo(gray, CV_8U, 255.0 / ((1 << significant_bits_) - 1));
  return gray;
}

GrayImage GrayConverter::convert(const sensor_msgs::CompressedImage& message) {
  if (message.data.empty()) return failed("the compressed image is empty");
  if (!isPicture(message.data)) {
    return failed("the compressed image (format '" + message.format +
                  "') cannot be decoded: it is no JPEG, PNG, BMP, PNM, TIFF or WebP picture");
  }
  if (isTruncatedJpeg(message.data)) {
    return failed("the compressed image is truncated (" + std::to_string(message.data.size()) +
                  " bytes without the mark that ends a JPEG picture)");
  }
  const std::optional<PictureSize> claimed = claimedSize(message.data);
  if (claimed && !isImageSize(claimed->width, claimed->height)) {
    return failed(impossibleSize(claimed->width, claimed->height));
  }
  try {
    // The sensor's pixels as they are: a calibration must not depend on a rotation by metadata.
    // Deep pictures stay deep, since cameras of 10 or 12 bits fill the low bits only.
    cv::Mat gray = cv::imdecode(
        message.data, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
    if (gray.empty()) {
      return failed("the compressed image (format '" + message.format + "', " +
                    std::to_string(message.data.size()) + " bytes) cannot be decoded");
    }
    if (!isImageSize(gray.cols, gray.rows)) return failed(impossibleSize(gray.cols, gray.rows));
    if (gray.depth() == CV_16U) gray = toEightBits(gray);
    if (gray.depth() != CV_8U) {
      return failed("the compressed image (format '" + message.format +
                    "') is no picture, but holds other numbers");
    }
    return viewOf(std::move(gray), message.header.stamp);
  } catch (const std::exception& e) {
    return failed(std::string("the compressed image cannot be decoded: ") + e.what());
  }
}

}  // namespace camera_self_calibration
