#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/rig/mount_watch.h"
#include "camera_self_calibration/rig/rig_calibrator.h"
#include "camera_self_calibration/rig/rig_keyframes.h"
#include "camera_self_calibration/rig/synchronised_views.h"

namespace camera_self_calibration {

/// What is known of a rig, at one time.
struct RigReport {
  CalibrationState state = CalibrationState::kWaitingForMotion;  ///< CONVERGED: rig and cameras.
  std::string sentence;                                          ///< The state in words.
  std::string hint;                        ///< What would help; empty if nothing is needed.
  std::vector<CalibrationReport> cameras;  ///< What each knows of its lens by itself.
  RigEstimate estimate;                    ///< The best so far; not usable until there is one.
  std::uint64_t revision = 0;              ///< Grows with each new `estimate`.
  std::uint64_t epoch = 0;                 ///< Grows when a lens or a mount changes.
  int keyframes = 0;                       ///< Kept for the next joint solution.
  int solutions = 0;                       ///< Joint ones so far, those that failed too.
  double solve_seconds = 0.0;              ///< Of the last of them.
  std::string last_failure;  ///< Why the last of them replaced nothing; empty if it did.
  std::string
      anew;  ///< Why the rig is learnt anew; empty where it is not, or once it is CONVERGED.
  /// Cameras that were turned or moved, the newest last; so many are remembered at most.
  std::vector<MountChange> mount_changes;
  static constexpr std::size_t kMaxMountChanges = 20;
};

/// The report of a camera with the joint intrinsics of `estimate` in place of those that it found
/// for itself; CONVERGING where they are known to no better than `limit_px` rms.
CalibrationReport withJointIntrinsics(CalibrationReport report, const RigEstimate& estimate,
                                      int camera, double limit_px);

/// The estimate as the verdict of the report has it: where that is not CONVERGED neither is this,
/// and its sentence and hint are those of the report.
RigEstimate withVerdict(const RigReport& report);

/// A rig while its cameras run: takes what each camera makes of its images, collects the keyframes
/// of the rig in constant memory, and keeps the best of the joint solutions. Where a camera was
/// turned or moved against the others, what was seen before goes, and the rig is learnt anew. Each
/// call may come from any thread; a solution holds up none of the others.
class RigSession {
 public:
  /// `across` as for RigCalibrator.
  RigSession(const RigOptions& options, int cameras, const FindAcross& across);

  /// What was known of the rig when it ran last, to begin with: it holds until a joint solution
  /// takes its place. Where one shows a camera elsewhere, by more than the pixels that CONVERGED
  /// allows and the sigmas of both, the camera was moved meanwhile. What was metric stays so where
  /// no baseline is given, until any camera is found to have been moved; a lens that changes before
  /// the first comparison ends it too. For as many cameras and images of the same sizes, before the
  /// first joint solution.
  void restore(const RigEstimate& before);

  /// An image that a camera processed. Counts from when all cameras know their lenses.
  void add(int camera, const FrameResult& result);

  /// What a camera knows of its lens. A change of the lens (a new epoch) discards all keyframes.
  void update(int camera, const CalibrationReport& report);

  /// Whether there are so many new keyframes that another joint solution is worth it.
  bool due() const;

  /// Solves jointly from the keyframes so far. What fails, or is not CONVERGED where the estimate
  /// so far is, replaces nothing. Nor is a rig CONVERGED while its keyframes leave in doubt whether
  /// a camera was moved among them. Where one was, nothing is solved yet, and what is left may be
  /// due. For one thread at a time.
  RigReport solve();

  /// Whether there are keyframes that were not asked yet whether a camera was moved.
  bool mountsDue() const;

  /// Asks them, from the rig as it is known; solves jointly where none is. For the thread that
  /// solves.
  RigReport examineMounts();

  RigReport report() const;

 private:
  using Lock = std::unique_lock<std::mutex>;

  /// A rig to start from.
  struct KnownRig {
    Rig rig;
    double inverse_depth = 1.0;  // RigEstimate's,
    bool metric = false;         // as well
  };

  bool lensesKnown() const;
  void collect(std::vector<TimedView> views);
  void beginAnew(const std::string& why);
  RigEstimate solveJointly(Lock* lock);
  RigEstimate solveFirst(Lock* lock);
  MountVerdict::Kind examine(const KnownRig& known, Lock* lock);
  void conclude(const MountVerdict& verdict, const KnownRig& known);
  std::string doubtText(const MountVerdict& verdict) const;
  void take(RigEstimate estimate);
  std::optional<MountChange> changeSinceSaved(const RigEstimate& estimate, int camera) const;
  void compareWithSaved(const RigEstimate& estimate);
  void remember(const MountChange& change);
  std::string forgottenBaseline();
  std::string amountOf(const MountChange& change, bool metric) const;
  std::string textOf(const MountChange& change, bool metric) const;
  std::string nameOf(int camera) const;
  void judge(RigReport* report) const;

  const RigOptions options_;
  const FindAcross across_;
  mutable std::mutex mutex_;  // for all that follows
  std::vector<CalibrationReport> lenses_;
  std::vector<bool> seen_;  // of each camera whether an image came
  SynchronisedViews views_;
  RigKeyframes keyframes_;
  RigCalibrator calibrator_;
  MountWatch watch_;
  std::optional<KnownRig> known_;
  std::optional<RigEstimate> restored_;     // until a joint solution has taken its place
  bool compared_ = false;                   // with one that did not
  std::optional<double> saved_baseline_m_;  // of what was restored, if none is given
  std::string doubt_;     // whether a camera was moved, in words; empty if there is none
  bool certain_ = false;  // of a doubt: something changed, and it is open what
  std::optional<std::int64_t> first_ns_;  // stamp of the first image
  int new_keyframes_ = 0;                 // since the last solution began
  RigReport report_;                      // all but the verdict
};

}  // namespace camera_self_calibration
