#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <string>

#include "camera_self_calibration/rig/rig_session.h"

namespace camera_self_calibration {

/// What /diagnostics says beside the report. Empty where there is nothing to say.
struct RigRemarks {
  std::string input;    ///< What an operator has to do about the images.
  std::string failure;  ///< Why the newest saving failed.
  std::string pair;     ///< RigCameraInfo::pairNote.
};

/// The one verdict on a rig.
void addVerdict(const RigReport& report, const RigRemarks& remarks,
                diagnostic_updater::DiagnosticStatusWrapper* status);

}  // namespace camera_self_calibration
