#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "camera_self_calibration/rig/mount_change.h"
#include "camera_self_calibration/rig/rig_calibrator.h"

namespace camera_self_calibration {

/// Watches whether the cameras of a rig still sit where they did, in constant memory: keyframes are
/// taken together in short segments, each of which says by itself where the cameras sit
/// (RigCalibrator::likelihood); judgeMounts() compares the newest of them. Each time it is asked it
/// spends its share of the allowed false alarms, `rate * time since it was asked last`.
class MountWatch {
 public:
  explicit MountWatch(const RigOptions& options) : options_(options) {}

  /// Keyframes in the order of time; where it jumps back, what was seen from there on goes.
  void add(const RigFrame& frame);

  /// Whether whole segments wait for likelihood(), and whether so many that some will be lost.
  bool due() const { return !waiting_.empty(); }
  bool full() const { return waiting_.size() >= kMaxWaiting; }

  /// The whole segments that wait, which wait no longer.
  std::deque<RigFrames> takeWaiting();
  /// The keyframes since, if they are enough to say anything: a segment that is not whole yet.
  const RigFrames& newest() const { return newest_; }
  bool newestTells() const;

  /// What a segment says, from the rig as it is known; nothing where it says nothing.
  static std::optional<RigLikelihood> likelihood(const RigFrames& frames, const RigOptions& options,
                                                 const FindAcross& across, const Rig& known,
                                                 double inverse_depth);

  /// A whole segment, in the order of time. Those under other lens models are forgotten.
  void learn(RigLikelihood segment);

  /// What all segments say, and, if it tells, the one that is not whole yet. After a change those
  /// before it are forgotten, after an outlier that one.
  MountVerdict judge(const std::optional<RigLikelihood>& newest, const Rig& reference);

  void clear();

 private:
  // Segments that are compared: more than the keyframes of a joint solution.
  static constexpr std::size_t kMaxSegments = 40;
  // Segments that wait at most, with their images: for a rig that is not known yet.
  static constexpr std::size_t kMaxWaiting = 12;

  void closeSegment();
  void forgetAround(std::int64_t stamp_ns);

  RigOptions options_;
  RigFrames newest_;
  std::deque<RigFrames> waiting_;
  std::deque<RigLikelihood> segments_;
  std::optional<std::int64_t> asked_ns_;  // up to when it was asked
};

}  // namespace camera_self_calibration
