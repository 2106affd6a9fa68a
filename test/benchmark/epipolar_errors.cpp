#include "benchmark/epipolar_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/tools/calibration_file.h"

namespace camera_self_calibration {
namespace {

constexpr double kSameMoment = 1e-3;  // [s] Between a pose and an image.
constexpr double kGross = 1.0;        // [px]
// [px] What the detection's ray moves by, at least, for the line to have a direction.
constexpr double kLeastParallax = 2.0;

const Rigid3* poseAt(const std::vector<StampedPose>& poses, std::int64_t stamp_ns) {
  const double time = toSeconds(stamp_ns);
  const auto next =
      std::lower_bound(poses.begin(), poses.end(), time - kSameMoment,
                       [](const StampedPose& pose, double value) { return pose.time_s < value; });
  const bool there = next != poses.end() && next->time_s <= time + kSameMoment;
  return there ? &next->world_from_body : nullptr;
}

}  // namespace

EpipolarErrors::EpipolarErrors(const std::string& calibration, const std::string& poses)
    : camera_(readCalibrationFile(calibration)), poses_(readTum(poses)) {}

void EpipolarErrors::add(std::int64_t stamp_ns, const std::vector<Track>& tracks) {
  const Rigid3* pose = poseAt(poses_, stamp_ns);
  if (pose == nullptr) return;
  for (const Track& track : tracks) {
    const auto known = detections_.find(track.id);
    if (known == detections_.end()) {
      const auto ray = camera_.unproject(track.pixel);
      if (ray) detections_[track.id] = {*pose, *ray};
      continue;
    }
    const Rigid3 here_from_there = pose->inverse() * known->second.world_from_camera;
    const Eigen::Vector3d far_ray = here_from_there.rotation * known->second.ray;
    // The line through the point at infinity, along what a nearer one moves by.
    Eigen::Vector2d far, nearer;
    const double baseline = here_from_there.translation.norm();
    const Eigen::Vector3d near_ray = far_ray + 0.5 * here_from_there.translation / baseline;
    if (!(baseline > 0.0) || !camera_.project(far_ray, &far) ||
        !camera_.project(near_ray, &nearer) || (nearer - far).norm() < kLeastParallax) {
      continue;
    }
    // Curved under distortion: taken where it comes nearest, in rays.
    const auto seen = camera_.unproject(track.pixel);
    if (!seen) continue;
    const Eigen::Vector3d normal = far_ray.cross(here_from_there.translation).normalized();
    Eigen::Vector2d on_line;
    if (!camera_.project(*seen - normal.dot(*seen) * normal, &on_line)) continue;
    const double error = (track.pixel - on_line).norm();
    lengths_.push_back(error);
    if (error > kGross) continue;
    ++fair_;
    z2_ += error * error / (track.sigma * track.sigma);
  }
}

double EpipolarErrors::median() const {
  return camera_self_calibration::median(lengths_, std::numeric_limits<double>::quiet_NaN());
}

double EpipolarErrors::outlierShare() const {
  return 1.0 - static_cast<double>(fair_) / static_cast<double>(lengths_.size());
}

double EpipolarErrors::rmsZ() const { return std::sqrt(z2_ / static_cast<double>(fair_)); }

}  // namespace camera_self_calibration
