// Stages of the front end on rendered video of 640 x 480.

#include <benchmark/benchmark.h>

#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "camera_self_calibration/localization/sliding_window.h"
#include "camera_self_calibration/simulation/simulated_sequence.h"
#include "camera_self_calibration/tracking/flow_prediction.h"
#include "camera_self_calibration/tracking/harris.h"
#include "camera_self_calibration/tracking/patch_registration.h"
#include "camera_self_calibration/tracking/pyramid.h"
#include "camera_self_calibration/tracking/tracker.h"

namespace camera_self_calibration {
namespace {

constexpr int kFrames = 40;
constexpr int kBorder = ReferencePatch::kRawRadius + 3;
constexpr auto kUs = benchmark::kMicrosecond;

// Rendered once.
const std::vector<SimulatedFrame>& video() {
  static const std::vector<SimulatedFrame> frames = [] {
    SequenceOptions options;
    options.lens.camera = Camera::defaultGuess(CameraModel::kFov, 640, 480);
    options.duration_s = (kFrames + 1) / options.rate_hz;
    const SimulatedSequence sequence(options);
    std::vector<SimulatedFrame> list;
    for (int i = 0; i < kFrames; ++i) list.push_back(sequence.frame(i));
    return list;
  }();
  return frames;
}

// Forwards and backwards, without a jump.
const SimulatedFrame& frameAt(int i) {
  const int phase = i % (2 * kFrames - 2);
  return video()[phase < kFrames ? phase : 2 * kFrames - 2 - phase];
}

void decodeJpegToGray(benchmark::State& state) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", video()[0].image, bytes);
  for (auto _ : state) benchmark::DoNotOptimize(cv::imdecode(bytes, cv::IMREAD_GRAYSCALE));
}
BENCHMARK(decodeJpegToGray)->Unit(kUs);

void buildPyramid(benchmark::State& state) {
  ImagePyramid pyramid;
  int i = 0;
  for (auto _ : state) pyramid.build(frameAt(i++).view());
}
BENCHMARK(buildPyramid)->Unit(kUs);

// A pair of images with corners in the first.
struct Pair {
  ImagePyramid from;
  ImagePyramid to;
  std::vector<Corner> corners;

  Pair() {
    from.build(video()[0].view());
    to.build(video()[1].view());
    HarrisDetector detector;
    corners = detector.detect(from, kBorder, 49);
    if (corners.size() > 128) corners.resize(128);
  }
};

void detectHarris(benchmark::State& state) {
  const Pair pair;
  HarrisDetector detector;
  for (auto _ : state) benchmark::DoNotOptimize(detector.detect(pair.from, kBorder, 49).size());
}
BENCHMARK(detectHarris)->Unit(kUs);

void predictFlowAndBack(benchmark::State& state) {
  const Pair pair;
  std::vector<cv::Point2f> points;
  for (const Corner& corner : pair.corners) {
    points.emplace_back(static_cast<float>(corner.x), static_cast<float>(corner.y));
  }
  FlowPrediction flow;
  for (auto _ : state) {
    std::vector<cv::Point2f> predicted = points;
    flow.run(pair.from, pair.to, points, &predicted);
    benchmark::DoNotOptimize(predicted.data());
  }
  state.counters["tracks"] = static_cast<double>(points.size());
}
BENCHMARK(predictFlowAndBack)->Unit(kUs);

// Against the reference patch, started a pixel off; the time is of one track.
void registerPatch(benchmark::State& state) {
  const Pair pair;
  PatchRegistration registration;
  std::vector<ReferencePatch> patches(pair.corners.size());
  for (std::size_t i = 0; i < patches.size(); ++i) {
    patches[i].cut(pair.from.level(0), pair.corners[i].x, pair.corners[i].y);
    registration.prepare(&patches[i]);
  }
  std::size_t i = 0;
  double iterations = 0.0;
  for (auto _ : state) {
    Warp start;
    start.pixel = Eigen::Vector2d(pair.corners[i].x + 0.8, pair.corners[i].y - 0.6);
    iterations += registration.run(&patches[i], pair.from, start).iterations;
    i = (i + 1) % patches.size();
  }
  state.counters["iterations"] = benchmark::Counter(iterations, benchmark::Counter::kAvgIterations);
}
BENCHMARK(registerPatch)->Unit(kUs);

// All of it; new tracks where fewer than 90 are left.
void trackFrame(benchmark::State& state) {
  Tracker tracker{TrackerOptions()};
  int i = 0;
  double tracks = 0.0;
  for (auto _ : state) {
    const std::size_t left = tracker.track(frameAt(i++).view()).tracks.size();
    tracks += static_cast<double>(left);
    if (left < 90) tracker.detect();
  }
  state.counters["tracks"] = benchmark::Counter(tracks, benchmark::Counter::kAvgIterations);
}
BENCHMARK(trackFrame)->Unit(kUs);

void localizeFrame(benchmark::State& state) {
  const Camera camera = video()[0].camera;
  SlidingWindow window({}, camera);
  Tracker tracker{TrackerOptions()};
  for (int k = 0; k < 6; ++k) {
    TrackedFrame frame = tracker.track(video()[4 * k].view());
    const std::vector<Track> started = tracker.detect();
    frame.tracks.insert(frame.tracks.end(), started.begin(), started.end());
    Keyframe keyframe;
    keyframe.id = k;
    keyframe.world_from_camera = video()[4 * k].world_from_camera;
    window.addKeyframe(keyframe, frame.tracks);
  }
  const TrackedFrame frame = tracker.track(video()[21].view());
  for (auto _ : state) benchmark::DoNotOptimize(window.localize(frame, window.newestPose()));
  state.counters["tracks"] = static_cast<double>(frame.tracks.size());
}
BENCHMARK(localizeFrame)->Unit(kUs);

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  camera_self_calibration::video();  // not within what is timed first
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
