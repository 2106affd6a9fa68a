#include "rig/played_rig.h"

namespace camera_self_calibration {

CalibrationReport knownLens(const Camera& camera, std::uint64_t epoch) {
  CalibrationReport report;
  report.state = CalibrationState::kConverged;
  report.camera = camera;
  report.handed_over = true;
  report.epoch = epoch;
  return report;
}

FrameResult resultOf(const RigFrame& frame, int camera) {
  const RigView& view = frame.views[static_cast<std::size_t>(camera)];
  FrameResult result;
  result.stamp_ns = frame.stamp_ns;
  result.state = TrackingState::kTracking;
  result.is_keyframe = true;
  result.tracks.tracks = view.tracks;
  result.world_from_camera = *view.world_from_camera;
  return result;
}

namespace {

void tellLenses(const std::vector<Camera>& lenses, RigSession* session) {
  for (std::size_t c = 0; c < lenses.size(); ++c) {
    session->update(static_cast<int>(c), knownLens(lenses[c]));
  }
}

void add(const RigFrame& frame, RigSession* session) {
  for (std::size_t c = 0; c < frame.views.size(); ++c) {
    session->add(static_cast<int>(c), resultOf(frame, static_cast<int>(c)));
  }
}

}  // namespace

void play(const SimulatedRig& rig, const std::vector<Camera>& lenses, RigSession* session,
          const std::function<void(const RigReport&)>& told) {
  tellLenses(lenses, session);
  const auto tell = [&](const RigReport& report) {
    if (told) told(report);
  };
  for (const RigFrame& frame : rig.frames) {
    add(frame, session);
    if (session->due()) tell(session->solve());
    if (session->mountsDue()) tell(session->examineMounts());
  }
}

RigReport playThenSolve(const SimulatedRig& rig, const std::vector<Camera>& lenses,
                        RigSession* session) {
  tellLenses(lenses, session);
  for (const RigFrame& frame : rig.frames) add(frame, session);
  std::size_t changes = 0;
  RigReport report = session->solve();
  for (; report.mount_changes.size() > changes; report = session->solve()) {
    changes = report.mount_changes.size();
  }
  return report;
}

}  // namespace camera_self_calibration
