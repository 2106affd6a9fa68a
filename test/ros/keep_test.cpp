// What the nodelet keeps from one start to the next, and its services, each against the real
// counterpart: nodelet manager, camera_info_manager, a camera driver.

#include <camera_info_manager/camera_info_manager.h>
#include <camera_self_calibration/SetScale.h>
#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/spinner.h>
#include <sensor_msgs/SetCameraInfo.h>
#include <std_srvs/SetBool.h>
#include <yaml-cpp/yaml.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/ros/calibration_url.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "ros/robot.h"
#include "ros/service_calls.h"

namespace camera_self_calibration {
namespace {

const Camera kLens(CameraModel::kFov, 320, 240, intrinsics({150, 151, 159, 121, 0.95}));
const Camera kOtherLens(CameraModel::kFov, 320, 240, intrinsics({175, 176, 159, 121, 0.95}));
const char* const kTopic = "/camera/image_raw";
constexpr int kImages = 600;

std::string rosHome() { return std::getenv("ROS_HOME"); }
std::string statePath() { return rosHome() + "/states/left_eye.state"; }
std::string calibrationPath() { return rosHome() + "/calibrations/left_eye.yaml"; }

Answer freeze(bool data) {
  std_srvs::SetBool call;
  call.request.data = data;
  if (!ros::service::call("/selfcal/freeze", call)) return {false, "the call failed"};
  return {static_cast<bool>(call.response.success), call.response.message};
}

Answer setScale(double factor) {
  SetScale call;
  call.request.factor = factor;
  if (!ros::service::call("/selfcal/set_scale", call)) return {false, "the call failed"};
  return {static_cast<bool>(call.response.success), call.response.message};
}

Answer setCameraInfo(const sensor_msgs::CameraInfo& info) {
  sensor_msgs::SetCameraInfo call;
  call.request.camera_info = info;
  if (!ros::service::call("/selfcal/set_camera_info", call)) return {false, "the call failed"};
  return {static_cast<bool>(call.response.success), call.response.status_message};
}

/// A camera driver with the service set_camera_info, on a thread of its own.
class Driver {
 public:
  enum class Manner { kTakes, kRefuses, kHangs };

  explicit Driver(Manner manner) : manner_(manner) {
    node_.setCallbackQueue(&queue_);
    server_ = node_.advertiseService("/camera/set_camera_info", &Driver::serve, this);
    spinner_.start();
  }
  ~Driver() {
    released_ = true;
    server_.shutdown();
    spinner_.stop();
  }
  sensor_msgs::CameraInfo taken() const { return taken_; }

 private:
  bool serve(sensor_msgs::SetCameraInfo::Request& request,
             sensor_msgs::SetCameraInfo::Response& response) {
    while (manner_ == Manner::kHangs && !released_) ros::WallDuration(0.01).sleep();
    taken_ = request.camera_info;
    response.success = manner_ == Manner::kTakes;
    response.status_message = "flash memory";
    return true;
  }

  const Manner manner_;
  std::atomic<bool> released_{false};
  sensor_msgs::CameraInfo taken_;
  ros::NodeHandle node_;
  ros::CallbackQueue queue_;
  ros::AsyncSpinner spinner_{1, &queue_};
  ros::ServiceServer server_;
};

// The resolver against camera_info_manager itself.
TEST(Keep, UrlsMeanWhatCameraInfoManagerTakesThemFor) {
  camera_info_manager::CameraInfoManager manager(ros::NodeHandle("url_test"), "left_eye");
  for (const std::string url :
       {"file:///tmp/x.yaml", "file://${ROS_HOME}/a/${NAME}.yaml", "FILE:///tmp/${NAME}_b.yaml",
        "file:///tmp/${NAME}${NAME}.yaml", ""}) {
    const ResolvedPath resolved = resolveCalibrationUrl(url, "left_eye");
    const std::string expected = manager.resolveURL(
        url.empty() ? "file://${ROS_HOME}/camera_info/${NAME}.yaml" : url, "left_eye");
    EXPECT_EQ("file://" + resolved.path, "file://" + expected.substr(7)) << url;
  }
  const ResolvedPath in_package =
      resolveCalibrationUrl("package://camera_self_calibration/config/parameters.yaml", "x");
  EXPECT_TRUE(readFile(in_package.path).exists) << in_package.path << in_package.error;
  for (const std::string url :
       {"flash:///camera", "file://relative", "package://nobody_knows/x", "package://",
        "http://x/y", "file:///a/${USER}/b", "file:///${NAME"}) {
    EXPECT_EQ(manager.validateURL(url) && url.find("${") == std::string::npos &&
                  url.find("nobody") == std::string::npos,
              false);
    EXPECT_FALSE(resolveCalibrationUrl(url, "left_eye").error.empty()) << url;
  }
}

// The tests of this class follow one another on one robot.
class KeepRun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    ASSERT_TRUE(ros::service::waitForService("/manager/load_nodelet", 20000));
    ASSERT_TRUE(loadNodelet("/selfcal", kTopic));
    robot_ = std::make_unique<Robot>(kLens, 1, 1000.0);
    ASSERT_TRUE(robot_->connected());
  }
  static void TearDownTestSuite() { robot_.reset(); }
  static std::unique_ptr<Robot> robot_;
};
std::unique_ptr<Robot> KeepRun::robot_;

TEST_F(KeepRun, BeforeTheFirstImageServicesSayThatThereIsNothing) {
  for (const char* name : {"reset", "reset_tracking", "save", "commit", "dump_report"}) {
    expectSays(trigger(std::string("/selfcal/") + name), false, "no image has arrived");
  }
  expectSays(freeze(true), false, "no image has arrived");
  expectSays(setScale(2.0), false, "no image has arrived");
}

TEST_F(KeepRun, BeforeConvergenceTheySayWhy) {
  ASSERT_TRUE(robot_->step());
  expectSays(trigger("/selfcal/save"), false, "not CONVERGED");
  expectSays(trigger("/selfcal/commit"), false, "not CONVERGED");
  expectSays(freeze(true), false, "no calibration to keep");
  EXPECT_FALSE(readFile(statePath()).exists);
}

TEST_F(KeepRun, SavesWhatCameraInfoManagerReads) {
  ASSERT_TRUE(robot_->stepUntil([] { return robot_->converged(); }, kImages));
  ASSERT_TRUE(robot_->step());
  expectSays(trigger("/selfcal/save"), true, "left_eye.yaml");
  EXPECT_TRUE(readFile(statePath()).exists);
  camera_info_manager::CameraInfoManager manager(ros::NodeHandle("saved_test"), "left_eye",
                                                 "file://" + calibrationPath());
  ASSERT_TRUE(manager.isCalibrated());
  const sensor_msgs::CameraInfo read = manager.getCameraInfo();
  const sensor_msgs::CameraInfo& published = *robot_->camera_info.messages.back();
  ASSERT_GT(published.K[0], 0.0);
  EXPECT_EQ(read.distortion_model, published.distortion_model);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(read.K[i], published.K[i], 1e-9);
  ASSERT_EQ(read.D.size(), published.D.size());
  for (std::size_t i = 0; i < read.D.size(); ++i) EXPECT_NEAR(read.D[i], published.D[i], 1e-12);
}

TEST_F(KeepRun, CommitsToTheDriver) {
  expectSays(trigger("/selfcal/commit"), false, "/camera/set_camera_info");
  {
    const Driver driver(Driver::Manner::kTakes);
    expectSays(trigger("/selfcal/commit"), true, "flash memory");
    EXPECT_EQ(driver.taken().K, robot_->camera_info.messages.back()->K);
    EXPECT_EQ(driver.taken().D, robot_->camera_info.messages.back()->D);
    EXPECT_EQ(driver.taken().width, 320u);
  }
  {
    const Driver driver(Driver::Manner::kRefuses);
    expectSays(trigger("/selfcal/commit"), false, "refused");
  }
  const Driver driver(Driver::Manner::kHangs);
  std::atomic<bool> answered{false};
  std::thread images([&answered] {
    EXPECT_TRUE(robot_->step());
    EXPECT_FALSE(answered) << "the images waited for the driver";
  });
  expectSays(trigger("/selfcal/commit"), false, "did not answer");
  answered = true;
  images.join();
}

TEST_F(KeepRun, FreezesAndScales) {
  expectSays(freeze(true), true, "kept");
  const std::uint64_t revision = robot_->calibration.messages.back()->revision;
  const std::uint64_t map_id = robot_->status.messages.back()->map_id;
  expectSays(setScale(3.0), true, "map_id");
  for (const double wrong : {-3.0, 0.0, 1e-320, 1e300, HUGE_VAL, std::nan("")}) {
    expectSays(setScale(wrong), false, "between");
  }
  const std::size_t reports = robot_->calibration.messages.size();
  ASSERT_TRUE(
      robot_->stepUntil([&] { return robot_->calibration.messages.size() > reports + 4; }, 120));
  EXPECT_EQ(robot_->status.messages.back()->map_id, map_id + 1);
  EXPECT_EQ(robot_->calibration.messages.back()->revision, revision);
  EXPECT_TRUE(robot_->calibration.messages.back()->frozen);
  EXPECT_EQ(robot_->calibration.messages.back()->calibration_state, Calibration::CONVERGED);
  expectSays(freeze(false), true, "is updated again");
  expectSays(trigger("/selfcal/reset_tracking"), true, "new map");
  ASSERT_TRUE(robot_->step());
  EXPECT_EQ(robot_->status.messages.back()->map_id, map_id + 2);
}

TEST_F(KeepRun, DumpsAReport) {
  expectSays(trigger("/selfcal/dump_report"), true, "report_left_eye.yaml");
  const YAML::Node report = YAML::Load(readFile(rosHome() + "/report_left_eye.yaml").bytes);
  EXPECT_EQ(report["state"].as<std::string>(), "CONVERGED");
  EXPECT_EQ(report["params"].size(), 5u);
  EXPECT_EQ(report["covariance"].size(), 25u);
  EXPECT_GE(report["queue"]["segments"].size(), 2u);
  EXPECT_LT(report["pixel_uncertainty_rms_px"].as<double>(), 1.0);
  expectSays(trigger("/selfcal/dump_report"), true, "report_left_eye.yaml");
  // What is no report is not replaced by one.
  const std::string foreign = "camera_name: left_eye\n";
  ASSERT_EQ(writeFileAtomically(rosHome() + "/report_left_eye.yaml", foreign), "");
  expectSays(trigger("/selfcal/dump_report"), false, "left untouched");
  EXPECT_EQ(readFile(rosHome() + "/report_left_eye.yaml").bytes, foreign);
  std::filesystem::remove(rosHome() + "/report_left_eye.yaml");
}

TEST_F(KeepRun, TheNextStartIsConvergedAtOnceAndConfirmed) {
  expectSays(trigger("/selfcal/save"), true, "saved");
  ASSERT_TRUE(unloadNodelet("/selfcal"));
  robot_.reset();
  ASSERT_TRUE(loadNodelet("/selfcal", kTopic));
  robot_ = std::make_unique<Robot>(kLens, 5, 2000.0);
  ASSERT_TRUE(robot_->connected());
  ASSERT_TRUE(robot_->stepUntil([] { return !robot_->calibration.messages.empty(); }, 3));
  const Calibration& first = *robot_->calibration.messages.front();
  EXPECT_EQ(first.calibration_state, Calibration::CONVERGED) << first.calibration_sentence;
  EXPECT_NE(first.calibration_sentence.find("restored"), std::string::npos);
  ASSERT_TRUE(robot_->step());
  const auto info = toCamera(*robot_->camera_info.messages.back());
  ASSERT_TRUE(info);
  EXPECT_LT(pixelDistance(kLens, *info).rms, 1.0);
  ASSERT_TRUE(robot_->stepUntil(
      [] { return robot_->eventOf(CalibrationEvent::HANDOVER) != nullptr; }, kImages));
  EXPECT_NE(robot_->eventOf(CalibrationEvent::HANDOVER)->sentence.find("confirmed"),
            std::string::npos);
  EXPECT_EQ(robot_->eventOf(CalibrationEvent::CALIBRATION_CHANGE), nullptr);
}

TEST_F(KeepRun, AnotherLensIsNoticed) {
  ASSERT_TRUE(unloadNodelet("/selfcal"));
  robot_.reset();
  ASSERT_TRUE(loadNodelet("/selfcal", kTopic));
  robot_ = std::make_unique<Robot>(kOtherLens, 6, 3000.0);
  ASSERT_TRUE(robot_->connected());
  ASSERT_TRUE(robot_->stepUntil(
      [] { return robot_->eventOf(CalibrationEvent::CALIBRATION_CHANGE) != nullptr; }, kImages));
  EXPECT_EQ(robot_->eventOf(CalibrationEvent::CALIBRATION_CHANGE)->epoch, 1u);
  const std::string before = readFile(statePath()).bytes;
  ASSERT_TRUE(robot_->stepUntil([] { return robot_->converged(); }, kImages));
  ASSERT_TRUE(robot_->step());
  expectSays(trigger("/selfcal/save"), true, "saved");
  // What was learnt of the other lens is still there.
  EXPECT_EQ(readFile(statePath() + ".previous").bytes, before);
  EXPECT_NE(readFile(statePath()).bytes, before);
}

TEST_F(KeepRun, BeginsAnewOnRequest) {
  expectSays(setCameraInfo(sensor_msgs::CameraInfo()), false, "uncalibrated");
  sensor_msgs::CameraInfo info = *robot_->camera_info.messages.back();
  info.width = 640;
  expectSays(setCameraInfo(info), false, "640 x 240");
  info.distortion_model = "brown_conrady";
  info.width = 320;
  expectSays(setCameraInfo(info), false, "'brown_conrady'");
  info.distortion_model = robot_->camera_info.messages.back()->distortion_model;
  info.width = 320;
  info.K[0] += 0.25;
  expectSays(setCameraInfo(info), true, "in use at once");
  ASSERT_TRUE(robot_->step());
  EXPECT_EQ(robot_->camera_info.messages.back()->K, info.K);
  EXPECT_NE(readFile(calibrationPath()).bytes.find(YAML::Dump(YAML::Node(info.K[0]))),
            std::string::npos);
  const std::size_t reports = robot_->calibration.messages.size();
  ASSERT_TRUE(robot_->stepUntil([&] { return robot_->calibration.messages.size() > reports; }, 5));
  const Calibration start = *robot_->calibration.messages.back();
  EXPECT_NE(start.calibration_state, Calibration::CONVERGED);
  EXPECT_NEAR(start.values[0], kOtherLens.parameters()(0), 5.0);
  expectSays(trigger("/selfcal/reset"), true, "discarded");
  ASSERT_TRUE(robot_->stepUntil(
      [&] { return robot_->calibration.messages.back()->values[0] == 160.0; }, 5));
  ASSERT_TRUE(robot_->step());
  EXPECT_EQ(robot_->camera_info.messages.back()->K[0], 0.0);
  EXPECT_FALSE(robot_->calibration.messages.back()->handed_over);
  ASSERT_TRUE(unloadNodelet("/selfcal"));
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "keep_test");
  ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
