#include "camera_self_calibration/tools/simulation_options.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/camera/image_size.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/tum_file.h"

namespace camera_self_calibration {
namespace {

/// Those of one camera of a rig stand in the namespace of its name, where they differ from what all
/// have in common.
class CameraParameters {
 public:
  CameraParameters(const ros::NodeHandle& common, const std::string& name) : common_(common) {
    if (!name.empty()) own_ = ros::NodeHandle(common, name);
  }

  template <typename T>
  T param(const std::string& name, const T& fallback) const {
    const T common = common_.param(name, fallback);
    return own_ ? own_->param(name, common) : common;
  }

 private:
  ros::NodeHandle common_;
  std::optional<ros::NodeHandle> own_;
};

/// The lens of a camera by parameters; a wide one by default.
Camera readCamera(const CameraParameters& node) {
  const auto name = node.param<std::string>("model", "fov");
  const std::optional<CameraModel> model = cameraModelFromString(name);
  if (!model) {
    throw std::runtime_error("model is '" + name +
                             "'; it must be pinhole, fov, radtan (or plumb_bob) or equidistant");
  }
  const int width = node.param("width", 640);
  const int height = node.param("height", 480);
  const auto values = node.param("intrinsics", std::vector<double>());
  if (!values.empty()) {
    return Camera(
        *model, width, height,
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
  }
  // Not the guess that a calibration starts from: other focal lengths, centre and distortion.
  const Camera guess = Camera::defaultGuess(*model, width, height);
  Intrinsics lens = guess.parameters();
  const double side = longerSide(width, height);
  lens.head<2>() = Eigen::Vector2d(0.553, 0.551) * side;
  lens[2] += 0.011 * side;
  lens[3] -= 0.009 * side;
  if (*model == CameraModel::kFov) lens[4] = 0.91;
  if (*model == CameraModel::kRadtan) lens.segment<2>(4) << -0.21, 0.04;
  if (*model == CameraModel::kEquidistant) lens.segment<2>(4) << -0.03, 0.004;
  return Camera(*model, width, height, lens);
}

void readMotion(const CameraParameters& node, SequenceOptions* sequence) {
  const auto seed = static_cast<std::uint64_t>(node.param("seed", 1));
  sequence->room.seed = seed;
  sequence->motion.seed = seed;
  sequence->noise_seed = seed;
  const auto kind = node.param<std::string>("motion", "handheld");
  const std::optional<MotionKind> motion = motionKindFromString(kind);
  if (!motion) {
    throw std::runtime_error("motion is '" + kind +
                             "'; it must be handheld, planar, yaw_driving, rotation_only, "
                             "forward_only, sideways_only or still");
  }
  sequence->motion.kind = *motion;
  sequence->motion.speed = node.param("speed", sequence->motion.speed);
  sequence->rate_hz = node.param("rate", sequence->rate_hz);
  sequence->duration_s = node.param("duration", sequence->duration_s);
  sequence->renderer.line_delay_s =
      node.param("readout", 0.0) / std::max(1, sequence->lens.camera.height() - 1);
  sequence->renderer.exposure_s = node.param("exposure", sequence->renderer.exposure_s);
  // A recorded trajectory in place of the synthetic one.
  const auto file = node.param<std::string>("trajectory", "");
  if (file.empty()) return;
  RealMotionOptions real;
  real.fit_into = makeRoom(sequence->room).free_space;
  sequence->trajectory = realMotion(readTum(file), real);
}

// What spoils the images of an otherwise good scene.
void readDisturbances(const CameraParameters& node, SequenceOptions* sequence) {
  const double moving = node.param("moving_share", 0.0);
  const double carried = node.param("carried_share", 0.0);
  if (moving != 0.0 && carried != 0.0) {
    throw std::runtime_error("moving_share and carried_share are both given; leave one of them 0");
  }
  sequence->objects.share = moving + carried;
  sequence->objects.carried = carried != 0.0;
  sequence->objects.seed = sequence->noise_seed;
  sequence->text_overlay = node.param("text_overlay", sequence->text_overlay);
  sequence->auto_exposure = node.param("auto_exposure", sequence->auto_exposure);
}

/// x, y, z [m], then a rotation vector [degrees].
Rigid3 readMotionOf(const CameraParameters& node, const std::string& name) {
  const auto values = node.param(name, std::vector<double>(6, 0.0));
  const auto finite = [](double value) { return std::isfinite(value); };
  if (values.size() != 6 || !std::all_of(values.begin(), values.end(), finite)) {
    throw std::runtime_error(name + " must hold x, y, z [m] and a rotation vector [degrees]");
  }
  const Eigen::Map<const Vector6d> motion(values.data());
  return {expSo3(kDegree * motion.tail<3>()), motion.head<3>()};
}

void readMount(const CameraParameters& node, Mount* mount) {
  mount->body_from_camera = readMotionOf(node, "mount");
  mount->bump = readMotionOf(node, "bump");
  mount->bump_at_s = node.param("bump_at", mount->bump_at_s);
  mount->late_s = node.param("late", mount->late_s);
  const bool bumped = mount->bump.translation.norm() + logSo3(mount->bump.rotation).norm() > 0.0;
  if (bumped && !std::isfinite(mount->bump_at_s)) {
    throw std::runtime_error("bump needs a time: give bump_at [s]");
  }
  if (!std::isfinite(mount->late_s)) throw std::runtime_error("late must be a number of seconds");
}

void check(const SimulationOptions& options) {
  std::vector<std::string> problems = options.sequence.problems();
  if (!options.sequence.lens.camera.valid()) {
    problems.push_back("intrinsics are out of range for the model");
  }
  if (!(options.wait_limit_s > 0.0)) problems.push_back("wait_limit must be positive");
  if (problems.empty()) return;
  std::string text;
  for (const std::string& problem : problems) text += "\n  - " + problem;
  throw std::runtime_error("the parameters cannot be used:" + text);
}

SimulationOptions readCameraOptions(const ros::NodeHandle& private_node, const std::string& name) {
  const CameraParameters node(private_node, name);
  SimulationOptions options;
  options.name = name;
  options.sequence.lens.camera = readCamera(node);
  // On one body, in one room.
  const CameraParameters common(private_node, "");
  readMotion(common, &options.sequence);
  readDisturbances(common, &options.sequence);
  if (!name.empty() && options.sequence.objects.share > 0.0) {
    throw std::runtime_error(
        "moving_share and carried_share are for one camera; leave out cameras");
  }
  readMount(node, &options.sequence.mount);
  options.frame_id = node.param("frame_id", name.empty() ? options.frame_id : name);
  options.world_frame = node.param("world_frame", options.world_frame);
  options.publish_clock = node.param("publish_clock", options.publish_clock);
  options.wait_for = node.param("wait_for", options.wait_for);
  options.image_subscribers = node.param("image_subscribers", options.image_subscribers);
  options.wait_limit_s = node.param("wait_limit", options.wait_limit_s);
  check(options);
  return options;
}

}  // namespace

std::vector<SimulationOptions> readSimulationOptions(const ros::NodeHandle& private_node) {
  const auto names = private_node.param("cameras", std::vector<std::string>());
  if (names.empty()) return {readCameraOptions(private_node, "")};
  std::vector<SimulationOptions> cameras;
  for (const std::string& name : names) {
    cameras.push_back(readCameraOptions(private_node, name));
    SimulationOptions& camera = cameras.back();
    camera.sequence.noise_seed += cameras.size() - 1;  // each has its own
    camera.publish_clock = camera.publish_clock && cameras.size() == 1;
    if (camera.wait_for.empty()) continue;
    throw std::runtime_error("wait_for is for one camera; leave out cameras");
  }
  return cameras;
}

}  // namespace camera_self_calibration
