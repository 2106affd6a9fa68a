#include "camera_self_calibration/tracking/harris.h"

#include <algorithm>
#include <numeric>

namespace camera_self_calibration {
namespace {

constexpr float kHarris = 0.04f;
constexpr float kRelativeThreshold = 1e-3f;  // Of a strong response: about 1/6 of its contrast.
constexpr double kStrongShare = 0.02;        // Of the local maxima count as strong.
constexpr float kScharr = 1.0f / 32.0f;      // Of OpenCV's derivatives, to gray per pixel.
constexpr float kMinResponse = 4.0f;         // [gray^4/px^4] Below lies the noise of any camera.
constexpr std::array<float, 5> kBinomial = {1 / 16.0f, 4 / 16.0f, 6 / 16.0f, 4 / 16.0f, 1 / 16.0f};

}  // namespace

const std::vector<Corner>& HarrisDetector::detect(const ImagePyramid& image, int border, int cell) {
  corners_.clear();
  ordered_.clear();
  const cv::Size size = image.size();
  if (std::min(size.width, size.height) <= 2 * std::max(border, kTaps)) return ordered_;
  respond(image);
  findMaxima(std::max(border, kTaps));
  order(cell);
  return ordered_;
}

void HarrisDetector::smoothedRow(const cv::Mat& derivatives, int y) {
  const int width = derivatives.cols;
  const std::int16_t* d = derivatives.ptr<std::int16_t>(y);
  float* xx = products_.data();
  float* xy = xx + width;
  float* yy = xy + width;
  for (int x = 0; x < width; ++x) {
    const float dx = kScharr * d[2 * x];
    const float dy = kScharr * d[2 * x + 1];
    xx[x] = dx * dx;
    xy[x] = dx * dy;
    yy[x] = dy * dy;
  }
  // One pass over the three rows; what crosses from one to the next lies in the border.
  const float* in = products_.data();
  float* out = smoothed_[static_cast<std::size_t>(y % kTaps)].data();
  for (int x = 2; x < 3 * width - 2; ++x) {
    out[x] = kBinomial[0] * (in[x - 2] + in[x + 2]) + kBinomial[1] * (in[x - 1] + in[x + 1]) +
             kBinomial[2] * in[x];
  }
}

void HarrisDetector::respond(const ImagePyramid& image) {
  const cv::Mat& derivatives = image.derivatives(0);
  const int width = derivatives.cols;
  const std::size_t length = 3 * static_cast<std::size_t>(width);
  response_.create(derivatives.size(), CV_32FC1);
  products_.resize(length);
  for (std::vector<float>& row : smoothed_) row.resize(length);
  for (int y = 0; y < derivatives.rows; ++y) {
    smoothedRow(derivatives, y);
    if (y < kTaps - 1) continue;
    std::array<const float*, kTaps> r;
    for (int k = 0; k < kTaps; ++k) {
      r[static_cast<std::size_t>(k)] =
          smoothed_[static_cast<std::size_t>((y - kTaps + 1 + k) % kTaps)].data();
    }
    float* sum = products_.data();
    for (std::size_t x = 0; x < length; ++x) {
      sum[x] = kBinomial[0] * (r[0][x] + r[4][x]) + kBinomial[1] * (r[1][x] + r[3][x]) +
               kBinomial[2] * r[2][x];
    }
    float* out = response_.ptr<float>(y - kTaps / 2);
    for (int x = 0; x < width; ++x) {
      const float xx = sum[x], xy = sum[width + x], yy = sum[2 * width + x];
      const float trace = xx + yy;
      out[x] = xx * yy - xy * xy - kHarris * trace * trace;
    }
  }
}

// Whether each pixel of a row is a maximum among its neighbours, without a branch: vectorises.
void HarrisDetector::markMaxima(int y, int border) {
  const float* row = response_.ptr<float>(y);
  const float* above = response_.ptr<float>(y - 1);
  const float* below = response_.ptr<float>(y + 1);
  int* marks = marks_.data();
  for (int x = border; x < response_.cols - border; ++x) {
    const float c = row[x];
    const float before =
        std::max(std::max(row[x - 1], above[x]), std::max(above[x - 1], above[x + 1]));
    const float after =
        std::max(std::max(row[x + 1], below[x]), std::max(below[x - 1], below[x + 1]));
    marks[x] = (c >= kMinResponse) & (c > before) & (c >= after);
  }
}

void HarrisDetector::findMaxima(int border) {
  marks_.resize(static_cast<std::size_t>(response_.cols));
  for (int y = border; y < response_.rows - border; ++y) {
    markMaxima(y, border);
    for (int x = border; x < response_.cols - border; ++x) {
      if (marks_[static_cast<std::size_t>(x)] == 0) continue;
      corners_.push_back({x, y, response_.ptr<float>(y)[x]});
    }
  }
}

void HarrisDetector::order(int cell) {
  const auto stronger = [](const Corner& a, const Corner& b) {
    if (a.response != b.response) return a.response > b.response;
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  };
  if (corners_.empty()) return;
  const auto strong = corners_.begin() + static_cast<std::ptrdiff_t>(
                                             kStrongShare * static_cast<double>(corners_.size()));
  std::nth_element(corners_.begin(), strong, corners_.end(), stronger);
  const float threshold = kRelativeThreshold * strong->response;
  corners_.erase(std::remove_if(corners_.begin(), corners_.end(),
                                [=](const Corner& c) { return c.response < threshold; }),
                 corners_.end());
  std::sort(corners_.begin(), corners_.end(), stronger);

  const int columns = response_.cols / cell + 1;
  in_cell_.assign(static_cast<std::size_t>(columns * (response_.rows / cell + 1)), 0);
  round_.clear();
  for (const Corner& corner : corners_) {
    round_.push_back(
        in_cell_[static_cast<std::size_t>(corner.y / cell * columns + corner.x / cell)]++);
  }
  order_.resize(round_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
    return round_[a] != round_[b] ? round_[a] < round_[b] : a < b;
  });
  for (const std::size_t i : order_) ordered_.push_back(corners_[i]);
}

}  // namespace camera_self_calibration
