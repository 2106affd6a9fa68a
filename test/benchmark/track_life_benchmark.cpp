// How long tracks live on stored video, beside OpenCV's Lucas-Kanade of the same features. Corners
// are detected in every image, so that the tracker is judged alone.
//
//   track_life_benchmark [--topic T] [--calibration FILE --poses TUM] BAG|FOLDER|VIDEO...
//
// With a calibration and the camera's poses, errors too: the distance from the epipolar line [px].
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "benchmark/epipolar_errors.h"
#include "benchmark/klt_tracker.h"
#include "camera_self_calibration/tools/image_source.h"
#include "camera_self_calibration/tracking/tracker.h"

namespace camera_self_calibration {
namespace {

// Processor time of all threads [s].
double processSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Arguments {
  std::string topic, calibration, poses;
  std::vector<std::string> inputs;
};

/// The lives of one tracker's tracks.
class Lives {
 public:
  void begin(const Track& track) { images_[track.id]; }
  void follow(const std::vector<Track>& tracks) {
    for (const Track& track : tracks) ++images_[track.id];
    followed_ += static_cast<double>(tracks.size());
  }
  double mean() const { return followed_ / static_cast<double>(images_.size()); }
  double endedAtOnce() const {
    const auto none = std::count_if(images_.begin(), images_.end(),
                                    [](const auto& life) { return life.second == 0; });
    return static_cast<double>(none) / static_cast<double>(images_.size());
  }
  double tracksAnImage(int images) const { return followed_ / images; }

 private:
  std::map<std::int64_t, int> images_;  // in which a track was followed
  double followed_ = 0.0;
};

struct Contender {
  const char* name;
  Lives lives = {};
  double seconds = 0.0;  // of processor time
  std::unique_ptr<EpipolarErrors> errors = {};

  void see(std::int64_t stamp_ns, const std::vector<Track>& followed,
           const std::vector<Track>& begun) {
    lives.follow(followed);
    for (const Track& track : begun) lives.begin(track);
    if (!errors) return;
    errors->add(stamp_ns, followed);
    errors->add(stamp_ns, begun);
  }
};

void print(const std::string& input, const std::string& topic, const Contender& contender,
           int images) {
  const std::size_t slash = input.find_last_of('/') + 1;  // npos + 1 is 0
  const std::string name = input.substr(slash) + (topic.empty() ? "" : ", " + topic);
  std::printf("| %s | %s | %.2f | %.1f %% | %.1f | %.2f |", name.c_str(), contender.name,
              contender.lives.mean(), 100.0 * contender.lives.endedAtOnce(),
              contender.lives.tracksAnImage(images), 1e3 * contender.seconds / images);
  if (contender.errors) {
    std::printf(" %.3f | %.2f %% | %.2f |", contender.errors->median(),
                100.0 * contender.errors->outlierShare(), contender.errors->rmsZ());
  }
  std::printf("\n");
}

void judge(const Arguments& arguments, const std::string& input) {
  SourceOptions options;
  options.path = input;
  options.topic = arguments.topic;
  ImageSource source = openImages(options);
  Contender ours{"registered"}, klt{"KLT"};
  if (!arguments.calibration.empty()) {
    for (Contender* contender : {&ours, &klt}) {
      contender->errors = std::make_unique<EpipolarErrors>(arguments.calibration, arguments.poses);
    }
  }
  const TrackerOptions tracker_options;
  Tracker tracker(tracker_options);
  KltTracker klt_tracker(tracker_options.max_features);
  int images = 0;
  while (const auto image = source.next()) {
    if (!image->view) throw std::runtime_error(input + ": " + image->error);
    ++images;
    const std::int64_t stamp_ns = image->view->stamp_ns;
    double begin = processSeconds();
    const std::vector<Track> followed = tracker.track(*image->view).tracks;
    const std::vector<Track> begun = tracker.detect();
    ours.seconds += processSeconds() - begin;
    ours.see(stamp_ns, followed, begun);
    begin = processSeconds();
    const std::vector<Track> flowed = klt_tracker.track(*image->view);
    klt.seconds += processSeconds() - begin;
    klt.see(stamp_ns, flowed, klt_tracker.begun());
  }
  if (images == 0) throw std::runtime_error(input + " holds no images");
  print(input, arguments.topic, ours, images);
  print(input, arguments.topic, klt, images);
}

Arguments read(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const bool has_value = i + 1 < argc;
    if (argument == "--topic" && has_value) {
      arguments.topic = argv[++i];
    } else if (argument == "--calibration" && has_value) {
      arguments.calibration = argv[++i];
    } else if (argument == "--poses" && has_value) {
      arguments.poses = argv[++i];
    } else if (argument.rfind("--", 0) == 0) {
      throw std::runtime_error("unknown option, or one without its value: " + argument);
    } else {
      arguments.inputs.push_back(argument);
    }
  }
  if (arguments.inputs.empty() || arguments.calibration.empty() != arguments.poses.empty()) {
    throw std::runtime_error(
        "usage: track_life_benchmark [--topic T] [--calibration FILE --poses TUM] "
        "BAG|FOLDER|VIDEO...");
  }
  return arguments;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  try {
    const Arguments arguments = read(argc, argv);
    const bool errors = !arguments.calibration.empty();
    std::printf(
        "| video | tracker | mean life [images] | ended at once | tracks an image | ms an image "
        "|%s\n",
        errors ? " median error [px] | off by more than 1 px | rms z of the others |" : "");
    std::printf("|---|---|---|---|---|---|%s\n", errors ? "---|---|---|" : "");
    for (const std::string& input : arguments.inputs) judge(arguments, input);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "track_life_benchmark: %s\n", error.what());
    return 1;
  }
  return 0;
}
