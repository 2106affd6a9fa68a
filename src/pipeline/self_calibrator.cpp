#include "camera_self_calibration/pipeline/self_calibrator.h"

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include "camera_self_calibration/pipeline/back_end.h"
#include "camera_self_calibration/pipeline/bounded_queue.h"
#include "camera_self_calibration/pipeline/front_end.h"
#include "camera_self_calibration/tracking/tracker.h"

namespace camera_self_calibration {
namespace {

// A keyframe that the back end never sees costs a candidate, no more.
constexpr std::size_t kMaxQueuedKeyframes = 4;

const Options& checked(const Options& options) {
  std::string text;
  for (const std::string& problem : options.problems()) text += "\n  " + problem;
  if (!text.empty()) throw std::invalid_argument("the options are not valid:" + text);
  return options;
}

std::string sizeText(int width, int height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

}  // namespace

struct SelfCalibrator::Impl {
  Impl(const Options& given_options, Mode given_mode, Callbacks given_callbacks)
      : options(checked(given_options)),
        mode(given_mode),
        callbacks(std::move(given_callbacks)),
        tracker(options.tracker),
        images(options.max_queued_images),
        keyframes(kMaxQueuedKeyframes) {
    if (mode == Mode::kInline) return;
    front_thread = std::thread([this] {
      while (const auto image = images.pop())
        guarded(image->stamp_ns, [&] { processImage(*image); });
    });
    back_thread = std::thread([this] {
      while (const auto message = keyframes.pop()) {
        guarded(message->candidate.endNs(), [&] { processKeyframe(*message); });
      }
    });
  }

  ~Impl() {
    images.close();
    if (front_thread.joinable()) front_thread.join();
    keyframes.close();
    if (back_thread.joinable()) back_thread.join();
  }

  void processImage(const ImageView& image);
  void processFrame(const TrackedFrame& frame, const std::function<std::vector<Track>()>& detect,
                    std::chrono::steady_clock::time_point begin);
  void processKeyframe(const KeyframeMessage& message);
  // Nothing that goes wrong with one image may end the process that hosts the threads.
  void guarded(std::int64_t stamp_ns, const std::function<void()>& work) {
    try {
      work();
    } catch (const std::exception& error) {
      reset_requested = true;
      raise({EventType::kInput, stamp_ns, stamp_ns,
             std::string("an image could not be processed: ") + error.what()});
    }
  }
  bool accept(const TrackedFrame& frame);
  void leaveOut(std::int64_t stamp_ns, const std::string& reason);
  void start(int width, int height);
  void raise(const Event& event) const {
    if (callbacks.event) callbacks.event(event);
  }

  const Options options;
  const Mode mode;
  const Callbacks callbacks;

  // Thread 1.
  Tracker tracker;
  std::unique_ptr<FrontEnd> front_end;
  int width = 0;
  int height = 0;
  std::int64_t last_stamp_ns = 0;
  std::string left_out;  // why the last image was; empty if it was not
  std::atomic<bool> reset_requested{false};

  // Thread 2; created by thread 1 before the first keyframe reaches it.
  std::unique_ptr<BackEnd> back_end;

  // Exchanged.
  std::mutex mutex;
  std::optional<CalibrationUpdate> update;  // newest, for thread 1
  CalibrationReport report;
  BoundedQueue<ImageView> images;
  BoundedQueue<KeyframeMessage> keyframes;
  std::atomic<std::int64_t> dropped{0};
  std::thread front_thread;
  std::thread back_thread;
};

// An initial calibration holds for its own image size, whatever the first image's.
void SelfCalibrator::Impl::start(int image_width, int image_height) {
  const Camera camera = options.initial_camera
                            ? *options.initial_camera
                            : Camera::defaultGuess(options.model, image_width, image_height);
  width = camera.width();
  height = camera.height();
  front_end = std::make_unique<FrontEnd>(options, camera);
  back_end = std::make_unique<BackEnd>(options, camera);
  std::lock_guard<std::mutex> lock(mutex);
  report.camera = camera;
}

// Said once for a run of such images.
void SelfCalibrator::Impl::leaveOut(std::int64_t stamp_ns, const std::string& reason) {
  if (reason != left_out) raise({EventType::kInput, stamp_ns, stamp_ns, reason});
  left_out = reason;
}

bool SelfCalibrator::Impl::accept(const TrackedFrame& frame) {
  if (frame.width <= 0 || frame.height <= 0) {
    leaveOut(frame.stamp_ns, "an empty image is left out");
    return false;
  }
  if (!front_end) start(frame.width, frame.height);
  if (frame.width != width || frame.height != height) {
    leaveOut(frame.stamp_ns, "images of " + sizeText(frame.width, frame.height) +
                                 " are left out: the calibration is for " +
                                 sizeText(width, height) + "; restart to calibrate the new size");
    return false;
  }
  left_out.clear();
  if (frame.stamp_ns < last_stamp_ns) {
    raise({EventType::kInput, frame.stamp_ns, frame.stamp_ns,
           "time jumped back: a new map begins, the calibration stays"});
    reset_requested = true;
  }
  last_stamp_ns = frame.stamp_ns;
  return true;
}

void SelfCalibrator::Impl::processImage(const ImageView& image) {
  const auto begin = std::chrono::steady_clock::now();
  TrackedFrame header;
  header.stamp_ns = image.stamp_ns;
  header.width = image.data != nullptr ? image.width : 0;
  header.height = image.height;
  if (!accept(header)) return;
  if (reset_requested.exchange(false)) {
    tracker.reset();
    front_end->resetMap();
  }
  const TrackedFrame frame = tracker.track(image);  // a copy: detect() adds to the tracker's own
  processFrame(
      frame, [this] { return tracker.detect(); }, begin);
}

void SelfCalibrator::Impl::processFrame(const TrackedFrame& frame,
                                        const std::function<std::vector<Track>()>& detect,
                                        std::chrono::steady_clock::time_point begin) {
  std::optional<CalibrationUpdate> newest;
  {
    std::lock_guard<std::mutex> lock(mutex);
    newest.swap(update);
  }
  if (newest) front_end->adopt(*newest);
  FrontEndOutput output = front_end->process(frame, detect);
  tracker.drop(output.outliers);
  if (output.restart_tracking) tracker.reset();
  output.result.tracks = frame;
  for (const Event& event : output.events) raise(event);
  if (output.keyframe) {
    if (mode == Mode::kInline) {
      processKeyframe(*output.keyframe);
    } else {
      keyframes.push(std::move(*output.keyframe));
    }
  }
  output.result.processing_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (callbacks.frame) callbacks.frame(output.result);
}

void SelfCalibrator::Impl::processKeyframe(const KeyframeMessage& message) {
  BackEndOutput output = back_end->process(message);
  {
    std::lock_guard<std::mutex> lock(mutex);
    if (output.update) update = std::move(output.update);
    report = output.report;
  }
  for (const Event& event : output.events) raise(event);
  if (callbacks.calibration) callbacks.calibration(output.report);
}

SelfCalibrator::SelfCalibrator(const Options& options, Mode mode, Callbacks callbacks)
    : impl_(std::make_unique<Impl>(options, mode, std::move(callbacks))) {}

SelfCalibrator::~SelfCalibrator() = default;

bool SelfCalibrator::process(const ImageView& image) {
  if (impl_->mode == Mode::kInline) {
    impl_->processImage(image);
    return true;
  }
  const bool kept_all = impl_->images.push(image);
  if (!kept_all) ++impl_->dropped;
  return kept_all;
}

void SelfCalibrator::processTracks(const TrackedFrame& frame,
                                   const std::function<std::vector<Track>()>& detect) {
  if (!impl_->accept(frame)) return;
  if (impl_->reset_requested.exchange(false)) impl_->front_end->resetMap();
  impl_->processFrame(frame, detect, std::chrono::steady_clock::now());
}

void SelfCalibrator::resetTracking() { impl_->reset_requested = true; }

void SelfCalibrator::flush() {
  if (impl_->mode == Mode::kInline) return;
  impl_->images.waitUntilIdle();
  impl_->keyframes.waitUntilIdle();
}

CalibrationReport SelfCalibrator::calibration() const {
  std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->report;
}

std::int64_t SelfCalibrator::droppedImages() const { return impl_->dropped; }

}  // namespace camera_self_calibration
