#pragma once

#include <algorithm>
#include <functional>
#include <thread>
#include <vector>

namespace camera_self_calibration {

/// Calls `work(i)` for i in [0, count) from up to `threads` threads (the caller's among them).
/// Which thread takes which index is fixed, and results that each call keeps to its own index do
/// not depend on the number of threads. `work` must not throw.
inline void parallelFor(int threads, int count, const std::function<void(int)>& work) {
  threads = std::min(threads, count);
  const auto stride = [&](int first) {
    for (int i = first; i < count; i += threads) work(i);
  };
  if (threads <= 1) {
    for (int i = 0; i < count; ++i) work(i);
    return;
  }
  std::vector<std::thread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back(stride, t);
  stride(0);
  for (std::thread& other : others) other.join();
}

}  // namespace camera_self_calibration
