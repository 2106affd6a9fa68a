#pragma once

#include <opencv2/core/utility.hpp>
#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace camera_self_calibration {

/// So many parts of the tracks are worked on at a time, where OpenCV has as many threads.
constexpr int kStripes = 2;

// ThreadSanitizer does not see how OpenCV's threads wait for each other and would take each part
// for a race with what comes before and after. It is told, and still sees races between parts.
#if defined(__SANITIZE_THREAD__)
inline void happensBefore(const char& moment) { __tsan_release(const_cast<char*>(&moment)); }
inline void happensAfter(const char& moment) { __tsan_acquire(const_cast<char*>(&moment)); }
#else
inline void happensBefore(const char& /*moment*/) {}
inline void happensAfter(const char& /*moment*/) {}
#endif

/// The parts of [0, count) as OpenCV takes them.
template <typename Work>
class Stripes : public cv::ParallelLoopBody {
 public:
  Stripes(int count, const Work& work) : count_(count), work_(work) {}

  void operator()(const cv::Range& stripes) const override {
    happensAfter(begin_);
    for (int s = stripes.start; s < stripes.end; ++s) {
      work_(s, count_ * s / kStripes, count_ * (s + 1) / kStripes);
    }
    happensBefore(end_);
  }

  void run() const {
    happensBefore(begin_);
    cv::parallel_for_(cv::Range(0, kStripes), *this, kStripes);
    happensAfter(end_);
  }

 private:
  const int count_;
  const Work& work_;
  const char begin_ = 0;  // moments: only their addresses matter
  const char end_ = 0;
};

/// Calls `work(stripe, begin, end)` for the parts of [0, count). Parts must not touch what is
/// another's; the result then does not depend on the number of threads.
template <typename Work>
void inStripes(int count, const Work& work) {
  Stripes<Work>(count, work).run();
}

}  // namespace camera_self_calibration
