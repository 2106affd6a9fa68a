#include "camera_self_calibration/rig_node/rig_camera_info.h"

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {
namespace {

/// Whether two rigs of two cameras rectify differently, by more than so many pixels: lenses, turn,
/// and direction of the baseline (rows of what is as near as RigLimits takes it) or its length.
bool differVisibly(const Rig& a, const Rig& b, double pixels) {
  const RigLimits limits = rigLimits(a.cameras.front());
  const double pixel = convergedRms(0.0, a.cameras.front());
  const Eigen::Vector3d& t_a = a.rig_from_camera[1].translation;
  const Eigen::Vector3d& t_b = b.rig_from_camera[1].translation;
  const double turn =
      logSo3(a.rig_from_camera[1].rotation.conjugate() * b.rig_from_camera[1].rotation).norm();
  return turn > limits.rotation * pixels / pixel ||
         (t_a - t_b).norm() > t_a.norm() * limits.direction * pixels / pixel ||
         pixelDistance(a.cameras[0], b.cameras[0]).rms > pixels ||
         pixelDistance(a.cameras[1], b.cameras[1]).rms > pixels;
}

/// Warnings about what goes out for a pair.
std::vector<std::string> deviations(const StereoPair& pair) {
  std::vector<std::string> warnings;
  const auto judge = [&](int camera, const sensor_msgs::CameraInfo& info, const PixelError& error) {
    if (error.max <= CameraInfoPolicy::kConversionWarning) return;
    warnings.push_back(stereoNote(formatted("The camera_info of camera %d", camera), info, error) +
                       " To have it exact, set the parameter model to equidistant.");
  };
  judge(pair.left, pair.left_info, pair.left_error);
  judge(pair.right, pair.right_info, pair.right_error);
  return warnings;
}

}  // namespace

RigCameraInfo::RigCameraInfo(const CameraInfoOptions& options, const Options& pipeline, int cameras)
    : min_change_px_(options.min_change_px),
      pipeline_(pipeline),
      frames_(static_cast<std::size_t>(cameras)) {
  for (int c = 0; c < cameras; ++c) {
    policies_.push_back(std::make_unique<CameraInfoPolicy>(options));
  }
}

std::vector<std::string> RigCameraInfo::update(const RigReport& report) {
  const std::lock_guard<std::mutex> one_at_a_time(update_mutex_);
  std::vector<std::string> warnings;
  for (std::size_t c = 0; c < policies_.size(); ++c) {
    const CalibrationReport& own = report.cameras[c];
    const std::string warning = policies_[c]->update(
        report.estimate.converged ? withJointIntrinsics(own, report.estimate, static_cast<int>(c),
                                                        pipeline_.convergedRms(own.camera))
                                  : own);
    if (!warning.empty()) warnings.push_back(formatted("camera %zu: ", c) + warning);
  }
  for (const std::string& warning : updatePair(report)) warnings.push_back(warning);
  return warnings;
}

std::vector<std::string> RigCameraInfo::updatePair(const RigReport& report) {
  if (!report.estimate.converged) {
    const std::lock_guard<std::mutex> lock(mutex_);
    pair_.reset();
    why_no_pair_.clear();
    return {};
  }
  if (report.state != CalibrationState::kConverged || report.revision == revision_) return {};
  revision_ = report.revision;
  const Rig& rig = report.estimate.rig;
  if (pair_ && !differVisibly(pair_rig_, rig, min_change_px_)) return {};
  std::string problem;
  const std::optional<StereoPair> pair = stereoPair(rig, &problem);
  const std::lock_guard<std::mutex> lock(mutex_);
  pair_ = pair;
  pair_rig_ = rig;
  why_no_pair_ = problem;
  return pair ? deviations(*pair) : std::vector<std::string>();
}

const sensor_msgs::CameraInfo* RigCameraInfo::ofPair(int camera) const {
  if (!pair_) return nullptr;
  return camera == pair_->left ? &pair_->left_info : &pair_->right_info;
}

void RigCameraInfo::noteFrame(int camera, const std::string& frame) {
  const std::lock_guard<std::mutex> lock(mutex_);
  frames_[camera] = frame;
}

sensor_msgs::CameraInfo RigCameraInfo::infoFor(int camera, const std_msgs::Header& header,
                                               int width, int height) const {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const sensor_msgs::CameraInfo* info = ofPair(camera);
    if (info && static_cast<int>(info->width) == width &&
        static_cast<int>(info->height) == height) {
      sensor_msgs::CameraInfo result = *info;
      result.header = header;
      result.header.frame_id = frames_[pair_->left];
      return result;
    }
  }
  return policies_[camera]->infoFor(header, width, height);
}

std::string RigCameraInfo::stateText(int camera) const {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (const sensor_msgs::CameraInfo* info = ofPair(camera)) {
      return info->distortion_model + ", rectified as the " +
             (camera == pair_->left ? "left" : "right") + " one of a pair";
    }
  }
  const CameraInfoState state = policies_[camera]->state();
  if (!state.obstacle.empty()) return state.obstacle;
  return state.distortion_model.empty() ? "zeros: not calibrated" : state.distortion_model;
}

std::string RigCameraInfo::pairNote() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!pair_ || pair_->left == 0) return why_no_pair_;
  return "camera 1 is the left one: for stereo_image_proc, give its topic first";
}

}  // namespace camera_self_calibration
