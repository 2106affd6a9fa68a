#include "benchmark/degenerate_trial.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>

#include "benchmark/process_cost.h"
#include "benchmark/trial_tracks.h"
#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/simulation/feature_tracks.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kStartNs = 1000000000;
constexpr int kKeyframesToJudge = 12;

char initialOf(CalibrationState state) {
  switch (state) {
    case CalibrationState::kWaitingForMotion:
      return 'W';
    case CalibrationState::kInitializing:
      return 'I';
    case CalibrationState::kConverging:
      return 'c';
    case CalibrationState::kConverged:
      return 'C';
    case CalibrationState::kDegenerate:
      return 'D';
  }
  return '?';
}

class Runner {
 public:
  Runner(const DegenerateTrial& trial, double expense_s)
      : trial_(trial),
        expense_s_(expense_s),
        random_(mixSeed(trial.seed, 77)),
        tracks_(makeTracks()) {
    Options options;
    options.model = trial.truth.model();
    const double before = heapBytes();
    calibrator_ =
        std::make_unique<SelfCalibrator>(options, SelfCalibrator::Mode::kInline, callbacks());
    held_bytes_ = heapBytes() - before;
  }

  DegenerateOutcome run() {
    const double begin = threadCpuSeconds();
    const double first_s = trial_.good_first ? trial_.good_s : trial_.degenerate_s;
    const int first = static_cast<int>((trial_.skip_first ? first_s : 0.0) * trial_.rate_hz);
    const int end = static_cast<int>((trial_.degenerate_s + trial_.good_s) * trial_.rate_hz);
    for (int i = first; i < end && !isOver(); ++i) step(i);
    closeExpense();
    outcome_.cpu_s = threadCpuSeconds() - begin;
    outcome_.final_state = toString(report_.state);
    if (outcome_.state.empty()) outcome_.state = outcome_.final_state;
    outcome_.error_px = distanceToTruth(report_.camera);
    outcome_.stated_px = report_.uncertainty.rms;
    outcome_.travel_deg = median(travel_deg_, outcome_.travel_deg);
    return outcome_;
  }

 private:
  // A calibration that has converged in the good motion after all is watched for a while yet.
  bool isOver() const {
    constexpr double kWatchedS = 3.0;
    return !trial_.good_first && outcome_.recovered_s >= 0.0 &&
           time_s_ > trial_.degenerate_s + outcome_.recovered_s + kWatchedS;
  }

  bool isDegenerate(double time_s) const {
    return trial_.good_first ? time_s >= trial_.good_s : time_s < trial_.degenerate_s;
  }

  FeatureTracks makeTracks() {
    DegenerateScene scene = trial_.good_first
                                ? makeLateDegenerateScene(trial_.degeneracy, trial_.good_s,
                                                          trial_.degenerate_s, trial_.seed)
                                : makeDegenerateScene(trial_.degeneracy, trial_.degenerate_s,
                                                      trial_.good_s, trial_.seed);
    return FeatureTracks(std::move(scene.world), Lens{trial_.truth, std::nullopt, 1.0},
                         std::move(scene.trajectory), trialTracks(trial_.seed, kStartNs, &random_));
  }

  Callbacks callbacks() {
    Callbacks result;
    result.calibration = [this](const CalibrationReport& report) { watch(report); };
    result.frame = [this](const FrameResult& frame) { watch(frame); };
    result.event = [this](const Event& event) { watch(event); };
    return result;
  }

  double distanceToTruth(const Camera& camera) const {
    return pixelDistance(trial_.truth, camera).rms;
  }

  void watch(const CalibrationReport& report) {
    const bool converged = report.state == CalibrationState::kConverged;
    const bool was_converged = report_.state == CalibrationState::kConverged;
    report_ = report;
    ++keyframes_;
    if (converged) watchPublished(report);
    if (was_converged && !converged) ++outcome_.left_converged;
    if (!isDegenerate(time_s_)) {
      if (converged && outcome_.recovered_s < 0.0 && !trial_.good_first) {
        outcome_.recovered_s = time_s_ - trial_.degenerate_s;
      }
      return;
    }
    ++outcome_.keyframes;
    const char initial = initialOf(report.state);
    if (outcome_.states.find(initial) == std::string::npos) outcome_.states += initial;
    outcome_.state = toString(report.state);
    outcome_.sentence = report.sentence;
    if (converged && outcome_.converged_s < 0.0) outcome_.converged_s = time_s_;
    if (report.handed_over || keyframes_ < kKeyframesToJudge) return;
    ++outcome_.unfinished;
    outcome_.hinted += !report.hint.empty();
    outcome_.named += report.sentence.find("least known") != std::string::npos;
  }

  void watchPublished(const CalibrationReport& report) {
    ++outcome_.published;
    const double error = distanceToTruth(report.camera);
    const double ratio = error / report.uncertainty.rms;
    double sigmas = 0.0;
    for (int i = 0; i < report.covariance.rows(); ++i) {
      const double truth = i < trial_.truth.parameterCount() ? trial_.truth.parameters()(i) : 0.0;
      sigmas = std::max(sigmas, std::abs(report.camera.parameters()(i) - truth) /
                                    std::sqrt(report.covariance(i, i)));
    }
    outcome_.worst_ratio = std::max(outcome_.worst_ratio, ratio);
    outcome_.worst_sigmas = std::max(outcome_.worst_sigmas, sigmas);
    const double one_px = convergedRms(0.0, trial_.truth);
    if (error > one_px && (ratio > 5.0 || sigmas > 5.0)) outcome_.false_converged = true;
    constexpr double kPassageS = 6.0;  // from the end of one motion to the other: informative
    if (!trial_.good_first || time_s_ < trial_.good_s + kPassageS) return;
    if (!at_end_of_good_) at_end_of_good_ = report.camera;
    outcome_.wander_px =
        std::max(outcome_.wander_px, pixelDistance(*at_end_of_good_, report.camera).rms);
  }

  struct Place {
    std::int64_t stamp_ns = 0;
    Rigid3 estimate;
    Rigid3 truth;
  };

  static Eigen::Vector3d way(const Rigid3& from, const Rigid3& to) {
    return from.rotation.conjugate() * (to.translation - from.translation);
  }

  void watch(const FrameResult& frame) {
    constexpr std::int64_t kTravelNs = 300000000;
    if (frame.state != TrackingState::kTracking || frame.map_id != map_id_ || frame.moved) {
      places_.clear();
    }
    map_id_ = frame.map_id;
    if (frame.state != TrackingState::kTracking) return;
    places_.push_back(
        {frame.stamp_ns, frame.world_from_camera, tracks_.worldFromCamera(frame.stamp_ns)});
    while (places_.size() > 2 && places_[1].stamp_ns <= frame.stamp_ns - kTravelNs) {
      places_.pop_front();
    }
    constexpr double kBegunS = 1.0;
    const bool counts = report_.state == CalibrationState::kConverged && !trial_.good_first &&
                        time_s_ > trial_.degenerate_s + kBegunS;
    if (!counts || places_.front().stamp_ns > frame.stamp_ns - kTravelNs) return;
    const Eigen::Vector3d estimate = way(places_.front().estimate, places_.back().estimate);
    const Eigen::Vector3d truth = way(places_.front().truth, places_.back().truth);
    travel_deg_.push_back(std::atan2(estimate.cross(truth).norm(), estimate.dot(truth)) * 180.0 /
                          M_PI);
  }

  void watch(const Event& event) {
    outcome_.changes += event.type == EventType::kCalibrationChange;
    outcome_.lost += event.type == EventType::kLost;
  }

  void step(int index) {
    time_s_ = index / trial_.rate_hz;
    const std::int64_t stamp = kStartNs + static_cast<std::int64_t>(1e9 * time_s_);
    const bool blind = trial_.degeneracy == Degeneracy::kNoTexture && isDegenerate(time_s_);
    if (blind) tracks_.reset();
    const TrackedFrame frame = tracks_.track(stamp);  // a copy: detect() may be called inside
    double simulator_bytes = 0.0;
    const auto detect = [&] {
      const double before = heapBytes();
      std::vector<Track> started = blind ? std::vector<Track>() : tracks_.detect();
      simulator_bytes += heapBytes() - before;
      return started;
    };
    const int keyframes_before = keyframes_;
    const double bytes_before = heapBytes();
    const double begin = threadCpuSeconds();
    calibrator_->processTracks(frame, detect);
    const double seconds = threadCpuSeconds() - begin;
    held_bytes_ += heapBytes() - bytes_before - simulator_bytes;
    account(seconds, keyframes_ > keyframes_before);
  }

  void account(double seconds, bool keyframe) {
    if (expense_.frames == 0) expense_.begin_s = time_s_;
    ++expense_.frames;
    expense_.keyframes += keyframe;
    (keyframe ? expense_.keyframe_ms : expense_.frame_ms) += 1e3 * seconds;
    expense_.slowest_ms = std::max(expense_.slowest_ms, 1e3 * seconds);
    if (time_s_ + 1.0 / trial_.rate_hz >= expense_.begin_s + expense_s_) closeExpense();
  }

  void closeExpense() {
    if (expense_.frames == 0) return;
    expense_.keyframe_ms /= std::max(1, expense_.keyframes);
    expense_.frame_ms /= std::max(1, expense_.frames - expense_.keyframes);
    expense_.memory_kb = held_bytes_ / 1024.0;
    outcome_.expenses.push_back(expense_);
    expense_ = Expense();
  }

  DegenerateTrial trial_;
  double expense_s_;
  Random random_;
  FeatureTracks tracks_;
  std::unique_ptr<SelfCalibrator> calibrator_;
  double time_s_ = 0.0;
  int keyframes_ = 0;
  double held_bytes_ = 0.0;
  std::optional<Camera> at_end_of_good_;
  CalibrationReport report_;
  std::uint64_t map_id_ = 0;
  std::deque<Place> places_;  // of the last images of this map
  std::vector<double> travel_deg_;
  DegenerateOutcome outcome_;
  Expense expense_;
};

}  // namespace

DegenerateOutcome run(const DegenerateTrial& trial, double expense_s) {
  return Runner(trial, expense_s).run();
}

}  // namespace camera_self_calibration
