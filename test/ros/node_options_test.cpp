#include "camera_self_calibration/ros/node_options.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "camera_self_calibration/ros/file_parameters.h"

namespace camera_self_calibration {
namespace {

bool mentions(const std::vector<std::string>& problems, const std::string& word) {
  return std::any_of(problems.begin(), problems.end(), [&](const std::string& problem) {
    return problem.find(word) != std::string::npos;
  });
}

TEST(NodeOptions, DefaultsAreFine) { EXPECT_TRUE(NodeOptions().problems().empty()); }

TEST(NodeOptions, ListsAllViolationsAtOnce) {
  NodeOptions options;
  options.model = "fisheye62";
  options.image_transport = "theora";
  options.score = "determinant";
  options.world_frame = "";
  options.min_publish_change_px = -1.0;
  options.path_poses = 0;
  options.camera_name = "left eye";
  options.camera_info_url = "flash:///0";
  options.state_file = "package://nobody_knows_it/s";
  options.report_file = "";
  options.autosave_interval_s = -1.0;
  options.output_distortion_model = "fov";
  options.projection = "later";
  options.pipeline.alpha = 2.0;
  const std::vector<std::string> problems = options.problems();
  for (const char* word :
       {"fisheye62", "theora", "determinant", "output_distortion_model", "projection",
        "world_frame", "min_publish_change_px", "path_poses", "alpha", "left eye", "flash",
        "nobody_knows_it", "report_file", "autosave_interval_s"}) {
    EXPECT_TRUE(mentions(problems, word)) << word;
  }
}

TEST(NodeOptions, EveryUpperLimitIsEnforced) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  NodeOptions options;
  options.path_poses = 100000;
  options.autosave_interval_s = 86400.0;
  EXPECT_TRUE(options.problems().empty());
  options.path_poses = 100001;
  options.autosave_interval_s = 86401.0;
  options.factory_warn_px = options.min_publish_change_px = kInfinity;
  const std::vector<std::string> problems = options.problems();
  EXPECT_EQ(problems.size(), 4u);
  for (const char* word :
       {"path_poses", "autosave_interval_s", "factory_warn_px", "min_publish_change_px"}) {
    EXPECT_TRUE(mentions(problems, word)) << word;
  }
  options.autosave_interval_s = kInfinity;
  EXPECT_TRUE(mentions(options.problems(), "autosave_interval_s"));
}

TEST(NodeOptions, AnOpenModelHasNoStartValues) {
  NodeOptions options;
  EXPECT_EQ(options.model, "auto");
  EXPECT_TRUE(options.problems().empty());
  options.initial_intrinsics.assign(5, 1.0);
  EXPECT_TRUE(mentions(options.problems(), "initial_intrinsics"));
}

TEST(NodeOptions, StartValuesMustMatchTheModel) {
  NodeOptions options;
  options.model = "plumb_bob";  // radtan
  options.initial_intrinsics.assign(8, 1.0);
  EXPECT_TRUE(options.problems().empty());
  options.initial_intrinsics.assign(9, 1.0);
  EXPECT_TRUE(options.problems().empty());
  options.initial_intrinsics.assign(5, 1.0);
  EXPECT_TRUE(mentions(options.problems(), "initial_intrinsics"));
}

TEST(NodeOptions, StartValuesMustBeIntrinsics) {
  NodeOptions options;
  options.model = "fov";
  options.initial_intrinsics = {300.0, 300.0, 320.0, 240.0, 0.9};
  EXPECT_TRUE(options.problems().empty());
  options.initial_intrinsics[0] = -300.0;
  EXPECT_TRUE(mentions(options.problems(), "initial_intrinsics"));
  options.initial_intrinsics[0] = std::nan("");
  EXPECT_TRUE(mentions(options.problems(), "initial_intrinsics"));
}

TEST(NodeOptions, NoTwoFilesAreOne) {
  NodeOptions options;
  options.camera_info_url = "file:///tmp/selfcal.yaml";
  options.state_file = "/tmp/selfcal.state";
  options.report_file = "/tmp/report.yaml";
  EXPECT_TRUE(sameFileProblems(options, "/selfcal").empty());
  options.report_file = "/tmp/../tmp/${NAME}.yaml";
  EXPECT_TRUE(mentions(sameFileProblems(options, "/selfcal"), "report_file"));
  EXPECT_TRUE(sameFileProblems(options, "/other").empty());
  for (const char* previous : {"/tmp/selfcal.state.previous", "/tmp/selfcal.yaml.previous"}) {
    options.report_file = previous;
    EXPECT_TRUE(mentions(sameFileProblems(options, "/selfcal"), ".previous")) << previous;
  }
  options.state_file = options.report_file = "file:///tmp/selfcal.yaml";
  EXPECT_EQ(sameFileProblems(options, "/selfcal").size(), 4u);  // what is kept of two, too
  // Without a URL ~save writes to camera_info_manager's own place.
  options = NodeOptions();
  options.report_file = "camera_info/${NAME}.yaml";
  EXPECT_EQ(sameFileProblems(options, "/selfcal").size(), 1u);
}

TEST(NodeOptions, FramesMustDiffer) {
  NodeOptions options;
  options.world_frame = options.child_frame = "camera";
  EXPECT_TRUE(mentions(options.problems(), "child_frame"));
}

}  // namespace
}  // namespace camera_self_calibration
