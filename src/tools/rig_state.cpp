#include "camera_self_calibration/tools/rig_state.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "camera_self_calibration/base/decompositions.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/image_size.h"
#include "camera_self_calibration/camera/plausibility.h"
#include "camera_self_calibration/tools/json.h"

namespace camera_self_calibration {
namespace {

constexpr const char* kFormat = "camera_self_calibration rig 1";
constexpr std::size_t kMostCameras = 6;
constexpr std::size_t kMostBytes = 1 << 20;
constexpr double kLongest = 1e3 * kLongestBaseline;  // of a position: others may be farther away
// Of the numbers of a rotation, and of eigenvalues that are 0.
constexpr double kRounding = 1e-6;

template <typename Matrix>
Json numbers(const Matrix& matrix) {
  Json list = Json::array();
  for (const double value : matrix.reshaped()) list.push_back(value);
  return list;
}

std::int64_t whole(const Json& json) {
  if (!json.is_number_integer()) throw std::runtime_error("a number is not whole");
  return json.get<std::int64_t>();
}

/// Throws where there are not as many numbers as `matrix` holds.
template <typename Matrix>
void read(const Json& list, Matrix* matrix) {
  const auto values = list.get<std::vector<double>>();
  if (static_cast<Eigen::Index>(values.size()) != matrix->size()) {
    throw std::runtime_error("a list of numbers has the wrong length");
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    (*matrix)(static_cast<Eigen::Index>(i)) = values[i];
  }
  if (!matrix->allFinite()) throw std::runtime_error("a number is not finite");
}

int count(const Json& json) {
  const std::int64_t number = whole(json);
  if (number < 0 || number > std::numeric_limits<int>::max()) {
    throw std::runtime_error("a count is none");
  }
  return static_cast<int>(number);
}

template <typename Matrix>
void readCovariance(const Json& list, Matrix* matrix) {
  read(list, matrix);
  const Eigen::MatrixXd own = *matrix;
  const double size = own.norm();
  const bool symmetric = (own - own.transpose()).norm() <= kRounding * size;
  if (own.size() == 0) return;
  const double least = symmetricEigenvalues(own)(0);
  if (!symmetric || !(least >= -kRounding * size)) {
    throw std::runtime_error("a covariance is none");
  }
}

// Of unit length, and unchanged where it is: what is written again reads the same.
Eigen::Quaterniond readRotation(const Json& list) {
  Eigen::Vector4d numbers;
  read(list, &numbers);
  const double off = std::abs(numbers.norm() - 1.0);
  if (off > kRounding) throw std::runtime_error("a rotation is none");
  const Eigen::Quaterniond rotation(numbers);
  return off > 4.0 * std::numeric_limits<double>::epsilon() ? rotation.normalized() : rotation;
}

Json encodedCamera(const RigState& state, int c) {
  const RigEstimate& estimate = state.estimate;
  const Camera& camera = estimate.rig.cameras[c];
  const Rigid3& pose = estimate.rig.rig_from_camera[c];
  const PlaceInRig& place = estimate.places[c];
  return {{"name", state.cameras[c]},
          {"model", toString(camera.model())},
          {"size", {camera.width(), camera.height()}},
          {"parameters", numbers(camera.parameters())},
          {"k3_estimated", camera.estimatedCount() == kMaxIntrinsics},
          {"parameters_covariance", numbers(estimate.intrinsics_covariance[c])},
          {"uncertainty_px", {estimate.uncertainty[c].rms, estimate.uncertainty[c].max}},
          {"rotation_xyzw", numbers(pose.rotation.coeffs())},
          {"position", numbers(pose.translation)},
          {"position_known", place.position_known},
          {"rotation_covariance", numbers(place.rotation_covariance)},
          {"position_covariance", numbers(place.position_covariance)},
          {"difference_covariance", numbers(place.difference_covariance)},
          {"shared_landmarks", place.shared_landmarks}};
}

Camera decodedCamera(const Json& json) {
  const auto model = cameraModelFromString(json.at("model").get<std::string>());
  if (!model) throw std::runtime_error("the lens model is not known");
  const auto count = static_cast<int>(json.at("parameters").size());
  const bool with_k3 = *model == CameraModel::kRadtan && count == kMaxIntrinsics;
  if (count != Camera::parameterCount(*model) && !with_k3) {
    throw std::runtime_error("a lens has a wrong number of parameters");
  }
  Intrinsics parameters(count);
  read(json.at("parameters"), &parameters);
  const std::int64_t width = whole(json.at("size").at(0));
  const std::int64_t height = whole(json.at("size").at(1));
  if (!isImageSize(width, height)) throw std::runtime_error("an image size is none");
  Camera camera(*model, static_cast<int>(width), static_cast<int>(height), parameters);
  const std::string problem = camera.valid() ? implausibility(camera) : "it is not valid";
  if (!problem.empty()) throw std::runtime_error("a lens cannot be right: " + problem);
  if (with_k3) camera.setEstimateK3(json.at("k3_estimated").get<bool>());
  return camera;
}

void decodeCamera(const Json& json, RigState* state) {
  RigEstimate& estimate = state->estimate;
  state->cameras.push_back(json.at("name").get<std::string>());
  const Camera camera = decodedCamera(json);
  const bool was_held = json.at("parameters_covariance").empty();
  const int estimated = was_held ? 0 : camera.estimatedCount();
  IntrinsicsMatrix covariance(estimated, estimated);
  readCovariance(json.at("parameters_covariance"), &covariance);
  const auto pixels = json.at("uncertainty_px").get<std::vector<double>>();
  if (pixels.size() != 2 || !(pixels[0] >= 0.0 && pixels[1] >= 0.0)) {
    throw std::runtime_error("an uncertainty is not two numbers");
  }
  const Eigen::Quaterniond rotation = readRotation(json.at("rotation_xyzw"));
  Eigen::Vector3d position;
  read(json.at("position"), &position);
  if (!(position.norm() < kLongest)) throw std::runtime_error("a position is too far away");
  PlaceInRig place;
  place.position_known = json.at("position_known").get<bool>();
  place.shared_landmarks = count(json.at("shared_landmarks"));
  readCovariance(json.at("rotation_covariance"), &place.rotation_covariance);
  readCovariance(json.at("position_covariance"), &place.position_covariance);
  readCovariance(json.at("difference_covariance"), &place.difference_covariance);
  estimate.rig.cameras.push_back(camera);
  estimate.rig.rig_from_camera.emplace_back(rotation, position);
  estimate.places.push_back(place);
  estimate.intrinsics_covariance.push_back(covariance);
  estimate.uncertainty.push_back({pixels[0], pixels[1]});
}

RigState decoded(const Json& json) {
  if (!json.is_object() || json.value("format", Json()) != kFormat) {
    throw std::runtime_error("it is not what this program writes of a rig");
  }
  const Json& cameras = json.at("cameras");
  if (cameras.size() < 2 || cameras.size() > kMostCameras) {
    throw std::runtime_error("it does not hold two to six cameras");
  }
  RigState state;
  for (const Json& camera : cameras) decodeCamera(camera, &state);
  const std::vector<Rigid3>& poses = state.estimate.rig.rig_from_camera;
  if (poses[0].translation.norm() > 0.0) {
    throw std::runtime_error("the first camera is not the rig's frame");
  }
  if (!(poses[1].translation.norm() > 0.0)) {
    throw std::runtime_error("the first two cameras are in one place");
  }
  RigEstimate& estimate = state.estimate;
  estimate.usable = estimate.converged = true;
  estimate.sentence = json.at("sentence").get<std::string>();
  estimate.metric = json.at("metric").get<bool>();
  estimate.observations = count(json.at("observations"));
  estimate.poses.push_back({whole(json.at("stamp_ns")), 0, Rigid3()});
  return state;
}

}  // namespace

std::string encode(const RigState& state) {
  const RigEstimate& estimate = state.estimate;
  Json cameras = Json::array();
  for (int c = 0; c < estimate.rig.size(); ++c) cameras.push_back(encodedCamera(state, c));
  return toText({{"format", kFormat},
                 {"sentence", estimate.sentence},
                 {"metric", estimate.metric},
                 {"observations", estimate.observations},
                 {"stamp_ns", estimate.poses.empty() ? 0 : estimate.poses.back().stamp_ns},
                 {"cameras", cameras}});
}

DecodedRigState decodeRigState(const std::string& text) {
  if (text.size() > kMostBytes) return {std::nullopt, "it is too long"};
  try {
    return {decoded(Json::parse(text)), ""};
  } catch (const Json::exception&) {
    return {std::nullopt, "it is damaged, or not what this program writes of a rig"};
  } catch (const std::exception& error) {
    return {std::nullopt, error.what()};
  }
}

}  // namespace camera_self_calibration
