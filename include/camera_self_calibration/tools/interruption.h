#pragma once

namespace camera_self_calibration {

/// From now on the first Ctrl-C (SIGINT) or SIGTERM only asks the program to come to an end;
/// another one ends it at once, as by default.
void catchInterruption();

/// Whether one has come.
bool interrupted();

}  // namespace camera_self_calibration
