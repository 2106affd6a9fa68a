#include "camera_self_calibration/tools/interruption.h"

#include <csignal>

namespace camera_self_calibration {
namespace {

volatile std::sig_atomic_t signal_came = 0;

void noteSignal(int) { signal_came = 1; }

}  // namespace

void catchInterruption() {
  struct sigaction action = {};
  action.sa_handler = noteSignal;
  // Reads that are under way go on; the second signal finds the default.
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return signal_came != 0; }

}  // namespace camera_self_calibration
