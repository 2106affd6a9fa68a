// The whole system on rendered video: frames per second, time of each frame, share of a core at
// 30 Hz, memory. Prints one JSON object. Arguments: seconds of video (default 20); a part of the
// names of the runs to do, such as "640x480 raw inline" (default: all).

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/simulation/simulated_sequence.h"

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

double peakMegabytes() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

struct Video {
  std::vector<SimulatedFrame> frames;
  std::vector<std::vector<unsigned char>> jpegs;
};

Video render(int width, int height, double duration_s) {
  SequenceOptions options;
  options.lens.camera = Camera::defaultGuess(CameraModel::kFov, width, height);
  options.duration_s = duration_s;
  const SimulatedSequence sequence(options);
  Video video;
  for (int i = 0; i < sequence.size(); ++i) {
    video.frames.push_back(sequence.frame(i));
    video.jpegs.emplace_back();
    cv::imencode(".jpg", video.frames.back().image, video.jpegs.back());
  }
  return video;
}

struct Run {
  double fps = 0.0;
  double cpu_seconds = 0.0;  // in all
  double wall_seconds = 0.0;
  long keyframes = 0;
  long dropped = 0;
  std::vector<double> frame_ms;  // after hand-over
  CalibrationReport report;
};

struct RunOptions {
  SelfCalibrator::Mode mode = SelfCalibrator::Mode::kInline;
  bool jpeg = false;
  double rate_hz = 0.0;  // live; 0: as fast as it goes
};

ImageView viewOf(const Video& video, std::size_t i, bool jpeg) {
  if (!jpeg) return video.frames[i].view();
  SimulatedFrame decoded;
  decoded.image = cv::imdecode(video.jpegs[i], cv::IMREAD_GRAYSCALE);
  decoded.stamp_ns = video.frames[i].stamp_ns;
  return decoded.view();
}

Run run(const Video& video, const RunOptions& run_options) {
  Run result;
  bool handed_over = false;
  Callbacks callbacks;
  callbacks.frame = [&](const FrameResult& frame) {
    result.keyframes += frame.is_keyframe ? 1 : 0;
    if (handed_over) result.frame_ms.push_back(1e3 * frame.processing_seconds);
    handed_over = handed_over || frame.calibration_revision > 0;
  };
  Options options;
  // As fast as it goes: nothing is dropped.
  options.max_queued_images =
      run_options.rate_hz > 0.0 ? 2 : static_cast<int>(video.frames.size()) + 1;
  const double cpu_before = cpuSeconds();
  const Clock::time_point begin = Clock::now();
  {
    SelfCalibrator calibrator(options, run_options.mode, callbacks);
    for (std::size_t i = 0; i < video.frames.size(); ++i) {
      if (run_options.rate_hz > 0.0) {
        std::this_thread::sleep_until(
            begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(
                        static_cast<double>(i) / run_options.rate_hz)));
      }
      calibrator.process(viewOf(video, i, run_options.jpeg));
    }
    calibrator.flush();
    result.report = calibrator.calibration();
    result.dropped = calibrator.droppedImages();
  }
  result.wall_seconds = secondsSince(begin);
  result.cpu_seconds = cpuSeconds() - cpu_before;
  result.fps = static_cast<double>(video.frames.size()) / result.wall_seconds;
  return result;
}

double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

void print(const std::string& name, std::size_t frames, const Run& run, bool* first) {
  std::printf(
      "%s\n  {\"name\": \"%s\", \"frames\": %zu, \"fps\": %.1f, \"cpu_seconds\": %.3f, "
      "\"wall_seconds\": %.3f, \"keyframes\": %ld, \"dropped\": %ld, \"state\": \"%s\", "
      "\"p50_ms\": %.2f, \"p95_ms\": %.2f, \"p99_ms\": %.2f, \"max_ms\": %.2f}",
      *first ? "" : ",", name.c_str(), frames, run.fps, run.cpu_seconds, run.wall_seconds,
      run.keyframes, run.dropped, toString(run.report.state).c_str(), percentile(run.frame_ms, 0.5),
      percentile(run.frame_ms, 0.95), percentile(run.frame_ms, 0.99),
      percentile(run.frame_ms, 1.0));
  std::fflush(stdout);
  *first = false;
}

struct NamedRun {
  std::string name;
  RunOptions options;
};

std::vector<NamedRun> runsOf(const std::string& size, const std::string& wanted) {
  std::vector<NamedRun> runs;
  for (const bool jpeg : {false, true}) {
    const std::string kind = size + (jpeg ? " jpeg" : " raw");
    runs.push_back({kind + " inline", {SelfCalibrator::Mode::kInline, jpeg, 0.0}});
    runs.push_back({kind + " threaded", {SelfCalibrator::Mode::kThreaded, jpeg, 0.0}});
    runs.push_back({kind + " live 30 Hz", {SelfCalibrator::Mode::kThreaded, jpeg, 30.0}});
  }
  const auto other = [&](const NamedRun& r) { return r.name.find(wanted) == std::string::npos; };
  runs.erase(std::remove_if(runs.begin(), runs.end(), other), runs.end());
  return runs;
}

void runAll(double duration_s, const std::string& wanted) {
  bool first = true;
  std::printf("{\"runs\": [");
  for (const auto& [width, height] : {std::pair<int, int>{640, 480}, {1280, 720}}) {
    const std::string size = std::to_string(width) + "x" + std::to_string(height);
    const std::vector<NamedRun> runs = runsOf(size, wanted);
    if (runs.empty()) continue;
    const Video video = render(width, height, duration_s);
    for (const NamedRun& named : runs) {
      print(named.name, video.frames.size(), run(video, named.options), &first);
    }
  }
  std::printf("\n], \"peak_megabytes\": %.0f}\n", peakMegabytes());
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  camera_self_calibration::runAll(argc > 1 ? std::atof(argv[1]) : 20.0, argc > 2 ? argv[2] : "");
  return 0;
}
