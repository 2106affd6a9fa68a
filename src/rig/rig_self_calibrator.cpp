#include "camera_self_calibration/rig/rig_self_calibrator.h"

#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

#include "camera_self_calibration/base/guarded.h"

namespace camera_self_calibration {
namespace {

constexpr int kNiceness = 10;

RigOptions withStop(RigOptions options, const std::atomic<bool>* stopping) {
  options.solve.stop = [stopping] { return stopping->load(); };
  return options;
}

// Known from the first image on, before the camera has a keyframe to report at.
CalibrationReport heldReport(const Camera& camera) {
  CalibrationReport report;
  report.state = CalibrationState::kConverged;
  report.camera = camera;
  report.handed_over = true;
  return report;
}

Event eventOf(const MountChange& change) {
  Event event;
  event.type = EventType::kMountChanged;
  event.stamp_ns = change.found_ns;
  event.onset_stamp_ns = change.onset_ns;
  event.sentence = change.sentence;
  event.epoch = change.epoch;
  event.p_value = change.p_value;
  event.rotation = change.angle();
  event.rotation_sigma = change.angleSigma();
  return event;
}

}  // namespace

RigSelfCalibrator::RigSelfCalibrator(const RigOptions& rig, const std::vector<Options>& cameras,
                                     SelfCalibrator::Mode mode, RigCallbacks callbacks)
    : callbacks_(std::move(callbacks)),
      inline_(mode == SelfCalibrator::Mode::kInline),
      session_(withStop(rig, &stopping_), static_cast<int>(cameras.size()), AcrossImages()) {
  for (const Options& options : cameras) {
    const auto camera = static_cast<int>(cameras_.size());
    cameras_.push_back(std::make_unique<SelfCalibrator>(options, mode, callbacksOf(camera)));
    if (options.fix_intrinsics) session_.update(camera, heldReport(*options.initial_camera));
  }
  if (mode == SelfCalibrator::Mode::kThreaded) solver_ = std::thread([this] { run(); });
}

// The solver first: who hears of its solutions may ask for what the cameras have learnt.
RigSelfCalibrator::~RigSelfCalibrator() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (solver_.joinable()) solver_.join();
  cameras_.clear();
}

bool RigSelfCalibrator::process(int camera, const ImageView& image) {
  return cameras_[camera]->process(image);
}

// Inline nobody else solves what a change leaves. Each takes keyframes away.
RigReport RigSelfCalibrator::solve() {
  for (;;) {
    const std::uint64_t told = told_epoch_;
    RigReport report = tell(session_.solve());
    if (!inline_ || told_epoch_ == told) return report;
  }
}

RigReport RigSelfCalibrator::examineMounts() { return tell(session_.examineMounts()); }

RigReport RigSelfCalibrator::tell(RigReport report) {
  for (const MountChange& change : report.mount_changes) {
    if (change.epoch <= told_epoch_) continue;
    told_epoch_ = change.epoch;
    if (callbacks_.event) callbacks_.event(change.camera, eventOf(change));
  }
  if (callbacks_.rig) callbacks_.rig(report);
  return report;
}

Callbacks RigSelfCalibrator::callbacksOf(int camera) {
  Callbacks result;
  result.frame = [this, camera](const FrameResult& frame) {
    newest_image_ns_ = frame.stamp_ns;
    session_.add(camera, frame);
    if (callbacks_.frame) callbacks_.frame(camera, frame);
    if (!frame.is_keyframe) return;
    if (inline_ && session_.mountsDue()) examineMounts();
    { const std::lock_guard<std::mutex> lock(mutex_); }  // not between its look and its sleep
    wake_.notify_all();
  };
  result.calibration = [this, camera](const CalibrationReport& report) {
    session_.update(camera, report);
    if (callbacks_.calibration) callbacks_.calibration(camera, report);
    if (callbacks_.rig) callbacks_.rig(session_.report());
  };
  result.event = [this, camera](const Event& event) {
    if (callbacks_.event) callbacks_.event(camera, event);
  };
  return result;
}

void RigSelfCalibrator::work() noexcept {
  guarded([this] { session_.due() ? solve() : examineMounts(); },
          [this](const std::string& what) {
            const std::int64_t stamp_ns = newest_image_ns_;
            if (!callbacks_.event) return;
            callbacks_.event(0, {EventType::kInput, stamp_ns, stamp_ns,
                                 "the cameras could not be solved together: " + what});
          });
}

// On Linux a thread has a priority of its own.
void RigSelfCalibrator::run() {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kNiceness);
  while (!stopping_) {
    {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [this] { return stopping_ || session_.due() || session_.mountsDue(); });
      if (stopping_) return;
    }
    const auto begin = std::chrono::steady_clock::now();
    work();
    const auto spent = std::chrono::steady_clock::now() - begin;
    std::unique_lock<std::mutex> lock(mutex_);
    wake_.wait_for(lock, spent, [this] { return stopping_.load(); });
  }
}

}  // namespace camera_self_calibration
