// The whole system on rendered video: frames per second, time of each frame, share of a core at
// 30 Hz, memory. Prints one JSON object. Arguments: seconds of video (default 20); a part of the
// names of the runs to do, such as "640x480 raw inline" (default: all).

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "benchmark/pipeline_run.h"
#include "camera_self_calibration/simulation/simulated_sequence.h"

namespace camera_self_calibration {
namespace {

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

ImageView viewOf(const Video& video, int index, bool jpeg) {
  const auto i = static_cast<std::size_t>(index);
  if (!jpeg) return video.frames[i].view();
  SimulatedFrame decoded;
  decoded.image = cv::imdecode(video.jpegs[i], cv::IMREAD_GRAYSCALE);
  decoded.stamp_ns = video.frames[i].stamp_ns;
  return decoded.view();
}

struct NamedRun {
  std::string name;
  PipelineRunOptions options;
  bool jpeg = false;
};

std::vector<NamedRun> runsOf(const std::string& size, const std::string& wanted) {
  std::vector<NamedRun> runs;
  for (const bool jpeg : {false, true}) {
    const std::string kind = size + (jpeg ? " jpeg" : " raw");
    PipelineRunOptions options;
    runs.push_back({kind + " inline", options, jpeg});
    options.mode = SelfCalibrator::Mode::kThreaded;
    runs.push_back({kind + " threaded", options, jpeg});
    options.rate_hz = 30.0;
    runs.push_back({kind + " live 30 Hz", options, jpeg});
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
      std::printf(first ? "\n  " : ",\n  ");
      first = false;
      printRun(named.name, runPipeline(named.options, static_cast<int>(video.frames.size()),
                                       [&](int i) { return viewOf(video, i, named.jpeg); }));
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
