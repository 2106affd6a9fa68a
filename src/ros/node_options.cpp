#include "camera_self_calibration/ros/node_options.h"

#include <cmath>

#include "camera_self_calibration/queue/score_kind.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "camera_self_calibration/ros/file_parameters.h"
#include "camera_self_calibration/ros/parameter_reader.h"

namespace camera_self_calibration {
namespace {

constexpr const char* kAutoModel = "auto";
constexpr int kMostPathPoses = 100000;  // all go out with each message

void readInterface(ParameterReader& read, NodeOptions* options) {
  read("initial_intrinsics", &options->initial_intrinsics);
  read("image_transport", &options->image_transport);
  read("mask_url", &options->mask_url);
  read.orOff("camera_info_input", &options->camera_info_input);
  read("factory_warn_px", &options->factory_warn_px);
  read("world_frame", &options->world_frame);
  read("child_frame", &options->child_frame);
  read("publish_tf", &options->publish_tf);
  read("invert_tf", &options->invert_tf);
  read("min_publish_change_px", &options->min_publish_change_px);
  read("publish_uncalibrated", &options->publish_uncalibrated);
  read("output_distortion_model", &options->output_distortion_model);
  read("projection", &options->projection);
  read("path_poses", &options->path_poses);
}

void readKeeping(ParameterReader& read, NodeOptions* options) {
  read("camera_name", &options->camera_name);
  read("camera_info_url", &options->camera_info_url);
  read("state_file", &options->state_file);
  read("autosave_interval_s", &options->autosave_interval_s);
  read("report_file", &options->report_file);
  read("commit_service", &options->commit_service);
}

bool areIntrinsics(CameraModel model, const std::vector<double>& values) {
  const Eigen::Map<const Eigen::VectorXd> parameters(values.data(),
                                                     static_cast<Eigen::Index>(values.size()));
  return Camera(model, 1, 1, parameters).valid();
}

void checkModel(const NodeOptions& options, std::vector<std::string>* problems) {
  if (options.model == kAutoModel) {
    if (options.initial_intrinsics.empty()) return;
    problems->push_back("initial_intrinsics need a model that they belong to; model is 'auto'");
    return;
  }
  const std::optional<CameraModel> model = cameraModelFromString(options.model);
  if (!model) {
    problems->push_back("model is '" + options.model +
                        "'; it must be pinhole, fov, radtan (or plumb_bob), equidistant or auto");
    return;
  }
  const std::size_t count = options.initial_intrinsics.size();
  const auto expected = static_cast<std::size_t>(Camera::parameterCount(*model));
  const bool with_k3 = *model == CameraModel::kRadtan && count == expected + 1;
  const bool counted = count == expected || with_k3;
  if (count != 0 && !counted) {
    problems->push_back("initial_intrinsics has " + std::to_string(count) + " values; " +
                        options.model + " has " + std::to_string(expected));
  }
  if (counted && !areIntrinsics(*model, options.initial_intrinsics)) {
    problems->push_back("initial_intrinsics are no valid values of the model " + options.model +
                        ": fx and fy must be positive, and all of them numbers within range");
  }
}

}  // namespace

std::vector<std::string> NodeOptions::problems() const {
  std::vector<std::string> problems = pipeline.problems();
  checkModel(*this, &problems);
  if (!scoreKindFromString(score)) {
    problems.push_back("score is '" + score + "'; it must be entropy or pixel");
  }
  Options scratch;
  if (!setRollingShutter(rolling_shutter, &scratch)) {
    problems.push_back("rolling_shutter is '" + rolling_shutter +
                       "'; it must be auto, off or the readout time of the whole image in seconds");
  }
  if (image_transport != "raw" && image_transport != "compressed" && image_transport != "auto") {
    problems.push_back("image_transport is '" + image_transport +
                       "'; it must be raw, compressed or auto");
  }
  if (camera_info_input != "off" && camera_info_input != "initial" &&
      camera_info_input != "compare") {
    problems.push_back("camera_info_input is '" + camera_info_input +
                       "'; it must be off, initial or compare");
  }
  if (!(factory_warn_px > 0.0 && std::isfinite(factory_warn_px))) {
    problems.push_back("factory_warn_px must be a positive number of pixels");
  }
  if (!outputModelFromString(output_distortion_model)) {
    problems.push_back("output_distortion_model is '" + output_distortion_model +
                       "'; it must be auto, plumb_bob, rational_polynomial or equidistant");
  }
  if (projection != "follow" && projection != "fixed") {
    problems.push_back("projection is '" + projection + "'; it must be follow or fixed");
  }
  if (world_frame.empty()) problems.push_back("world_frame must not be empty");
  if (publish_tf && world_frame == child_frame) {
    problems.push_back("world_frame and child_frame must differ");
  }
  if (!(min_publish_change_px >= 0.0 && std::isfinite(min_publish_change_px))) {
    problems.push_back("min_publish_change_px must be 0 or a positive number of pixels");
  }
  if (path_poses < 2 || path_poses > kMostPathPoses) {
    problems.push_back("path_poses is " + std::to_string(path_poses) +
                       ", it must lie between 2 and " + std::to_string(kMostPathPoses));
  }
  const std::vector<std::string> keeping = keepingProblems(*this);
  problems.insert(problems.end(), keeping.begin(), keeping.end());
  return problems;
}

void readPipelineOptions(ParameterReader& read, NodeOptions* options) {
  Options& pipeline = options->pipeline;
  read("model", &options->model);
  read("max_features", &pipeline.tracker.max_features);
  read("min_distance_px", &pipeline.tracker.min_distance_px);
  read("keyframe_min_parallax", &pipeline.keyframe.min_parallax);
  read("keyframe_min_rotation_deg", &pipeline.keyframe.min_rotation_deg);
  read("keyframe_min_tracked_share", &pipeline.keyframe.min_tracked_share);
  read("sliding_window_keyframes", &pipeline.sliding_window_keyframes);
  read("segment_keyframes", &pipeline.segment_keyframes);
  read("queue_segments", &pipeline.queue_segments);
  read("startup_keyframes", &pipeline.startup_keyframes);
  read("handover_entropy", &pipeline.handover_entropy);
  read("exact_references", &pipeline.exact_references);
  read("alpha", &pipeline.alpha);
  read("score", &options->score);
  read.word("rolling_shutter", &options->rolling_shutter);
  read("converged_pixel_rms", &pipeline.converged_pixel_rms);
  read("false_alarms_per_hour", &pipeline.false_alarms_per_hour);
  read("relocalization_keyframes", &pipeline.relocalization_keyframes);
  read("solver_threads", &pipeline.solver_threads);
  read("max_queued_images", &pipeline.max_queued_images);
  pipeline.model = cameraModelFromString(options->model);
  const auto score = scoreKindFromString(options->score);
  if (score) pipeline.score = *score;
  setRollingShutter(options->rolling_shutter, &pipeline);
}

NodeOptionsReading readNodeOptions(const ros::NodeHandle& private_node) {
  NodeOptions options;
  ParameterReader read(private_node);
  readPipelineOptions(read, &options);
  readInterface(read, &options);
  readKeeping(read, &options);
  return readingOf(read, std::move(options));
}

}  // namespace camera_self_calibration
