#include "camera_self_calibration/simulation/mount.h"

namespace camera_self_calibration {

Trajectory mounted(const Trajectory& body, const Mount& mount) {
  const Rigid3 after = mount.body_from_camera * mount.bump;
  return Trajectory(
      [body, mount, after](double time_s) {
        return body.worldFromCamera(time_s + mount.late_s) *
               (time_s < mount.bump_at_s ? mount.body_from_camera : after);
      },
      body.duration());
}

}  // namespace camera_self_calibration
