#include "camera_self_calibration/pipeline/phase.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <utility>
#include <vector>

namespace camera_self_calibration {
namespace {

using Trigger = PhaseTrigger;

constexpr Phase kPhases[] = {Phase::kHeld,         Phase::kRestored,   Phase::kNothingKnown,
                             Phase::kStartupLeads, Phase::kQueueLeads, Phase::kHandedOver};
constexpr Trigger kTriggers[] = {
    Trigger::kUninformed, Trigger::kStartupBetter, Trigger::kQueueBetter, Trigger::kQueueReady,
    Trigger::kRestored,   Trigger::kConfirmed,     Trigger::kLensChanged};

// Every transition there is; whatever is not listed leaves the phase as it is.
TEST(Phase, HasTheseTransitionsAndNoOthers) {
  std::map<std::pair<Phase, Trigger>, Phase> table = {
      {{Phase::kRestored, Trigger::kConfirmed}, Phase::kHandedOver},
      {{Phase::kNothingKnown, Trigger::kRestored}, Phase::kRestored},
      {{Phase::kHandedOver, Trigger::kLensChanged}, Phase::kNothingKnown},
  };
  for (const Phase starting : {Phase::kNothingKnown, Phase::kStartupLeads, Phase::kQueueLeads}) {
    table[{starting, Trigger::kUninformed}] = Phase::kNothingKnown;
    table[{starting, Trigger::kStartupBetter}] = Phase::kStartupLeads;
    table[{starting, Trigger::kQueueBetter}] = Phase::kQueueLeads;
    table[{starting, Trigger::kQueueReady}] = Phase::kHandedOver;
    table[{starting, Trigger::kLensChanged}] = Phase::kNothingKnown;
  }
  for (const Phase phase : kPhases) {
    for (const Trigger trigger : kTriggers) {
      const auto found = table.find({phase, trigger});
      const Phase expected = found == table.end() ? phase : found->second;
      EXPECT_EQ(after(phase, trigger), expected)
          << toString(phase) << ", trigger " << static_cast<int>(trigger);
    }
  }
}

TEST(Phase, EachButHeldIntrinsicsCanBeLeft) {
  for (const Phase phase : kPhases) {
    std::set<Phase> next;
    for (const Trigger trigger : kTriggers) next.insert(after(phase, trigger));
    next.erase(phase);
    EXPECT_EQ(next.empty(), phase == Phase::kHeld) << toString(phase);
  }
}

TEST(Phase, TellsWhoseIntrinsicsCount) {
  const std::vector<bool> starting = {false, false, true, true, true, false};
  const std::vector<bool> queue = {false, true, false, false, true, true};
  const std::vector<bool> informed = {true, true, false, true, true, true};
  for (std::size_t i = 0; i < starting.size(); ++i) {
    EXPECT_EQ(isStarting(kPhases[i]), starting[i]) << toString(kPhases[i]);
    EXPECT_EQ(queueLeads(kPhases[i]), queue[i]) << toString(kPhases[i]);
    EXPECT_EQ(isInformed(kPhases[i]), informed[i]) << toString(kPhases[i]);
  }
}

}  // namespace
}  // namespace camera_self_calibration
