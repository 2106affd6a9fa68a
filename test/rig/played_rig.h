#pragma once

#include <functional>

#include "camera_self_calibration/rig/rig_session.h"
#include "rig/simulated_rig.h"

namespace camera_self_calibration {

/// What a camera that knows its lens reports of it.
CalibrationReport knownLens(const Camera& camera, std::uint64_t epoch = 0);

/// What a camera makes of its image of a keyframe.
FrameResult resultOf(const RigFrame& frame, int camera);

/// Gives a session all keyframes of a simulated rig, whose cameras know their lenses as `lenses`,
/// and lets it work whenever it asks to, as RigSelfCalibrator does; `told` hears each report. The
/// lenses stay known as they are, whatever happens to them.
void play(const SimulatedRig& rig, const std::vector<Camera>& lenses, RigSession* session,
          const std::function<void(const RigReport&)>& told = nullptr);

/// The same, where all work comes last, as offline; the last report.
RigReport playThenSolve(const SimulatedRig& rig, const std::vector<Camera>& lenses,
                        RigSession* session);

}  // namespace camera_self_calibration
