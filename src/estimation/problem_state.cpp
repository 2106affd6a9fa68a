#include "problem_state.h"

#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/geometry/so3.h"

namespace camera_self_calibration {

void ProblemState::save(const Problem& problem) {
  camera_ = *problem.camera;
  keyframes_.resize(problem.blocks.size());
  landmarks_.resize(problem.blocks.size());
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    keyframes_[i] = problem.blocks[i].segment->keyframes;
    landmarks_[i] = problem.blocks[i].segment->landmarks;
  }
}

void ProblemState::restore(const Problem& problem) const {
  *problem.camera = camera_;
  for (std::size_t i = 0; i < problem.blocks.size(); ++i) {
    problem.blocks[i].segment->keyframes = keyframes_[i];
    problem.blocks[i].segment->landmarks = landmarks_[i];
  }
}

void applyStep(const SegmentBlock& block, const Eigen::Ref<const Eigen::VectorXd>& own) {
  Segment& segment = *block.segment;
  int row = 0;
  for (std::size_t k = block.fixed_keyframes; k < segment.keyframes.size(); ++k, row += 6) {
    Rigid3& pose = segment.keyframes[k].world_from_camera;
    pose.translation += own.segment<3>(row);
    pose.rotation = (pose.rotation * expSo3(own.segment<3>(row + 3))).normalized();
  }
  for (std::size_t l = 0; l < segment.landmarks.size(); ++l) {
    Landmark& landmark = segment.landmarks[l];
    if (static_cast<int>(l) != block.fixed_landmark) landmark.inverse_depth += own(row++);
    if (landmark.anchored) continue;
    turnBearing(own.segment<2>(row), &landmark);
    row += 2;
  }
}

void turnBearing(const Eigen::Vector2d& step, Landmark* landmark) {
  landmark->bearing = (landmark->bearing + tangentBasis(landmark->bearing) * step).normalized();
}

bool applyStep(const Intrinsics& step, Camera* camera) {
  if (step.size() == 0) return true;
  Intrinsics parameters = camera->parameters();
  parameters.head(step.size()) += step;
  camera->setParameters(parameters);
  return camera->valid();
}

}  // namespace camera_self_calibration
