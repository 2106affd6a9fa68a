// Values of the node's parameters and the names of its files: a list of problems, and none where a
// camera can be made of them.

#include <cmath>

#include "camera_self_calibration/ros/calibration_url.h"
#include "camera_self_calibration/ros/file_parameters.h"
#include "camera_self_calibration/ros/node_options.h"
#include "camera_self_calibration/ros/parameter_reader.h"
#include "fuzz_bytes.h"

namespace camera_self_calibration {
namespace {

/// Looking for a package takes ages, and reads what is not the fuzzer's.
std::string withoutPackage(const std::string& word) {
  return word.find("://") != std::string::npos && word.find("file") != 0 ? "" : word;
}

std::string anyWord(FuzzedDataProvider* data) {
  if (data->ConsumeBool()) return withoutPackage(data->ConsumeRandomLengthString(40));
  return data->PickValueInArray({"auto", "off", "fov", "radtan", "plumb_bob", "pixel", "fixed",
                                 "compare", "0.02", "file:///x/${NAME}.yaml", "package:/a",
                                 "${ROS_HOME}/${NAME}", "~/state", "${", "a/../b", ""});
}

NodeOptions anyOptions(FuzzedDataProvider* data) {
  NodeOptions options;
  for (std::string* word :
       {&options.model, &options.score, &options.rolling_shutter, &options.image_transport,
        &options.mask_url, &options.camera_info_input, &options.world_frame, &options.child_frame,
        &options.output_distortion_model, &options.projection, &options.camera_name,
        &options.camera_info_url, &options.state_file, &options.report_file}) {
    if (data->ConsumeBool()) *word = anyWord(data);
  }
  Options& pipeline = options.pipeline;
  for (int* number : {&pipeline.tracker.max_features, &pipeline.sliding_window_keyframes,
                      &pipeline.segment_keyframes, &pipeline.queue_segments,
                      &pipeline.startup_keyframes, &pipeline.relocalization_keyframes,
                      &pipeline.solver_threads, &pipeline.max_queued_images, &options.path_poses}) {
    if (data->ConsumeBool()) *number = data->ConsumeIntegral<int>();
  }
  for (double* number : {&pipeline.tracker.min_distance_px, &pipeline.keyframe.min_parallax,
                         &pipeline.keyframe.min_rotation_deg, &pipeline.keyframe.min_tracked_share,
                         &pipeline.handover_entropy, &pipeline.alpha, &pipeline.converged_pixel_rms,
                         &pipeline.false_alarms_per_hour, &options.factory_warn_px,
                         &options.min_publish_change_px, &options.autosave_interval_s}) {
    if (data->ConsumeBool()) *number = anyNumber(data);
  }
  options.initial_intrinsics.resize(data->ConsumeIntegralInRange<std::size_t>(0, 10));
  for (double& value : options.initial_intrinsics) value = anyNumber(data);
  return options;
}

void checkUsable(const NodeOptions& options) {
  require(options.pipeline.solver_threads <= 256, "threads are bounded");
  require(options.pipeline.max_queued_images <= 1000, "images that wait are bounded");
  require(options.autosave_interval_s <= 86400.0, "intervals are bounded");
  require(options.path_poses <= 100000, "what is drawn is bounded");
  for (const double pixels : {options.factory_warn_px, options.min_publish_change_px,
                              options.pipeline.converged_pixel_rms}) {
    require(std::isfinite(pixels), "tolerances are numbers");
  }
  require(!options.report_file.empty(), "a report has a file");
  const auto model = cameraModelFromString(options.model);
  require(model || options.model == "auto", "a model is one");
  require(model || options.initial_intrinsics.empty(), "start values have a model");
}

}  // namespace
}  // namespace camera_self_calibration

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace camera_self_calibration;
  FuzzedDataProvider data(bytes, size);
  const NodeOptions options = anyOptions(&data);
  const std::vector<std::string> problems = options.problems();
  for (const std::string& problem : problems) require(!problem.empty(), "a problem is said");
  countInput(problems.empty());
  if (problems.empty()) checkUsable(options);
  sameFileProblems(options, options.world_frame);
  require(isCameraName(toCameraName(options.child_frame)), "a node's name makes a camera's");
  nearestName(options.world_frame, {"model", "max_features", options.child_frame});
  return 0;
}
