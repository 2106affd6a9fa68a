#pragma once

#include <string>

namespace camera_self_calibration {

/// Whose intrinsics the back end reports and sends to the front end.
enum class Phase {
  kHeld,          ///< Given ones, which are exact: nothing is learnt.
  kRestored,      ///< A saved queue's, until new images confirm it (else it is discarded).
  kNothingKnown,  ///< The startup batch's, which is not informative yet.
  kStartupLeads,  ///< The startup batch's.
  kQueueLeads,    ///< The queue's, which the startup batch may still overtake.
  kHandedOver     ///< The queue's, until the lens changes.
};

/// What ends a phase.
enum class PhaseTrigger {
  kUninformed,     ///< Neither the startup batch nor the queue determines the lens.
  kStartupBetter,  ///< The startup batch has the smaller uncertainty.
  kQueueBetter,    ///< The queue is trusted, and has it.
  kQueueReady,     ///< The queue is good enough to stay: hand-over.
  kRestored,       ///< There is a saved queue.
  kConfirmed,      ///< New images agree with it.
  kLensChanged     ///< What was learnt belongs to another lens.
};

/// Every transition of the back end. A trigger that does not concern a phase leaves it as it is.
Phase after(Phase phase, PhaseTrigger trigger);

/// Startup: before hand-over.
bool isStarting(Phase phase);
/// The intrinsics are those of the queue.
bool queueLeads(Phase phase);
/// Something is known of the lens, so that a candidate has where to start from.
bool isInformed(Phase phase);

/// "HELD", "RESTORED", "NOTHING_KNOWN", "STARTUP_LEADS", "QUEUE_LEADS", "HANDED_OVER".
std::string toString(Phase phase);

}  // namespace camera_self_calibration
