#pragma once

#include <opencv2/core/utility.hpp>

namespace camera_self_calibration {

/// So many parts of the tracks are worked on at a time, where OpenCV has as many threads.
constexpr int kStripes = 2;

/// Calls `work(stripe, begin, end)` for the parts of [0, count). Parts must not touch what is
/// another's; the result then does not depend on the number of threads.
template <typename Work>
void inStripes(int count, const Work& work) {
  const auto run = [&](const cv::Range& stripes) {
    for (int s = stripes.start; s < stripes.end; ++s) {
      work(s, count * s / kStripes, count * (s + 1) / kStripes);
    }
  };
  cv::parallel_for_(cv::Range(0, kStripes), run, kStripes);
}

}  // namespace camera_self_calibration
