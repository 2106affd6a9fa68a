#include "camera_self_calibration/pipeline/phase.h"

namespace camera_self_calibration {

Phase after(Phase phase, PhaseTrigger trigger) {
  switch (trigger) {
    case PhaseTrigger::kUninformed:
      return isStarting(phase) ? Phase::kNothingKnown : phase;
    case PhaseTrigger::kStartupBetter:
      return isStarting(phase) ? Phase::kStartupLeads : phase;
    case PhaseTrigger::kQueueBetter:
      return isStarting(phase) ? Phase::kQueueLeads : phase;
    case PhaseTrigger::kQueueReady:
      return isStarting(phase) ? Phase::kHandedOver : phase;
    case PhaseTrigger::kRestored:
      return phase == Phase::kNothingKnown ? Phase::kRestored : phase;
    case PhaseTrigger::kConfirmed:
      return phase == Phase::kRestored ? Phase::kHandedOver : phase;
    case PhaseTrigger::kLensChanged:
      return isStarting(phase) || phase == Phase::kHandedOver ? Phase::kNothingKnown : phase;
  }
  return phase;
}

bool isStarting(Phase phase) {
  return phase == Phase::kNothingKnown || phase == Phase::kStartupLeads ||
         phase == Phase::kQueueLeads;
}

bool queueLeads(Phase phase) {
  return phase == Phase::kRestored || phase == Phase::kQueueLeads || phase == Phase::kHandedOver;
}

bool isInformed(Phase phase) { return phase != Phase::kNothingKnown; }

std::string toString(Phase phase) {
  switch (phase) {
    case Phase::kHeld:
      return "HELD";
    case Phase::kRestored:
      return "RESTORED";
    case Phase::kNothingKnown:
      return "NOTHING_KNOWN";
    case Phase::kStartupLeads:
      return "STARTUP_LEADS";
    case Phase::kQueueLeads:
      return "QUEUE_LEADS";
    case Phase::kHandedOver:
      return "HANDED_OVER";
  }
  return "";
}

}  // namespace camera_self_calibration
