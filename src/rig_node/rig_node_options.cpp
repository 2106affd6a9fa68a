#include "camera_self_calibration/rig_node/rig_node_options.h"

#include <set>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/ros/calibration_url.h"
#include "camera_self_calibration/ros/parameter_reader.h"

namespace camera_self_calibration {
namespace {

constexpr std::size_t kMostCameras = 6;
constexpr int kFewestKeyframes = 40;
constexpr int kMostKeyframes = 1000;

void read(ParameterReader& read, RigNodeOptions* options) {
  readPipelineOptions(read, &options->camera);
  read("image_transport", &options->camera.image_transport);
  read("min_publish_change_px", &options->camera.min_publish_change_px);
  read("publish_uncalibrated", &options->camera.publish_uncalibrated);
  read("image_topics", &options->image_topics);
  read("camera_names", &options->camera_names);
  read("camera_frames", &options->camera_frames);
  read("baseline", &options->baseline);
  read("rig_keyframes", &options->rig_keyframes);
  read("publish_tf", &options->publish_tf);
  read("camera_info_urls", &options->camera_info_urls);
  read("camchain_file", &options->camchain_file);
  read("state_folder", &options->state_folder);
}

void checkCount(const char* name, const std::vector<std::string>& values, std::size_t cameras,
                std::vector<std::string>* problems) {
  if (values.empty() || values.size() == cameras) return;
  problems->push_back(formatted("%s has %zu entries for %zu image_topics; give one for each camera",
                                name, values.size(), cameras));
}

void checkDifferent(const char* name, const std::vector<std::string>& values,
                    std::vector<std::string>* problems) {
  std::set<std::string> seen;
  for (const std::string& value : values) {
    if (seen.insert(value).second) continue;
    problems->push_back(std::string(name) + " holds " + value + " twice");
  }
}

void checkFiles(const RigNodeOptions& options, std::vector<std::string>* problems) {
  std::vector<std::string> files;
  for (std::size_t c = 0; c < options.camera_info_urls.size(); ++c) {
    const std::string name = c < options.camera_names.size() ? options.camera_names[c] : "camera";
    const ResolvedPath file = resolveCalibrationUrl(options.camera_info_urls[c], name);
    files.push_back(file.path);
    if (!file.error.empty()) problems->push_back("camera_info_urls: " + file.error);
  }
  checkDifferent("camera_info_urls", files, problems);
  const ResolvedPath chain = resolvePath(options.camchain_file, "camera");
  if (!chain.error.empty()) problems->push_back("camchain_file: " + chain.error);
  const ResolvedPath folder = resolvePath(options.state_folder, "camera");
  if (!folder.error.empty()) problems->push_back("state_folder: " + folder.error);
}

}  // namespace

RigOptions RigNodeOptions::rig() const {
  RigOptions rig;
  if (baseline > 0.0) rig.baseline_m = baseline;
  rig.converged_pixel_rms = camera.pipeline.converged_pixel_rms;
  rig.max_frames = rig_keyframes;
  rig.segment_frames = rig_keyframes / 4;
  rig.false_alarms_per_hour = camera.pipeline.false_alarms_per_hour;
  rig.names = camera_names;
  rig.solve.threads = camera.pipeline.solver_threads;
  return rig;
}

std::vector<std::string> RigNodeOptions::problems() const {
  std::vector<std::string> problems = camera.problems();
  if (image_topics.size() < 2 || image_topics.size() > kMostCameras) {
    problems.push_back(
        formatted("image_topics has %zu entries; give the image topics of two to six cameras, "
                  "such as [/left/image_raw, /right/image_raw]",
                  image_topics.size()));
  }
  checkDifferent("image_topics", image_topics, &problems);
  checkDifferent("camera_names", camera_names, &problems);
  checkCount("camera_names", camera_names, image_topics.size(), &problems);
  checkCount("camera_frames", camera_frames, image_topics.size(), &problems);
  checkCount("camera_info_urls", camera_info_urls, image_topics.size(), &problems);
  for (const std::string& name : camera_names) {
    if (isCameraName(name)) continue;
    problems.push_back("camera_names holds '" + name +
                       "'; names are of letters, digits and underscores");
  }
  if (baseline != 0.0 && !isBaseline(baseline)) {
    problems.push_back(
        formatted("baseline must lie between %g and %g m, or be 0 if it is not known; it is %g",
                  kShortestBaseline, kLongestBaseline, baseline));
  }
  if (rig_keyframes < kFewestKeyframes || rig_keyframes > kMostKeyframes) {
    problems.push_back(formatted("rig_keyframes is %d, it must lie between %d and %d",
                                 rig_keyframes, kFewestKeyframes, kMostKeyframes));
  }
  checkFiles(*this, &problems);
  return problems;
}

RigNodeOptionsReading readRigNodeOptions(const ros::NodeHandle& private_node) {
  RigNodeOptions options;
  ParameterReader reader(private_node);
  read(reader, &options);
  for (int c = 0; options.camera_names.empty() && c < options.cameras(); ++c) {
    options.camera_names.push_back(formatted("cam%d", c));
  }
  return readingOf(reader, std::move(options));
}

}  // namespace camera_self_calibration
