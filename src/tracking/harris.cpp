#include "camera_self_calibration/tracking/harris.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "camera_self_calibration/base/cpu_clones.h"

namespace camera_self_calibration {
namespace {

constexpr float kHarris = 0.04f;
constexpr float kRelativeThreshold = 1e-3f;  // Of a strong response: about 1/6 of its contrast.
constexpr double kStrongShare = 0.02;        // Of the local maxima count as strong.
constexpr float kScharr = 1.0f / 32.0f;      // Of sums of the kernel, to gray per pixel.
constexpr float kMinResponse = 4.0f;         // [gray^4/px^4] Below lies the noise of any camera.
constexpr std::array<float, 3> kBinomial = {6 / 16.0f, 4 / 16.0f, 1 / 16.0f};  // Centre first.
constexpr int kBlock = 32;  // Pixels side by side.

// Products of a row's derivatives (Scharr), from it and the rows beside it.
SELFCAL_CPU_CLONES void multiply(const std::uint8_t* above, const std::uint8_t* row,
                                 const std::uint8_t* below, int width, float* __restrict xx,
                                 float* __restrict xy, float* __restrict yy) {
  for (int x = 0; x < width; ++x) {
    const int left = 3 * (above[x - 1] + below[x - 1]) + 10 * row[x - 1];
    const int right = 3 * (above[x + 1] + below[x + 1]) + 10 * row[x + 1];
    const int down = 3 * (below[x - 1] - above[x - 1] + below[x + 1] - above[x + 1]) +
                     10 * (below[x] - above[x]);
    const float dx = kScharr * static_cast<float>(right - left);
    const float dy = kScharr * static_cast<float>(down);
    xx[x] = dx * dx;
    xy[x] = dx * dy;
    yy[x] = dy * dy;
  }
}

// Of five values, the third in the middle.
SELFCAL_CPU_CLONES void smooth(const float* a, const float* b, const float* c, const float* d,
                               const float* e, int count, float* __restrict out) {
  for (int i = 0; i < count; ++i) {
    out[i] = kBinomial[2] * (a[i] + e[i]) + kBinomial[1] * (b[i] + d[i]) + kBinomial[0] * c[i];
  }
}

SELFCAL_CPU_CLONES void cornerness(const float* xx, const float* xy, const float* yy, int width,
                                   float* __restrict out) {
  for (int x = 0; x < width; ++x) {
    const float trace = xx[x] + yy[x];
    out[x] = xx[x] * yy[x] - xy[x] * xy[x] - kHarris * trace * trace;
  }
}

// Whether each value of a row is a maximum among its neighbours, without a branch: vectorises.
SELFCAL_CPU_CLONES bool markMaxima(const float* row, const float* above, const float* below,
                                   int count, int* __restrict marks) {
  int any = 0;
  for (int x = 0; x < count; ++x) {
    const float c = row[x];
    const float before =
        std::max(std::max(row[x - 1], above[x]), std::max(above[x - 1], above[x + 1]));
    const float after =
        std::max(std::max(row[x + 1], below[x]), std::max(below[x - 1], below[x + 1]));
    marks[x] = (c >= kMinResponse) & (c > before) & (c >= after);
    any |= marks[x];
  }
  return any != 0;
}

}  // namespace

const std::vector<Corner>& HarrisDetector::detect(const ImagePyramid& image, int border, int cell) {
  corners_.clear();
  ordered_.clear();
  const cv::Size size = image.size();
  if (std::min(size.width, size.height) <= 2 * std::max(border, kTaps)) return ordered_;
  respond(image.level(0));
  findMaxima(std::max(border, kTaps));
  order(cell);
  return ordered_;
}

// The image goes on beyond its edges.
void HarrisDetector::smoothedRow(const cv::Mat& image, int y) {
  const int width = image.cols;
  const auto stride = static_cast<std::ptrdiff_t>(image.step);
  const std::uint8_t* row = image.data + y * stride;
  float* xx = products_.data();
  float* xy = xx + width;
  float* yy = xy + width;
  multiply(row - stride, row, row + stride, width, xx, xy, yy);
  // One pass over the three rows; what crosses from one to the next lies in the border.
  const float* in = products_.data() + 2;
  smooth(in - 2, in - 1, in, in + 1, in + 2, 3 * width - 4,
         smoothed_[static_cast<std::size_t>(y % kTaps)].data() + 2);
}

void HarrisDetector::respond(const cv::Mat& image) {
  const int width = image.cols;
  const std::size_t length = 3 * static_cast<std::size_t>(width);
  response_.create(image.size(), CV_32FC1);
  products_.resize(length);
  for (std::vector<float>& row : smoothed_) row.resize(length);
  for (int y = 0; y < image.rows; ++y) {
    smoothedRow(image, y);
    if (y < kTaps - 1) continue;
    std::array<const float*, kTaps> r;
    for (int k = 0; k < kTaps; ++k) {
      r[static_cast<std::size_t>(k)] =
          smoothed_[static_cast<std::size_t>((y - kTaps + 1 + k) % kTaps)].data();
    }
    float* sum = products_.data();
    smooth(r[0], r[1], r[2], r[3], r[4], static_cast<int>(length), sum);
    cornerness(sum, sum + width, sum + 2 * width, width, response_.ptr<float>(y - kTaps / 2));
  }
}

void HarrisDetector::findMaxima(int border) {
  std::array<int, kBlock> marks;
  const int end = response_.cols - border;
  for (int y = border; y < response_.rows - border; ++y) {
    const float* row = response_.ptr<float>(y);
    for (int x = border; x < end; x += kBlock) {
      const int count = std::min(kBlock, end - x);
      if (!markMaxima(row + x, response_.ptr<float>(y - 1) + x, response_.ptr<float>(y + 1) + x,
                      count, marks.data())) {
        continue;
      }
      for (int k = 0; k < count; ++k) {
        if (marks[static_cast<std::size_t>(k)] != 0) corners_.push_back({x + k, y, row[x + k]});
      }
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
  begin_.assign(corners_.size() + 1, 0);
  for (const Corner& corner : corners_) {
    const std::size_t in = static_cast<std::size_t>(corner.y / cell * columns + corner.x / cell);
    round_.push_back(in_cell_[in]++);
    ++begin_[round_.back() + 1];
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  ordered_.resize(corners_.size());
  for (std::size_t i = 0; i < corners_.size(); ++i) ordered_[begin_[round_[i]]++] = corners_[i];
}

}  // namespace camera_self_calibration
