#pragma once

#include <sensor_msgs/Image.h>

#include <cstdint>
#include <random>
#include <vector>

namespace camera_self_calibration {

/// Blocks of random brightness: corners to track in an image that is always the same.
inline sensor_msgs::Image picture(double seconds, std::uint32_t width = 320,
                                  std::uint32_t height = 240) {
  sensor_msgs::Image image;
  image.header.stamp = ros::Time(seconds);
  image.header.frame_id = "camera";
  image.encoding = "mono8";
  image.width = width;
  image.height = height;
  image.step = width;
  constexpr std::uint32_t kBlock = 16;
  std::mt19937 random(1);
  std::vector<std::uint8_t> blocks((width / kBlock + 1) * (height / kBlock + 1));
  for (std::uint8_t& block : blocks) block = static_cast<std::uint8_t>(random() % 256);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      image.data.push_back(blocks[y / kBlock * (width / kBlock + 1) + x / kBlock]);
    }
  }
  return image;
}

}  // namespace camera_self_calibration
