#include "benchmark/process_cost.h"

#include <malloc.h>

#include <ctime>

namespace camera_self_calibration {

double threadCpuSeconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double heapBytes() {
#if __GLIBC_PREREQ(2, 33)
  const struct mallinfo2 info = mallinfo2();
#else
  const struct mallinfo info = mallinfo();
#endif
  return static_cast<double>(info.uordblks) + static_cast<double>(info.hblkhd);
}

}  // namespace camera_self_calibration
