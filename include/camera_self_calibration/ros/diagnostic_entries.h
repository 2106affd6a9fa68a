#pragma once

#include <diagnostic_updater/DiagnosticStatusWrapper.h>

#include <optional>
#include <string>

#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/ros/camera_info_policy.h"
#include "camera_self_calibration/ros/factory_calibration.h"
#include "camera_self_calibration/ros/input_monitor.h"

namespace camera_self_calibration {

// The entries of /diagnostics, each as a function of what it rests on. Words that only the manual
// explains are explained where they appear.

/// The newest event of the tracking or of the calibration, if there was one.
void addEvent(const std::optional<Event>& event,
              diagnostic_updater::DiagnosticStatusWrapper* status);

/// What the newest image came to. `frame_problem`: why no transform goes out; empty if nothing
/// hinders it.
void judgeTracking(const FrameResult& frame, const std::string& frame_problem,
                   diagnostic_updater::DiagnosticStatusWrapper* status);

/// What is known of the lens, and which CameraInfo goes out.
void describeCalibration(const CalibrationReport& report, const CameraInfoState& info,
                         const std::optional<Event>& event,
                         diagnostic_updater::DiagnosticStatusWrapper* status);

/// What the calibration rests on.
void describeQueue(const QueueReport& queue, diagnostic_updater::DiagnosticStatusWrapper* status);

/// What the driver's own calibration is worth.
void describeFactory(const FactoryAudit& factory,
                     diagnostic_updater::DiagnosticStatusWrapper* status);

/// Whether images arrive and are processed in time, from counts now and at the last report;
/// `dropped` since then, because processing was too slow. Only the most urgent is said.
void judgeTiming(const InputCounts& now, const InputCounts& before, std::int64_t dropped,
                 diagnostic_updater::DiagnosticStatusWrapper* status);

}  // namespace camera_self_calibration
