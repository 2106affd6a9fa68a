#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "camera_self_calibration/rig/mount_change.h"
#include "camera_self_calibration/rig/rig_calibrator.h"

namespace camera_self_calibration {

/// Watches whether the cameras of a rig still sit where they did, in constant memory: keyframes are
/// taken together in short stretches, each of which says by itself where the cameras sit
/// (RigCalibrator::likelihood); judgeMounts() compares the newest of them. Each time it is asked it
/// spends its share of the allowed false alarms, `rate * time since it was asked last`.
class MountWatch {
 public:
  using Stretch = std::vector<RigFrame>;

  explicit MountWatch(const RigOptions& options) : options_(options) {}

  /// Keyframes in the order of time; where it jumps back, what was seen from there on goes.
  void add(const RigFrame& frame);

  /// Whether whole stretches wait for likelihood(), and whether so many that some will be lost.
  bool due() const { return !waiting_.empty(); }
  bool full() const { return waiting_.size() >= kMaxWaiting; }

  /// The whole stretches that wait, which wait no longer.
  std::deque<Stretch> takeWaiting();
  /// The keyframes since, if they are enough to say anything: a stretch that is not whole yet.
  const Stretch& newest() const { return newest_; }
  bool newestTells() const;

  /// What a stretch says, from the rig as it is known; nothing where it says nothing.
  static std::optional<RigLikelihood> likelihood(const Stretch& stretch, const RigOptions& options,
                                                 const FindAcross& across, const Rig& known,
                                                 double inverse_depth);

  /// A whole stretch, in the order of time. Those under other lens models are forgotten.
  void learn(RigLikelihood stretch);

  /// What all stretches say, and, if it tells, the one that is not whole yet. After a change those
  /// before it are forgotten, after an outlier that one.
  MountVerdict judge(const std::optional<RigLikelihood>& newest, const Rig& reference);

  void clear();

 private:
  // Stretches that are compared: more than the keyframes of a joint solution.
  static constexpr std::size_t kMaxStretches = 40;
  // Stretches that wait at most, with their images: for a rig that is not known yet.
  static constexpr std::size_t kMaxWaiting = 12;

  void closeStretch();
  void forgetAround(std::int64_t stamp_ns);

  RigOptions options_;
  Stretch newest_;
  std::deque<Stretch> waiting_;
  std::deque<RigLikelihood> stretches_;
  std::optional<std::int64_t> asked_ns_;  // up to when it was asked
};

}  // namespace camera_self_calibration
