#include "camera_self_calibration/ros/start_camera.h"

#include "camera_self_calibration/camera/plausibility.h"

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
  if (decision.wait || decision.camera) return decision;
  const StartDecision given = fromParameters(width, height);
  decision.camera = given.camera;
  if (!given.sentence.empty()) {
    decision.sentence += (decision.sentence.empty() ? "" : " ") + given.sentence;
    decision.warning = true;
  }
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

StartDecision StartCamera::fromParameters(int width, int height) const {
  StartDecision decision;
  if (width != first_width_ || height != first_height_) return decision;
  decision.camera =
      startFromParameters(options_->pipeline.firstModel(), options_->initial_intrinsics, width,
                          height, &decision.sentence);
  return decision;
}

std::optional<Camera> startFromParameters(CameraModel model, const std::vector<double>& values,
                                          int width, int height, std::string* problem) {
  if (values.empty()) return std::nullopt;
  const Camera camera(
      model, width, height,
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  const std::string why = implausibility(camera);
  if (why.empty()) return camera;
  *problem = "The parameter initial_intrinsics is not used: " + why +
             ". The calibration starts from a guess.";
  return std::nullopt;
}

}  // namespace camera_self_calibration
