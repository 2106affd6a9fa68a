#pragma once

#include <memory>
#include <optional>

#include "camera_self_calibration/lens_change/recheck.h"
#include "camera_self_calibration/pipeline/back_end.h"
#include "camera_self_calibration/pipeline/back_end_report.h"

namespace camera_self_calibration {

/// A BackEnd that may begin with a saved state: converged at once, and re-checked. Until the new
/// images determine the lens, a second BackEnd learns from them alone. If both agree the saved
/// state goes on, with the new segments; if not, it is discarded, the lens counts as changed, and
/// learning goes on with what the new images said.
class CheckedBackEnd {
 public:
  /// Counts on from `counters`.
  CheckedBackEnd(const Options& options, const Beginning& beginning, const Counters& counters = {});

  /// Forgets everything but the revision, which goes on.
  void beginAgain(const Beginning& beginning);

  /// `frozen`: the calibration stays as it is, whatever the keyframe says.
  BackEndOutput process(const KeyframeMessage& message, bool frozen);

  /// All that was learnt; nothing until the queue has taken over.
  std::shared_ptr<const LearntState> state() const { return learntStateOf(main_.state()); }

 private:
  void check(const KeyframeMessage& message, BackEndOutput* output);
  void confirm(const Recheck& recheck, BackEndOutput* output);
  void discardRestored(const Recheck& recheck, BackEndOutput fresh, BackEndOutput* output);

  Options options_;
  BackEnd main_;
  std::unique_ptr<BackEnd> fresh_;  // while a saved state is being checked
  std::int64_t first_stamp_ns_ = 0;
  int contradictions_ = 0;  // in a row
};

}  // namespace camera_self_calibration
