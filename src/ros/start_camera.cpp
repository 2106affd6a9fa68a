#include "camera_self_calibration/ros/start_camera.h"

namespace camera_self_calibration {

StartDecision StartCamera::decide(int width, int height, const ros::WallTime& now) {
  if (first_width_ == 0) {
    first_width_ = width;
    first_height_ = height;
  }
  StartDecision decision;
  if (factory_ != nullptr && options_->camera_info_input == "initial") {
    decision = fromFactory(width, height, now);
  }
  if (!decision.wait && !decision.camera) decision.camera = fromParameters(width, height);
  return decision;
}

StartDecision StartCamera::fromFactory(int width, int height, const ros::WallTime& now) {
  StartDecision decision;
  if (begin_.isZero()) begin_ = now;
  decision.wait = !factory_->heard() && (now - begin_).toSec() < kPatience;
  if (decision.wait) return decision;
  decision.camera = factory_->startFor(options_->pipeline.model, width, height, &decision.sentence);
  decision.warning = !decision.camera;
  decision.sentence = decision.camera
                          ? "the calibration starts from the factory's on " + factory_->topic()
                          : decision.sentence + " The calibration starts without it.";
  return decision;
}

std::optional<Camera> StartCamera::fromParameters(int width, int height) const {
  const std::vector<double>& values = options_->initial_intrinsics;
  if (values.empty() || width != first_width_ || height != first_height_) return std::nullopt;
  return Camera(
      options_->pipeline.firstModel(), width, height,
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
}

}  // namespace camera_self_calibration
