#include "self_calibrator_impl.h"

#include <stdexcept>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/guarded.h"

namespace camera_self_calibration {
namespace {

// A keyframe that the back end never sees costs a candidate, no more.
constexpr std::size_t kMaxQueuedKeyframes = 4;

// Maps lost in a row, with nothing learnt of the lens, after which the start values are not
// believed any more. A good start loses one where the motion is too fast, seldom two.
constexpr int kMapsToDistrustStart = 3;
// Keyframes of a map that lasted: its start was no hindrance.
constexpr int kLastingMap = 12;

const Options& checked(const Options& options) {
  std::string text;
  for (const std::string& problem : options.problems()) text += "\n  " + problem;
  if (!text.empty()) throw std::invalid_argument("the options are not valid:" + text);
  return options;
}

}  // namespace

SelfCalibrator::Impl::Impl(const Options& given_options, Mode given_mode, Callbacks given_callbacks)
    : options(checked(given_options)),
      mode(given_mode),
      callbacks(std::move(given_callbacks)),
      tracker(options.tracker),
      images(options.max_queued_images),
      keyframes(kMaxQueuedKeyframes) {
  if (mode == Mode::kInline) return;
  back_thread = std::thread([this] {
    while (auto work = keyframes.pop()) (*work)();
  });
  if (mode == Mode::kPipelined) return;
  front_thread = std::thread([this] {
    while (const auto image = images.pop()) guard(image->stamp_ns, [&] { processImage(*image); });
  });
}

SelfCalibrator::Impl::~Impl() {
  images.close();
  if (front_thread.joinable()) front_thread.join();
  keyframes.close();
  if (back_thread.joinable()) back_thread.join();
}

void SelfCalibrator::Impl::guard(std::int64_t stamp_ns,
                                 const std::function<void()>& work) noexcept {
  guarded(work, [&](const std::string& what) {
    requests.resetTracking();
    raise({EventType::kInput, stamp_ns, stamp_ns, "an image could not be processed: " + what});
  });
}

// An initial calibration holds for its own image size, whatever the first image's.
void SelfCalibrator::Impl::start(int image_width, int image_height,
                                 const Requests::Restart& request) {
  auto next = std::make_shared<Beginning>();
  next->number = beginning ? beginning->number + 1 : 1;
  next->state = request.state;
  if (request.state) {
    next->camera = request.state->camera;
  } else if (request.camera) {
    next->camera = *request.camera;
  } else if (options.initial_camera) {
    next->camera = *options.initial_camera;
  } else {
    next->camera = Camera::defaultGuess(options.firstModel(), image_width, image_height);
  }
  beginning = next;
  maps_lost = keyframes_of_map = 0;
  width = next->camera.width();
  height = next->camera.height();
  const std::int64_t first_keyframe = request.state ? request.state->keyframes : 0;
  if (front_end) {
    front_end->restart(next->camera, first_keyframe);
  } else {
    front_end = std::make_unique<FrontEnd>(options, next->camera, first_keyframe);
  }
  tracker.reset();
  std::lock_guard<std::mutex> lock(mutex);
  newest_beginning = next->number;
  report = CalibrationReport();
  report.camera = next->camera;
  report.uncertainty = PixelError::unknown();
  noteStartsGivenUp(&report);
  learnt.reset();
  update.reset();
}

// With the lock held.
void SelfCalibrator::Impl::noteStartsGivenUp(CalibrationReport* to) const {
  to->starts_given_up = starts_given_up;
  to->start_given_up = start_given_up;
}

void SelfCalibrator::Impl::followRequests(const TrackedFrame& frame) {
  Requests::Taken taken = requests.take();
  if (taken.restart || !front_end) {
    frozen = false;
    if (!taken.restart) taken.restart.emplace();
    refuseOtherSize(frame, &*taken.restart);
    start(frame.width, frame.height, *taken.restart);
  } else if (taken.reset_tracking) {
    tracker.reset();
    front_end->resetMap();
    front_end->forgetOlderMaps();
  }
  if (taken.scale != 1.0) front_end->scaleMap(taken.scale);
}

// Start values that are wrong make poses disagree with the tracks, map after map. A covered lens
// says nothing of them.
void SelfCalibrator::Impl::distrustStart(const TrackedFrame& frame, bool contradicted) {
  if (std::exchange(keyframes_of_map, 0) >= kLastingMap) maps_lost = 0;
  if (front_end->knowsLens() || !contradicted) return;
  const Intrinsics& begun = beginning->camera.parameters();
  const Camera guess = Camera::defaultGuess(beginning->camera.model(), width, height);
  const bool given = begun.size() != guess.parameters().size() || begun != guess.parameters();
  if (++maps_lost < kMapsToDistrustStart || !given || options.fix_intrinsics) return;
  raise({EventType::kInput, frame.stamp_ns, frame.stamp_ns,
         "the start values are given up, since " + std::to_string(maps_lost) +
             " maps in a row were lost with them; the calibration begins again from a guess"});
  {
    const std::lock_guard<std::mutex> lock(mutex);
    ++starts_given_up;
    start_given_up = beginning->camera;
  }
  start(width, height, {Camera::defaultGuess(options.firstModel(), width, height), nullptr});
}

// What was learnt for another image size is not used; it would keep all images out.
void SelfCalibrator::Impl::refuseOtherSize(const TrackedFrame& frame,
                                           Requests::Restart* request) const {
  if (!request->state) return;
  const Camera& camera = request->state->camera;
  if (camera.width() == frame.width && camera.height() == frame.height) return;
  raise({EventType::kInput, frame.stamp_ns, frame.stamp_ns,
         "the saved state is for images of " + sizeText(camera.width(), camera.height()) +
             ", these are " + sizeText(frame.width, frame.height) + ": it is not used"});
  request->state.reset();
}

void SelfCalibrator::Impl::checkSource(bool takes_images) {
  const Source wanted = takes_images ? Source::kImages : Source::kTracks;
  Source before = Source::kNone;
  if (source.compare_exchange_strong(before, wanted) || before == wanted) return;
  if (mode != Mode::kThreaded) return;
  throw std::logic_error("a threaded calibrator takes either images or tracks, not both");
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
  followRequests(frame);
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
    tracker.reset();
    front_end->resetMap();
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
  const TrackedFrame frame = tracker.track(image);  // a copy: detect() adds to the tracker's own
  processFrame(
      frame, image, [this] { return tracker.detect(); },
      [&](const std::vector<Track>& tracks, int corners) {
        return describe(image, tracks,
                        corners > 0 ? tracker.corners(corners) : std::vector<Eigen::Vector2d>());
      },
      begin);
}

MapView SelfCalibrator::Impl::mapView(const FrontEndOutput& output) const {
  const KeyframeMessage& message = *output.keyframe;
  const bool starting = !message.history.keyframes.empty();
  return {output.result.map_id, front_end->camera(),
          starting ? message.history : message.candidate};
}

void SelfCalibrator::Impl::processFrame(const TrackedFrame& frame, const ImageView& image,
                                        const std::function<std::vector<Track>()>& detect,
                                        const Describe& describe_tracks,
                                        std::chrono::steady_clock::time_point begin) {
  std::optional<CalibrationUpdate> newest;
  {
    std::lock_guard<std::mutex> lock(mutex);
    newest.swap(update);
  }
  if (newest && newest->beginning == beginning->number) front_end->adopt(*newest);
  FrontEndOutput output = front_end->process(frame, detect, describe_tracks);
  tracker.drop(output.outliers);
  if (output.restart_tracking) {
    tracker.reset();
    distrustStart(frame, output.contradicted);
  }
  output.result.tracks = frame;
  output.result.image = image;
  tracking = output.result.state == TrackingState::kTracking;
  for (const Event& event : output.events) raise(event);
  if (output.keyframe) {
    ++keyframes_of_map;
    if (callbacks.map) callbacks.map(mapView(output));
    output.keyframe->beginning = beginning;
    handOn(std::move(*output.keyframe));
  }
  output.result.processing_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (callbacks.frame) callbacks.frame(output.result);
}

void SelfCalibrator::Impl::handOn(KeyframeMessage message) {
  if (mode == Mode::kThreaded) {
    keyframes.push(Work([this, message = std::move(message)]() -> std::optional<Processed> {
      guard(message.candidate.endNs(), [&] {
        announce(message);
        deliver(processKeyframe(message, frozen));
      });
      return std::nullopt;
    }));
    return;
  }
  deliverPending();
  announce(message);
  Work work([this, held = frozen.load(), message = std::move(message)] {
    return processKeyframe(message, held);
  });
  pending = work.get_future();
  if (mode == Mode::kPipelined) {
    keyframes.push(std::move(work));
  } else {
    work();
    deliverPending();
  }
}

bool SelfCalibrator::Impl::isOutdated(const KeyframeMessage& message) const {
  return message.beginning->number < back_end_beginning;
}

void SelfCalibrator::Impl::announce(const KeyframeMessage& message) const {
  if (callbacks.keyframe && !isOutdated(message)) callbacks.keyframe(message);
}

std::optional<SelfCalibrator::Impl::Processed> SelfCalibrator::Impl::processKeyframe(
    const KeyframeMessage& message, bool held) {
  if (isOutdated(message)) return std::nullopt;
  const std::uint64_t number = message.beginning->number;
  if (number > back_end_beginning) {
    if (back_end) {
      back_end->beginAgain(*message.beginning);
    } else {
      back_end = std::make_unique<CheckedBackEnd>(options, *message.beginning);
    }
    back_end_beginning = number;
  }
  Processed processed{number, back_end->process(message, held), nullptr};
  if (processed.output.update) processed.learnt = back_end->state();
  return processed;
}

void SelfCalibrator::Impl::deliver(std::optional<Processed> processed) {
  if (!processed) return;
  BackEndOutput& output = processed->output;
  {
    std::lock_guard<std::mutex> lock(mutex);
    if (processed->beginning != newest_beginning) return;  // a reset came meanwhile
    if (output.update) {
      output.update->beginning = processed->beginning;
      update = std::move(output.update);
      learnt = std::move(processed->learnt);
    }
    noteStartsGivenUp(&output.report);
    report = output.report;
  }
  // The report first, so that an event finds the epoch that it speaks of.
  if (callbacks.calibration) callbacks.calibration(output.report);
  for (const Event& event : output.events) raise(event);
}

void SelfCalibrator::Impl::deliverPending() {
  if (pending.valid()) deliver(pending.get());
}

}  // namespace camera_self_calibration
