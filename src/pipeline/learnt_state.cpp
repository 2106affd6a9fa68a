#include "camera_self_calibration/pipeline/learnt_state.h"

#include <cmath>

#include "camera_self_calibration/camera/image_size.h"

namespace camera_self_calibration {
namespace {

bool within(int index, std::size_t size) {
  return index >= 0 && static_cast<std::size_t>(index) < size;
}

bool isFinite(const RowShift& shift) {
  return shift.shift.allFinite() && shift.motion.velocity.allFinite() &&
         shift.motion.acceleration.allFinite();
}

bool isSound(const Segment& segment) {
  for (const Keyframe& keyframe : segment.keyframes) {
    const Rigid3& pose = keyframe.world_from_camera;
    if (!(std::abs(pose.rotation.norm() - 1.0) < 1e-6) || !pose.translation.allFinite()) {
      return false;
    }
  }
  for (const Landmark& landmark : segment.landmarks) {
    if (!within(landmark.reference, segment.keyframes.size()) ||
        !landmark.reference_pixel.allFinite() || !isFinite(landmark.reference_shift) ||
        !std::isfinite(landmark.inverse_depth) ||
        !(std::abs(landmark.bearing.norm() - 1.0) < 1e-6)) {
      return false;
    }
  }
  for (const Observation& observation : segment.observations) {
    if (!isFinite(observation.shift) || !within(observation.landmark, segment.landmarks.size()) ||
        !within(observation.keyframe, segment.keyframes.size()) || !observation.pixel.allFinite() ||
        !(observation.sigma > 0.0)) {
      return false;
    }
  }
  for (const Camera& lens : segment.held_lenses) {
    if (!lens.valid()) return false;
  }
  return !segment.keyframes.empty() && !segment.observations.empty();
}

bool isSound(const Candidate& candidate, const Camera& camera) {
  return isSound(candidate.segment) && candidate.camera.valid() &&
         candidate.information.rows() == camera.estimatedCount() &&
         candidate.information.cols() == camera.estimatedCount() &&
         candidate.information.allFinite() && candidate.sigma_scale > 0.0 &&
         std::isfinite(candidate.cost) && std::isfinite(candidate.entropy);
}

bool isSound(const BagRecord& record) {
  const int count = record.lens.estimatedCount();
  for (const SegmentMark& mark : record.segments) {
    if (std::isnan(mark.entropy)) return false;  // segments are sorted by it
  }
  return record.lens.valid() && isImageSize(record.lens.width(), record.lens.height()) &&
         record.covariance.rows() == count && record.covariance.cols() == count &&
         record.covariance.allFinite() && record.covariance.diagonal().minCoeff() > 0.0 &&
         record.scatter.freedom >= 0 && record.begin_ns <= record.end_ns &&
         std::isfinite(record.scatter.chi_square) && record.uncertainty_px >= 0.0 &&
         record.misfit_px >= 0.0 && std::isfinite(record.uncertainty_px) &&
         std::isfinite(record.misfit_px) && std::abs(record.line_delay_s) < 1.0 &&
         record.line_delay_sigma_s >= 0.0;
}

}  // namespace

std::vector<std::string> LearntState::problems() const {
  std::vector<std::string> list;
  if (!camera.valid() || !isImageSize(camera.width(), camera.height())) {
    list.push_back("its camera is not valid");
    return list;
  }
  if (!(std::abs(line_delay_s) < 1.0) || !(line_delay_sigma_s >= 0.0)) {
    list.push_back("its time between image rows is not sound");
  }
  if (segments.empty()) list.push_back("it holds no segment of video");
  for (const Candidate& candidate : segments) {
    if (isSound(candidate, camera)) continue;
    list.push_back("its segment " + std::to_string(candidate.segment.sequence) + " is not sound");
  }
  for (const BagRecord& record : bags) {
    if (!isSound(record)) list.push_back("its record of the bag " + record.bag + " is not sound");
  }
  return list;
}

}  // namespace camera_self_calibration
