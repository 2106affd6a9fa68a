// Two simulated cameras on one body through the nodelet: what it publishes, and the truth.

#include <camera_self_calibration/CalibrationEvent.h>
#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <image_geometry/stereo_camera_model.h>
#include <ros/package.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <tf2_msgs/TFMessage.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/rig_node/rig_node_options.h"
#include "camera_self_calibration/ros/calibration_url.h"
#include "camera_self_calibration/simulation/simulated_sequence.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"
#include "ros/recorder.h"
#include "ros/robot.h"
#include "ros/service_calls.h"

namespace camera_self_calibration {
namespace {

constexpr double kBaseline = 0.2;
constexpr int kMostImages = 400;  // of each camera
constexpr int kMostTurned = 240;  // and after the right one was turned; told after some 80
const char* const kNames[] = {"left", "right"};
const char* const kCamchain = "camchain.yaml";

const Camera kCameras[] = {
    Camera(CameraModel::kEquidistant, 320, 240, intrinsics({170, 171, 159, 121, 0.02, 0, 0, 0})),
    Camera(CameraModel::kEquidistant, 320, 240, intrinsics({176, 175, 161, 118, -0.01, 0, 0, 0}))};
const Rigid3 kLeftFromRight(expSo3({0.02, -0.03, 0.01}), {kBaseline, 0.0, 0.0});
const double kTurn = 0.02;  // [rad] of the right one about its optical axis, at last

/// The left camera, the right one, and the right one turned.
std::vector<SimulatedSequence> sequences() {
  SyntheticMotionOptions motion;
  motion.seed = 3;
  motion.speed = 0.6;
  motion.duration_s = 60.0;
  const Trajectory way = syntheticMotion(motion);
  std::vector<SimulatedSequence> result;
  const Rigid3 turned(expSo3({0.0, 0.0, kTurn}), Eigen::Vector3d::Zero());
  for (int c = 0; c < 3; ++c) {
    const Rigid3 rig_from_camera = c == 0   ? Rigid3()
                                   : c == 1 ? kLeftFromRight
                                            : kLeftFromRight * turned;
    SequenceOptions options;
    options.lens.camera = kCameras[std::min(c, 1)];
    options.room.texture_detail = 0.3;
    options.rate_hz = 12.0;
    options.duration_s = motion.duration_s;
    options.noise_seed = 1 + static_cast<std::uint64_t>(c);
    options.trajectory = way;
    options.mount.body_from_camera = rig_from_camera;
    result.emplace_back(options);
  }
  return result;
}

std::string saved(const std::string& file) { return readFile(resolvePath(file, "x").path).bytes; }

/// One run, which all tests share.
struct Run {
  std::vector<SimulatedSequence> cameras = sequences();
  std::vector<ros::Publisher> images;
  std::vector<std::unique_ptr<Recorder<sensor_msgs::CameraInfo>>> infos;
  std::vector<std::unique_ptr<Recorder<geometry_msgs::PoseWithCovarianceStamped>>> places;
  Recorder<CalibrationEvent> event{"/rig/event"};
  Recorder<diagnostic_msgs::DiagnosticArray> diagnostics{"/diagnostics"};
  Recorder<tf2_msgs::TFMessage> transforms{"/tf_static"};
  int next = 0;

  Run() {
    for (const std::string name : kNames) {
      images.push_back(ros::NodeHandle().advertise<sensor_msgs::Image>("/body/" + name, 5));
      infos.push_back(
          std::make_unique<Recorder<sensor_msgs::CameraInfo>>("/rig/" + name + "/camera_info"));
      places.push_back(std::make_unique<Recorder<geometry_msgs::PoseWithCovarianceStamped>>(
          "/rig/" + name + "/extrinsics"));
    }
  }

  bool connected() const {
    for (int c = 0; c < 2; ++c) {
      if (images[c].getNumSubscribers() == 0 || !infos[c]->connected() || !places[c]->connected()) {
        return false;
      }
    }
    return event.connected() && diagnostics.connected();
  }

  /// Publishes the next pair and waits until both have come back with their CameraInfo.
  bool step(bool turned = false) {
    const std::int64_t stamp_ns = cameras[0].stampNs(next);
    for (int c = 0; c < 2; ++c) {
      sensor_msgs::Image image = toMessage(cameras[turned ? 2 * c : c].frame(next).view());
      image.header.frame_id = kNames[c];
      images[c].publish(image);
    }
    ++next;
    return spinUntil(
        [&] {
          return std::all_of(infos.begin(), infos.end(), [&](const auto& info) {
            return !info->messages.empty() &&
                   info->messages.back()->header.stamp == toRosTime(stamp_ns);
          });
        },
        10.0);
  }

  /// The event that a camera was turned; nothing before.
  CalibrationEventConstPtr mountChanged() const {
    for (const auto& message : event.messages) {
      if (message->type == CalibrationEvent::MOUNT_CHANGED) return message;
    }
    return nullptr;
  }

  /// Goes on with the right camera turned until that is told.
  bool playTurned() {
    const int end = next + kMostTurned;
    while (!mountChanged() && next < end) {
      if (!step(true)) return false;
    }
    // The solver, of low priority, may be in a joint solution and rests after it as long as that
    // took.
    return spinUntil([this] { return mountChanged() != nullptr; }, 150.0);
  }

  bool converged() const { return !places[1]->messages.empty(); }

  /// Whether what could not be saved is saved without a new image, once somebody else's file is
  /// gone.
  bool savedAtLast() const {
    const auto refused = [this] {
      const std::string message = told(diagnostic_msgs::DiagnosticStatus::ERROR);
      return message.find(kCamchain) != std::string::npos;
    };
    return spinUntil(refused, 10.0) && std::filesystem::remove(resolvePath(kCamchain, "x").path) &&
           spinUntil([] { return !saved(kCamchain).empty(); }, 30.0);
  }

  bool play() {
    if (!writeFileAtomically(resolvePath(kCamchain, "x").path, "of somebody else").empty()) {
      return false;
    }
    if (!spinUntil([this] { return connected(); }, 30.0)) return false;
    while (!converged() && next < kMostImages) {
      if (!step()) return false;
    }
    // The cameras are done before the joint solution is.
    if (!spinUntil([this] { return converged(); }, 60.0)) return false;
    return savedAtLast() && step() &&
           spinUntil([this] { return !told(diagnostic_msgs::DiagnosticStatus::OK).empty(); }, 10.0);
  }

  /// What /diagnostics said of the rig at this level, at last.
  std::string told(int level, const std::string& node = "rig") const {
    std::string message;
    for (const auto& array : diagnostics.messages) {
      for (const auto& status : array->status) {
        if (status.name == node + ": rig" && status.level == level) message = status.message;
      }
    }
    return message;
  }
};

Run& run() {
  static Run recorded;
  static const bool done = recorded.play();
  if (!done) {
    ADD_FAILURE() << "did not converge after " << recorded.next
                  << " images: " << recorded.told(diagnostic_msgs::DiagnosticStatus::WARN);
  }
  return recorded;
}

Rigid3 poseOf(const geometry_msgs::Pose& pose) {
  const auto& q = pose.orientation;
  return {Eigen::Quaterniond(q.w, q.x, q.y, q.z),
          {pose.position.x, pose.position.y, pose.position.z}};
}

TEST(Rig, NothingGoesOutBeforeItIsKnown) {
  ASSERT_TRUE(run().converged());
  for (int c = 0; c < 2; ++c) {
    EXPECT_EQ(run().infos[c]->messages.front()->K[0], 0.0);
    EXPECT_EQ(run().infos[c]->messages.front()->header.frame_id, kNames[c]);
    EXPECT_EQ(run().infos[c]->messages.size(), static_cast<std::size_t>(run().next));
  }
  EXPECT_FALSE(run().told(diagnostic_msgs::DiagnosticStatus::WARN).empty());
}

TEST(Rig, ThePlaceIsWithinThreeSigmaOfTheTruth) {
  ASSERT_TRUE(run().converged());
  const geometry_msgs::PoseWithCovarianceStamped& place = *run().places[1]->messages.back();
  EXPECT_EQ(place.header.frame_id, "left");
  const Rigid3 found = poseOf(place.pose.pose);
  EXPECT_NEAR(found.translation.norm(), kBaseline, 1e-9);
  const Eigen::Map<const Eigen::Matrix<double, 6, 6>> covariance(place.pose.covariance.data());
  const Eigen::Vector3d turn = logSo3(found.rotation * kLeftFromRight.rotation.conjugate());
  const Eigen::Vector3d shift = found.translation - kLeftFromRight.translation;
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(turn(i)), 3.0 * std::sqrt(covariance(3 + i, 3 + i)));
    EXPECT_LT(std::abs(shift(i)), 3.0 * std::sqrt(covariance(i, i)) + 0.01 * kBaseline);
  }
  EXPECT_LT(turn.norm(), 0.01);
  EXPECT_EQ(poseOf(run().places[0]->messages.back()->pose.pose).translation.norm(), 0.0);
}

TEST(Rig, TheTransformIsThatOfTheExtrinsics) {
  ASSERT_TRUE(run().converged());
  ASSERT_TRUE(spinUntil([] { return !run().transforms.messages.empty(); }, 5.0));
  const geometry_msgs::TransformStamped& transform =
      run().transforms.messages.back()->transforms.front();
  EXPECT_EQ(transform.header.frame_id, "left");
  EXPECT_EQ(transform.child_frame_id, "right");
  EXPECT_EQ(transform.transform.translation.x,
            run().places[1]->messages.back()->pose.pose.position.x);
}

// As stereo_image_proc reads it: a point in the room stands in one row of both images.
TEST(Rig, TheRectifiedPairHasCommonRowsAndTheBaseline) {
  ASSERT_TRUE(run().converged());
  EXPECT_EQ(run().infos[1]->messages.back()->header.frame_id, "left");
  image_geometry::StereoCameraModel model;
  ASSERT_TRUE(
      model.fromCameraInfo(run().infos[0]->messages.back(), run().infos[1]->messages.back()));
  EXPECT_NEAR(model.baseline(), kBaseline, 1e-3 * kBaseline);
  double squares = 0.0;
  int points = 0;
  for (double x = -1.0; x <= 1.0; x += 0.25) {
    for (double y = -0.75; y <= 0.75; y += 0.25) {
      const Eigen::Vector3d point(2.0 * x, 2.0 * y, 2.0);
      Eigen::Vector2d left, right;
      ASSERT_TRUE(kCameras[0].project(point, &left));
      ASSERT_TRUE(kCameras[1].project(kLeftFromRight.inverse() * point, &right));
      if (!kCameras[0].inImage(left, 20.0) || !kCameras[1].inImage(right, 20.0)) continue;
      const cv::Point2d a = model.left().rectifyPoint(cv::Point2d(left.x(), left.y()));
      const cv::Point2d b = model.right().rectifyPoint(cv::Point2d(right.x(), right.y()));
      squares += (a.y - b.y) * (a.y - b.y);
      ++points;
      EXPECT_NEAR(model.getZ(a.x - b.x), 2.0, 0.2);
    }
  }
  ASSERT_GT(points, 20);
  EXPECT_LT(std::sqrt(squares / points), 0.5);
}

TEST(Rig, OneVerdictInWords) {
  ASSERT_TRUE(run().converged());
  const std::string verdict = run().told(diagnostic_msgs::DiagnosticStatus::OK);
  EXPECT_NE(verdict.find("Camera 1 is turned by"), std::string::npos) << verdict;
  int events = 0;
  for (const auto& message : run().event.messages) {
    if (message->sentence.find("the rig: ") != 0) continue;
    EXPECT_EQ(message->type, CalibrationEvent::CONVERGED);
    ++events;
  }
  EXPECT_EQ(events, 1);
}

TEST(Rig, IsSavedForRosAndKalibr) {
  ASSERT_TRUE(run().converged());
  expectSays(trigger("/rig/save"), true, "camchain.yaml");
  EXPECT_NE(saved("left.yaml").find("camera_name: left"), std::string::npos);
  EXPECT_NE(saved("right.yaml").find("rectification_matrix"), std::string::npos);
  EXPECT_NE(saved("camchain.yaml").find("T_cn_cnm1"), std::string::npos);
  EXPECT_NE(saved("camchain.yaml").find("Lengths in metres"), std::string::npos);
}

TEST(Rig, ACameraThatIsTurnedIsTold) {
  ASSERT_TRUE(run().converged());
  const int first = run().next;
  const CalibrationEventConstPtr told = run().playTurned() ? run().mountChanged() : nullptr;
  ASSERT_NE(told, nullptr) << run().told(diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(told->sentence.find("the rig: Camera right was turned by "), std::string::npos)
      << told->sentence;
  EXPECT_NEAR(told->onset_stamp.toSec(), toSeconds(run().cameras[0].stampNs(first)), 2.0);
  EXPECT_NEAR(told->rotation_deg, kTurn / kDegree, 3.0 * told->rotation_sigma_deg + 0.1);
  EXPECT_LT(told->p_value, 1e-3);
  EXPECT_GT(told->epoch, 0u);
  EXPECT_TRUE(spinUntil(
      [] {
        return run()
                   .told(diagnostic_msgs::DiagnosticStatus::WARN)
                   .find("calibrating the rig again") != std::string::npos;
      },
      10.0))
      << run().told(diagnostic_msgs::DiagnosticStatus::WARN);
  // What was known of it before stays until the rig is CONVERGED again.
  EXPECT_FALSE(run().places[1]->messages.empty());
}

TEST(Rig, WrongParametersAreAllNamed) {
  const auto idle = [] { return run().told(diagnostic_msgs::DiagnosticStatus::ERROR, "idle"); };
  ASSERT_TRUE(spinUntil([&] { return !idle().empty(); }, 10.0));
  for (const char* word : {"image_topics has 1", "left eye", "camera_names has 2", "baseline must",
                           "max_features must be a whole number"}) {
    EXPECT_NE(idle().find(word), std::string::npos) << word << ": " << idle();
  }
}

TEST(ReadRigNodeOptions, TheFileHoldsTheDefaults) {
  const RigNodeOptionsReading reading = readRigNodeOptions(ros::NodeHandle("/defaults"));
  const RigNodeOptions expected;
  EXPECT_TRUE(reading.warnings.empty());
  EXPECT_EQ(reading.problems.size(), 1u) << "image_topics are to be given";
  EXPECT_EQ(reading.options.rig_keyframes, expected.rig_keyframes);
  EXPECT_EQ(reading.options.publish_tf, expected.publish_tf);
  EXPECT_EQ(reading.options.camera.model, expected.camera.model);
  EXPECT_EQ(reading.options.camera.min_publish_change_px, expected.camera.min_publish_change_px);
  const std::string text =
      readFile(ros::package::getPath("camera_self_calibration") + "/config/rig.yaml").bytes;
  const std::string others =
      readFile(ros::package::getPath("camera_self_calibration") + "/config/parameters.yaml").bytes;
  for (const std::string& name : reading.known) {
    const auto in = [&](const std::string& file) {
      return file.find("\n" + name + ": ") != std::string::npos ||
             file.find("\n# " + name + ": ") != std::string::npos;
    };
    EXPECT_TRUE(in(text) || in(others)) << name << " stands in no file";
  }
}

TEST(RigEnd, TheNodeletIsAlive) {
  run();
  EXPECT_TRUE(ros::service::exists("/rig/save", true));
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "rig_test");
  ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
