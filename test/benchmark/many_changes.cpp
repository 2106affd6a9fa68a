#include "benchmark/many_changes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "benchmark/changing_tracks.h"
#include "benchmark/process_cost.h"
#include "benchmark/random_lens.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kStartNs = kChangingTracksStartNs;
constexpr double kRateHz = 10.0;
constexpr int kFeatures = 60;
constexpr int kRows = 10;

// Each 3 to 30 % from the one before, between 85 and 115 % of the first.
std::vector<double> focalScales(int changes, std::uint64_t seed) {
  Random random(mixSeed(seed, 9));
  std::vector<double> scales = {1.0};
  while (static_cast<int>(scales.size()) <= changes) {
    const double scale = random.uniform(0.85, 1.15);
    if (std::abs(scale / scales.back() - 1.0) > 0.03) scales.push_back(scale);
  }
  return scales;
}

class Runner {
 public:
  Runner(int changes, double seconds, std::uint64_t seed)
      : changes_(changes),
        frames_each_(static_cast<int>(seconds * kRateHz)),
        scales_(focalScales(changes, seed)),
        camera_(randomLens(CameraModel::kFov, 640, 480, seed).camera),
        tracks_(tracksOf(seconds, seed)) {
    Options options;
    options.model = camera_.model();
    options.tracker.max_features = kFeatures;
    const double before = heapBytes();
    calibrator_ =
        std::make_unique<SelfCalibrator>(options, SelfCalibrator::Mode::kInline, callbacks());
    held_bytes_ = heapBytes() - before;
  }

  void run() {
    std::printf(
        "| changes | ms a frame | slowest | held [MB] | alarms | CONVERGED before the next | error "
        "then, worst [px rms] | LOST |\n|---|---|---|---|---|---|---|---|\n");
    const int each_row = std::max(1, changes_ / kRows);
    for (stretch_ = 0; stretch_ <= changes_; ++stretch_) {
      for (int i = 0; i < frames_each_; ++i) step();
      judge();
      if (stretch_ == 0) cpu_s_ = slowest_s_ = 0.0;  // learning the first lens is no change
      if (stretch_ > 0 && stretch_ % each_row == 0) printRow(each_row);
    }
  }

 private:
  FeatureTracks tracksOf(double seconds, std::uint64_t seed) const {
    ChangingTracks tracks;
    tracks.seed = seed;
    tracks.duration_s = (changes_ + 1) * seconds;
    tracks.features = kFeatures;
    return makeTracks(tracks, camera_, [this](double) {
      Intrinsics parameters = camera_.parameters();
      parameters.head<2>() *= scales_[static_cast<std::size_t>(stretch_)];
      Camera camera = camera_;
      camera.setParameters(parameters);
      return camera;
    });
  }

  Callbacks callbacks() {
    Callbacks result;
    result.event = [this](const Event& event) {
      alarms_ += event.type == EventType::kCalibrationChange;
      lost_ += event.type == EventType::kLost;
    };
    return result;
  }

  // What the simulator remembers of its tracks is not counted.
  void step() {
    const auto stamp = kStartNs + static_cast<std::int64_t>(1e9 * frame_++ / kRateHz);
    const TrackedFrame frame = tracks_.track(stamp);
    double simulator_bytes = 0.0;
    const auto detect = [&] {
      const double before = heapBytes();
      std::vector<Track> started = tracks_.detect();
      simulator_bytes += heapBytes() - before;
      return started;
    };
    const double bytes = heapBytes();
    const double begin = threadCpuSeconds();
    calibrator_->processTracks(frame, detect);
    const double seconds = threadCpuSeconds() - begin;
    held_bytes_ += heapBytes() - bytes - simulator_bytes;
    cpu_s_ += seconds;
    slowest_s_ = std::max(slowest_s_, seconds);
  }

  // Just before the next change.
  void judge() {
    const CalibrationReport report = calibrator_->calibration();
    if (report.state != CalibrationState::kConverged) return;
    ++converged_;
    const auto now = kStartNs + static_cast<std::int64_t>(1e9 * (frame_ - 1) / kRateHz);
    worst_px_ = std::max(worst_px_, pixelDistance(tracks_.cameraAt(now), report.camera).rms);
  }

  void printRow(int stretches) {
    std::printf("| %d | %.2f | %.0f | %.1f | %d | %d | %.2f | %d |\n", stretch_,
                1e3 * cpu_s_ / (stretches * frames_each_), 1e3 * slowest_s_,
                held_bytes_ / 1048576.0, alarms_, converged_, worst_px_, lost_);
    std::fflush(stdout);
    cpu_s_ = slowest_s_ = 0.0;
  }

  const int changes_;
  const int frames_each_;
  const std::vector<double> scales_;
  const Camera camera_;
  int stretch_ = 0;
  std::int64_t frame_ = 0;
  FeatureTracks tracks_;
  std::unique_ptr<SelfCalibrator> calibrator_;
  double cpu_s_ = 0.0;
  double slowest_s_ = 0.0;
  double held_bytes_ = 0.0;
  double worst_px_ = 0.0;
  int alarms_ = 0;
  int converged_ = 0;
  int lost_ = 0;
};

}  // namespace

void printManyChanges(int changes, double seconds, std::uint64_t seed) {
  Runner(changes, seconds, seed).run();
}

}  // namespace camera_self_calibration
