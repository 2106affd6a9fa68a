// What /diagnostics says of the files in which the nodelet keeps what is learnt.

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <utility>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "ros/robot.h"
#include "ros/service_calls.h"

namespace camera_self_calibration {
namespace {

const Camera kLens(CameraModel::kFov, 320, 240, intrinsics({150, 151, 159, 121, 0.95}));
const char* const kTopic = "/camera/image_raw";
constexpr int kImages = 600;

std::string rosHome() { return std::getenv("ROS_HOME"); }

/// What /diagnostics says of the files of a node.
class StorageStatus {
 public:
  explicit StorageStatus(std::string node) : node_(std::move(node)) {}

  /// Whether it comes to say so, at this level.
  bool says(int level, const std::string& word) {
    return spinUntil(
        [&] {
          const diagnostic_msgs::DiagnosticStatus status = newest();
          return status.level == level && status.message.find(word) != std::string::npos;
        },
        10.0);
  }
  diagnostic_msgs::DiagnosticStatus newest() const {
    diagnostic_msgs::DiagnosticStatus found;
    for (const auto& array : diagnostics_.messages) {
      for (const auto& status : array->status) {
        const bool ours = status.name.find(node_) != std::string::npos;
        if (ours && status.name.find("storage") != std::string::npos) found = status;
      }
    }
    return found;
  }

 private:
  const std::string node_;
  Recorder<diagnostic_msgs::DiagnosticArray> diagnostics_{"/diagnostics"};
};

using diagnostic_msgs::DiagnosticStatus;

class Storage : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(ros::service::waitForService("/manager/load_nodelet", 20000));
  }
};

TEST_F(Storage, WhereNothingIsKeptDiagnosticsSayThat) {
  StorageStatus storage("bare");
  ASSERT_TRUE(loadNodelet("/bare", kTopic));
  EXPECT_TRUE(storage.says(DiagnosticStatus::OK, "Nothing is saved")) << storage.newest().message;
  ASSERT_TRUE(unloadNodelet("/bare"));
}

TEST_F(Storage, SavingThatFailsIsAnErrorUntilItSucceeds) {
  StorageStatus storage("unsaved");
  const std::string blocked = rosHome() + "/blocked";
  ASSERT_EQ(writeFileAtomically(blocked, "a file where a folder should be"), "");
  ASSERT_TRUE(loadNodelet("/unsaved", kTopic));
  EXPECT_TRUE(storage.says(DiagnosticStatus::OK, "Nothing has been saved yet"));
  Robot robot(kLens, 1, 5000.0, "/unsaved");
  ASSERT_TRUE(robot.connected());
  ASSERT_TRUE(robot.stepUntil([&] { return robot.converged(); }, kImages));
  EXPECT_TRUE(storage.says(DiagnosticStatus::ERROR, "blocked")) << storage.newest().message;
  std::filesystem::remove(blocked);
  EXPECT_TRUE(storage.says(DiagnosticStatus::OK, "Saved to"))
      << "without a new image: " << storage.newest().message;
  ASSERT_TRUE(robot.step());
  expectSays(trigger("/unsaved/save"), true, "saved to");
  const Answer reset = trigger("/unsaved/reset");
  expectSays(reset, true, "initial_intrinsics is not used");
  expectSays(reset, true, "32 and 16000 pixels");
  ASSERT_TRUE(unloadNodelet("/unsaved"));
}

// Files that are damaged, or not of this program.
TEST_F(Storage, SpoiltFilesAreRefusedInWordsAndLeftUntouched) {
  const std::string state = "not a state at all\n";
  const std::string calibration = "camera_name: [\n";
  ASSERT_EQ(writeFileAtomically(rosHome() + "/spoilt.state", state), "");
  ASSERT_EQ(writeFileAtomically(rosHome() + "/spoilt.yaml", calibration), "");
  StorageStatus storage("spoilt");
  ASSERT_TRUE(loadNodelet("/spoilt", kTopic));
  Robot robot(kLens, 1, 4000.0, "/spoilt");
  ASSERT_TRUE(robot.connected());
  ASSERT_TRUE(robot.stepUntil([&] { return robot.converged(); }, kImages));
  ASSERT_TRUE(robot.step());
  EXPECT_TRUE(storage.says(DiagnosticStatus::ERROR, "spoilt.state is not used"));
  EXPECT_TRUE(storage.says(DiagnosticStatus::ERROR, "spoilt.yaml is not used"));
  expectSays(trigger("/spoilt/save"), false, "left untouched");
  EXPECT_EQ(readFile(rosHome() + "/spoilt.state").bytes, state);
  EXPECT_EQ(readFile(rosHome() + "/spoilt.yaml").bytes, calibration);
  ASSERT_TRUE(unloadNodelet("/spoilt"));
  EXPECT_EQ(readFile(rosHome() + "/spoilt.state").bytes, state) << "saved at the end";
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "storage_test");
  ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
