#include "camera_self_calibration/simulation/sensor.h"

#include <algorithm>
#include <cmath>

#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

constexpr std::size_t kNoiseTable = 1 << 18;

cv::Mat sensitivityOf(const SensorOptions& options, const Camera& camera) {
  const cv::Size size(camera.width(), camera.height());
  cv::Mat map(size, CV_32FC1, cv::Scalar(options.gain));
  const double cx = camera.parameters()[2];
  const double cy = camera.parameters()[3];
  const double farthest2 = std::pow(std::max(cx, size.width - 1 - cx), 2) +
                           std::pow(std::max(cy, size.height - 1 - cy), 2);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const double r2 = (std::pow(x - cx, 2) + std::pow(y - cy, 2)) / farthest2;
      map.at<float>(y, x) *= static_cast<float>(1.0 - options.vignetting * r2);
    }
  }
  return map;
}

}  // namespace

std::vector<std::string> SensorOptions::problems() const {
  std::vector<std::string> found;
  if (!(noise_sigma >= 0.0 && noise_sigma <= 100.0)) {
    found.push_back("noise_sigma must be in [0, 100]");
  }
  if (!(gain > 0.0 && gain <= 100.0)) found.push_back("gain must be in (0, 100]");
  if (!(vignetting >= 0.0 && vignetting < 1.0)) found.push_back("vignetting must be in [0, 1)");
  return found;
}

Sensor::Sensor(const SensorOptions& options, const Camera& camera)
    : options_(options), sensitivity_(sensitivityOf(options, camera)) {
  if (options.noise_sigma <= 0.0) return;
  Random random(5);
  noise_.resize(kNoiseTable);
  for (float& value : noise_) value = static_cast<float>(options.noise_sigma * random.normal());
}

cv::Mat Sensor::expose(const cv::Mat& light, std::uint64_t noise_seed, double gain) const {
  cv::Mat image(light.size(), CV_8UC1);
  const auto exposure = static_cast<float>(gain);
  const std::vector<float> silence(static_cast<std::size_t>(light.cols), 0.0f);
  for (int y = 0; y < light.rows; ++y) {
    const std::size_t places = noise_.size() - static_cast<std::size_t>(light.cols);
    const float* noise =
        noise_.empty()
            ? silence.data()
            : noise_.data() + mixSeed(noise_seed, static_cast<std::uint64_t>(y)) % places;
    const float* from = light.ptr<float>(y);
    const float* factor = sensitivity_.ptr<float>(y);
    std::uint8_t* to = image.ptr<std::uint8_t>(y);
    for (int x = 0; x < light.cols; ++x) {
      const float value = from[x] > 0.0f ? exposure * from[x] * factor[x] + noise[x] + 0.5f : 0.0f;
      to[x] = static_cast<std::uint8_t>(std::min(std::max(value, 0.0f), 255.0f));
    }
  }
  return image;
}

}  // namespace camera_self_calibration
