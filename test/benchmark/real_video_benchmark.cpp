// The whole system on stored video: images a second inline, and the time of each image, threaded,
// when they come at the camera's own rate. Starting up counts. Prints one JSON object.
//
//   real_video_benchmark [--model radtan] BAG|FOLDER|VIDEO[,TOPIC]...
#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include "benchmark/pipeline_run.h"
#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/tools/image_source.h"

namespace camera_self_calibration {
namespace {

struct Video {
  std::string name;
  std::vector<ImageView> images;
  double rate_hz = 0.0;
};

Video load(const std::string& argument) {
  const std::size_t comma = argument.find(',');
  SourceOptions options;
  options.path = argument.substr(0, comma);
  if (comma != std::string::npos) options.topic = argument.substr(comma + 1);
  ImageSource source = openImages(options);
  Video video;
  video.name = argument.substr(argument.find_last_of('/', comma) + 1);
  while (const auto image = source.next()) {
    if (image->view) video.images.push_back(*image->view);
  }
  std::vector<double> intervals;
  for (std::size_t i = 1; i < video.images.size(); ++i) {
    intervals.push_back(toSeconds(video.images[i].stamp_ns - video.images[i - 1].stamp_ns));
  }
  const double interval = median(intervals, 0.0);
  if (!(interval > 0.0)) throw std::runtime_error(argument + " holds no video");
  video.rate_hz = 1.0 / interval;
  return video;
}

void judge(const std::string& argument, CameraModel model, bool first) {
  const Video video = load(argument);
  const auto image = [&](int i) { return video.images[static_cast<std::size_t>(i)]; };
  const int count = static_cast<int>(video.images.size());
  PipelineRunOptions options;
  options.model = model;
  options.count_startup = true;
  std::printf("%s  {\"rate_hz\": %.2f, \"inline\": ", first ? "" : ",\n", video.rate_hz);
  printRun(video.name, runPipeline(options, count, image));
  options.mode = SelfCalibrator::Mode::kThreaded;
  options.rate_hz = video.rate_hz;
  std::printf(", \"live\": ");
  printRun(video.name, runPipeline(options, count, image));
  std::printf("}");
}

void judgeAll(int argc, char** argv) {
  CameraModel model = CameraModel::kRadtan;
  std::vector<std::string> inputs;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--model" && i + 1 < argc) {
      const auto named = cameraModelFromString(argv[++i]);
      if (!named) throw std::runtime_error(std::string("no lens model is called ") + argv[i]);
      model = *named;
    } else {
      inputs.push_back(argument);
    }
  }
  if (inputs.empty()) {
    throw std::runtime_error("usage: real_video_benchmark [--model radtan] BAG[,TOPIC]...");
  }
  std::printf("{\"videos\": [\n");
  for (std::size_t i = 0; i < inputs.size(); ++i) judge(inputs[i], model, i == 0);
  std::printf("\n]}\n");
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  try {
    camera_self_calibration::judgeAll(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "real_video_benchmark: %s\n", error.what());
    return 1;
  }
  return 0;
}
