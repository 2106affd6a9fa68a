#pragma once

#include <exception>
#include <functional>
#include <string>

namespace camera_self_calibration {

/// Runs `work` of a thread, or of a callback: nothing that goes wrong in it may end the process
/// that hosts the thread. `report` is told what did.
inline void guarded(const std::function<void()>& work,
                    const std::function<void(const std::string&)>& report) noexcept {
  try {
    try {
      work();
    } catch (const std::exception& error) {
      report(error.what());
    } catch (...) {
      report("an exception of unknown type");
    }
  } catch (...) {
    // Who listens failed itself: there is nobody left to tell.
  }
}

}  // namespace camera_self_calibration
