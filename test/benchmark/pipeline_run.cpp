#include "benchmark/pipeline_run.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

namespace camera_self_calibration {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// Of all threads of the process.
double cpuSeconds() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

}  // namespace

PipelineRun runPipeline(const PipelineRunOptions& run_options, int frames,
                        const std::function<ImageView(int)>& frame_at) {
  PipelineRun result;
  bool handed_over = false;
  Callbacks callbacks;
  callbacks.frame = [&](const FrameResult& frame) {
    result.keyframes += frame.is_keyframe ? 1 : 0;
    if (handed_over || run_options.count_startup) {
      result.frame_ms.push_back(1e3 * frame.processing_seconds);
    }
    handed_over = handed_over || frame.calibration_revision > 0;
  };
  Options options;
  options.model = run_options.model;
  // As fast as it goes: nothing is dropped.
  options.max_queued_images = run_options.rate_hz > 0.0 ? 2 : frames + 1;
  const double cpu_before = cpuSeconds();
  const Clock::time_point begin = Clock::now();
  {
    SelfCalibrator calibrator(options, run_options.mode, callbacks);
    for (int i = 0; i < frames; ++i) {
      if (run_options.rate_hz > 0.0) {
        std::this_thread::sleep_until(begin +
                                      std::chrono::duration_cast<Clock::duration>(
                                          std::chrono::duration<double>(i / run_options.rate_hz)));
      }
      calibrator.process(frame_at(i));
    }
    calibrator.flush();
    result.report = calibrator.calibration();
    result.dropped = calibrator.droppedImages();
  }
  result.frames = frames;
  result.wall_seconds = secondsSince(begin);
  result.cpu_seconds = cpuSeconds() - cpu_before;
  result.fps = frames / result.wall_seconds;
  return result;
}

void printRun(const std::string& name, const PipelineRun& run) {
  std::printf(
      "{\"name\": \"%s\", \"frames\": %d, \"fps\": %.1f, \"cpu_seconds\": %.3f, "
      "\"wall_seconds\": %.3f, \"keyframes\": %ld, \"dropped\": %ld, \"state\": \"%s\", "
      "\"p50_ms\": %.2f, \"p95_ms\": %.2f, \"p99_ms\": %.2f, \"max_ms\": %.2f}",
      name.c_str(), run.frames, run.fps, run.cpu_seconds, run.wall_seconds, run.keyframes,
      run.dropped, toString(run.report.state).c_str(), percentile(run.frame_ms, 0.5),
      percentile(run.frame_ms, 0.95), percentile(run.frame_ms, 0.99),
      percentile(run.frame_ms, 1.0));
  std::fflush(stdout);
}

}  // namespace camera_self_calibration
