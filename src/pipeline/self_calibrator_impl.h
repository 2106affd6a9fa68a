#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "camera_self_calibration/pipeline/bounded_queue.h"
#include "camera_self_calibration/pipeline/checked_back_end.h"
#include "camera_self_calibration/pipeline/front_end.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/tracking/tracker.h"
#include "requests.h"

namespace camera_self_calibration {

/// The two threads and what they exchange.
struct SelfCalibrator::Impl {
  Impl(const Options& given_options, Mode given_mode, Callbacks given_callbacks);
  ~Impl();

  void processImage(const ImageView& image);
  void processFrame(const TrackedFrame& frame, const ImageView& image,
                    const std::function<std::vector<Track>()>& detect,
                    const Describe& describe_tracks, std::chrono::steady_clock::time_point begin);
  MapView mapView(const FrontEndOutput& output) const;
  /// What the back end made of a keyframe.
  struct Processed {
    std::uint64_t beginning = 0;  // Beginning::number
    BackEndOutput output;
    std::shared_ptr<const LearntState> learnt;
  };
  /// What thread 2 does with a keyframe.
  using Work = std::packaged_task<std::optional<Processed>()>;

  void handOn(KeyframeMessage message);
  bool isOutdated(const KeyframeMessage& message) const;  // from before a reset
  void announce(const KeyframeMessage& message) const;
  /// Nothing where the keyframe is outdated; `held`: the calibration stays as it is.
  std::optional<Processed> processKeyframe(const KeyframeMessage& message, bool held);
  void deliver(std::optional<Processed> processed);
  void deliverPending();
  /// What goes wrong in `work`, on the image of this stamp, is an event, and tracking begins anew.
  void guard(std::int64_t stamp_ns, const std::function<void()>& work) noexcept;
  bool accept(const TrackedFrame& frame);
  void leaveOut(std::int64_t stamp_ns, const std::string& reason);
  void start(int width, int height, const Requests::Restart& request);
  void followRequests(const TrackedFrame& frame);
  void distrustStart(const TrackedFrame& frame, bool contradicted);
  void noteStartsGivenUp(CalibrationReport* to) const;
  void refuseOtherSize(const TrackedFrame& frame, Requests::Restart* request) const;
  void checkSource(bool takes_images);
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
  std::shared_ptr<const Beginning> beginning;
  int maps_lost = 0;         // since it, in a row, before anything was learnt
  int keyframes_of_map = 0;  // of the present one

  // Thread 2; made when the first keyframe of a new beginning arrives.
  std::unique_ptr<CheckedBackEnd> back_end;
  std::uint64_t back_end_beginning = 0;

  // Exchanged.
  enum class Source { kNone, kImages, kTracks };
  std::atomic<Source> source{Source::kNone};
  Requests requests;
  std::atomic<bool> frozen{false};
  std::atomic<bool> tracking{false};
  std::mutex mutex;
  std::optional<CalibrationUpdate> update;  // newest, for thread 1
  CalibrationReport report;
  std::uint64_t newest_beginning = 0;
  std::uint64_t starts_given_up = 0;     // since the calibrator was made
  std::optional<Camera> start_given_up;  // the newest
  std::shared_ptr<const LearntState> learnt;
  BoundedQueue<ImageView> images;
  BoundedQueue<Work> keyframes;
  std::future<std::optional<Processed>> pending;  // inline and pipelined: of the newest keyframe
  std::atomic<std::int64_t> dropped{0};
  std::thread front_thread;
  std::thread back_thread;
};

}  // namespace camera_self_calibration
