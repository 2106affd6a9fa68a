#pragma once

#include <string>
#include <vector>

#include "camera_self_calibration/fleet/camera_history.h"
#include "camera_self_calibration/fleet/epoch_solution.h"
#include "camera_self_calibration/fleet/siblings.h"

namespace camera_self_calibration {

/// What a bag is worth to the calibration of its camera.
struct BagWorth {
  int segments = 0;     ///< In the merged queue of its epoch.
  double growth = 0.0;  ///< Share by which the error would grow without them (rms over the image).
};

/// The lens of one epoch.
struct EpochResult {
  bool solved = false;
  Camera lens;
  EpochSolution solution;  ///< Without `learnt`, which is on disk.
  /// What the calibration file has in place of the lens, a sentence; empty if it has the lens.
  std::string approximation;
};

struct CameraResult {
  CameraHistory history;
  std::vector<EpochResult> epochs;
  std::vector<BagWorth> worth;  ///< Of each bag.
  SiblingVerdict siblings;

  const EpochResult& present() const { return epochs.back(); }
};

/// The one word for a camera.
enum class CameraVerdict {
  kSteady,   ///< One lens in all bags, known well enough.
  kChanged,  ///< Several lenses, one after the other; the last is known well enough.
  kOutlier,  ///< Differs from its siblings.
  kVague,    ///< The present lens is not known well enough.
  kUnknown   ///< No solution.
};

/// "STEADY", "CHANGED", "OUTLIER", "VAGUE", "UNKNOWN".
std::string toString(CameraVerdict verdict);
CameraVerdict verdictOf(const CameraResult& camera);
/// All that there is to say, in sentences: quality, changes with dates, approximations in files,
/// stray bags, siblings.
std::string sentenceOf(const CameraResult& camera);

/// "2026-03-01 17:05 UTC", or "12.3 s" on a clock that was never set.
std::string timeText(std::int64_t stamp_ns);

/// "p = 3e-05".
std::string pText(double p_value);

/// The name of a camera as that of a file: robot7/front is one in a folder. What a path cannot hold
/// or would lead elsewhere is replaced.
std::string fileStem(const std::string& camera);

/// Throws std::runtime_error if writeCamera would replace or remove what is not the result of an
/// earlier merge: the state of a single bag that one of the histories rests on, or a file of
/// somebody else.
void refuseToReplaceOthers(const std::vector<CameraHistory>& histories, const std::string& folder);

/// Solves all epochs of a camera and writes NAME.yaml (if CONVERGED), NAME.state and
/// NAME.history.csv into the folder; earlier epochs as NAME.epoch1.yaml and NAME.epoch1.state, ...
/// Those of an earlier run are removed at the end; its states only if every epoch has a solution.
/// Throws std::runtime_error if a file cannot be written.
CameraResult writeCamera(const CameraHistory& history, const SegmentStore& store,
                         const MergeOptions& options, const std::string& folder);

/// fleet.json (all verdicts) and bags.csv (what each bag is worth).
void writeFleet(const std::vector<CameraResult>& cameras, const std::string& folder);

}  // namespace camera_self_calibration
