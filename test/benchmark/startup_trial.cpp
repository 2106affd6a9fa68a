#include "benchmark/startup_trial.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <vector>

#include "benchmark/trial_optimum.h"
#include "benchmark/trial_tracks.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/simulation/feature_tracks.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

constexpr double kRateHz = 15.0;
constexpr double kWatchedS = 2.0;  // after CONVERGED
constexpr std::int64_t kStartNs = 1000000000;

double cpuSeconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The system under trial, what it is fed with and what it said.
class Runner {
 public:
  explicit Runner(const StartupTrial& trial)
      : trial_(trial),
        random_(mixSeed(trial.seed, 77)),
        tracks_(makeTracks()),
        optimum_(trial.truth) {
    Options options;
    options.model = trial.truth.model();
    options.initial_camera = trial.initial;
    outcome_.threshold_px = options.convergedRms(trial.truth);
    calibrator_ =
        std::make_unique<SelfCalibrator>(options, SelfCalibrator::Mode::kInline, callbacks());
  }

  StartupOutcome run() {
    const double begin = cpuSeconds();
    const int frames = static_cast<int>((trial_.idle_s + trial_.good_s) * kRateHz);
    for (int i = 0; i < frames && !isOver(i); ++i) step(i);
    outcome_.cpu_s = cpuSeconds() - begin;
    summarize();
    return outcome_;
  }

 private:
  // A calibration that has converged is watched for a while yet.
  bool isOver(int frame) const {
    return outcome_.converged_s >= 0.0 && frame > (outcome_.converged_s + kWatchedS) * kRateHz;
  }

  FeatureTracks makeTracks() {
    TrialScene scene =
        makeScene(trial_.scene, trial_.good_s, trial_.idle, trial_.idle_s, trial_.seed);
    return FeatureTracks(std::move(scene.world), Lens{trial_.truth, std::nullopt, 1.0},
                         std::move(scene.trajectory), trialTracks(trial_.seed, kStartNs, &random_));
  }

  Callbacks callbacks() {
    Callbacks result;
    result.frame = [this](const FrameResult& frame) { is_keyframe_ = frame.is_keyframe; };
    result.calibration = [this](const CalibrationReport& report) { watch(report); };
    result.event = [this](const Event& event) { watch(event); };
    return result;
  }

  bool isFalse(const CalibrationReport& report) const {
    const double error = pixelDistance(trial_.truth, report.camera).rms;
    return error > convergedRms(0.0, trial_.truth) &&
           (error > 5.0 * report.uncertainty.rms || worstSigmas(report) > 5.0);
  }

  double worstSigmas(const CalibrationReport& report) const {
    double worst = 0.0;
    for (int i = 0; i < report.covariance.rows(); ++i) {
      const double truth = i < trial_.truth.parameterCount() ? trial_.truth.parameters()(i) : 0.0;
      worst = std::max(worst, std::abs(report.camera.parameters()(i) - truth) /
                                  std::sqrt(report.covariance(i, i)));
    }
    return worst;
  }

  void watch(const CalibrationReport& report) {
    report_ = report;
    ++outcome_.keyframes;
    if (report.state == CalibrationState::kConverged && isFalse(report)) {
      outcome_.false_converged = true;
    }
  }

  void watch(const Event& event) {
    const double time = toSeconds(event.stamp_ns - kStartNs);
    if (event.type == EventType::kHandover) outcome_.handover_s = time;
    if (event.type == EventType::kConverged) outcome_.converged_s = time;
    if (event.type == EventType::kLost) outcome_.lost = true;
  }

  void step(int index) {
    const std::int64_t stamp = kStartNs + static_cast<std::int64_t>(1e9 * index / kRateHz);
    const bool idle = index < trial_.idle_s * kRateHz;
    const bool blind = idle && trial_.idle == Idle::kNoTexture;
    if (blind) tracks_.reset();
    const TrackedFrame frame = tracks_.track(stamp);  // a copy: detect() may be called inside
    TrackedFrame whole = frame;
    const auto detect = [&] {
      const std::vector<Track> started = blind ? std::vector<Track>() : tracks_.detect();
      whole.tracks.insert(whole.tracks.end(), started.begin(), started.end());
      return started;
    };
    const int keyframes_before = outcome_.keyframes;
    const double begin = cpuSeconds();
    calibrator_->processTracks(frame, detect);
    const double seconds = cpuSeconds() - begin;
    if (!idle && is_keyframe_) optimum_.addKeyframe(whole, tracks_);
    if (idle && outcome_.keyframes > keyframes_before) idle_seconds_.push_back(seconds);
  }

  void summarize() {
    outcome_.state = toString(report_.state);
    outcome_.stated_px = report_.uncertainty.rms;
    outcome_.error_px = pixelDistance(trial_.truth, report_.camera).rms;
    outcome_.worst_sigmas = worstSigmas(report_);
    const bool converged = report_.state == CalibrationState::kConverged;
    std::vector<TrialOptimum::Span> spans;
    for (const SegmentReport& segment : report_.queue.segments) {
      spans.push_back({segment.begin_ns, segment.end_ns});
    }
    if (!converged) spans = {TrialOptimum::Span()};
    const TrialOptimum::Result optimum = optimum_.compare(report_.camera, spans);
    outcome_.excess_cost = optimum.excess_cost;
    outcome_.optimum_rms_px = optimum.uncertainty_rms;
    outcome_.idle_keyframes = static_cast<int>(idle_seconds_.size());
    const std::size_t third = idle_seconds_.size() / 3;
    if (third == 0) return;
    double sums[3] = {0.0, 0.0, 0.0};
    for (std::size_t i = 0; i < 3 * third; ++i) sums[i / third] += idle_seconds_[i];
    outcome_.first_idle_ms = 1e3 * sums[1] / static_cast<double>(third);
    outcome_.last_idle_ms = 1e3 * sums[2] / static_cast<double>(third);
  }

  StartupTrial trial_;
  Random random_;
  FeatureTracks tracks_;
  TrialOptimum optimum_;
  std::unique_ptr<SelfCalibrator> calibrator_;
  CalibrationReport report_;
  StartupOutcome outcome_;
  bool is_keyframe_ = false;  // the newest frame
  std::vector<double> idle_seconds_;
};

}  // namespace

StartupOutcome run(const StartupTrial& trial) { return Runner(trial).run(); }

}  // namespace camera_self_calibration
