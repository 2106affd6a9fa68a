#include "camera_self_calibration/rig_node/rig_store.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "camera_self_calibration/tools/rig_state.h"
#include "pipeline/small_state.h"
#include "tools/temporary_folder.h"

namespace camera_self_calibration {
namespace {

const Camera kFov = camera640(CameraModel::kFov, {300, 302, 318, 242, 0.95});

std::shared_ptr<const LearntState> learnt(std::uint64_t epoch) {
  return std::make_shared<const LearntState>(smallState(kFov, epoch));
}

RigReport converged(double baseline = 0.11) {
  RigReport report;
  report.state = CalibrationState::kConverged;
  report.cameras.resize(2);
  RigEstimate& estimate = report.estimate;
  estimate.usable = estimate.converged = true;
  estimate.rig = {{kFov, kFov}, {Rigid3(), Rigid3(expSo3({0.1, 0.0, 0.0}), {baseline, 0.0, 0.0})}};
  estimate.places.resize(2);
  estimate.intrinsics_covariance.assign(2, IntrinsicsMatrix::Identity(5, 5));
  estimate.uncertainty.resize(2);
  estimate.poses.resize(1);
  return report;
}

TEST(RigNodeOptions, TheBaselineIsThatOfARig) {
  RigNodeOptions options;
  options.image_topics = {"/left/image_raw", "/right/image_raw"};
  for (const double baseline : {0.0, 1e-3, 0.11, 1e3}) {
    options.baseline = baseline;
    EXPECT_TRUE(options.problems().empty()) << baseline;
  }
  for (const double baseline : {-1.0, 1e-320, 1e300, std::nan("")}) {
    options.baseline = baseline;
    EXPECT_EQ(options.problems().size(), 1u) << baseline;
  }
}

class RigStoreTest : public testing::Test {
 protected:
  RigStoreTest() {
    options_.image_topics = {"/left/image_raw", "/right/image_raw"};
    options_.camera_names = {"left", "right"};
    options_.state_folder = folder_ / "kept";
  }

  CalibrationStore::Outcome save(const RigReport& report, std::uint64_t epoch = 0) const {
    return RigStore(options_, "rig", false).save(report, infos_, {learnt(epoch), learnt(epoch)});
  }
  RigStore::Loaded load() const { return RigStore(options_, "rig", false).loadRig(); }

  TemporaryFolder folder_;
  RigNodeOptions options_;
  std::vector<sensor_msgs::CameraInfo> infos_{2};
};

TEST_F(RigStoreTest, WhatIsSavedIsThereAtTheNextStart) {
  EXPECT_FALSE(load().rig);
  EXPECT_TRUE(load().problem.empty());
  const CalibrationStore::Outcome outcome = save(converged());
  ASSERT_TRUE(outcome.success) << outcome.message;
  const RigStore::Loaded loaded = load();
  ASSERT_TRUE(loaded.rig) << loaded.problem;
  EXPECT_EQ(loaded.rig->rig.rig_from_camera[1].translation.x(), 0.11);
  RigStore store(options_, "rig", false);
  for (const int c : {0, 1}) {
    EXPECT_TRUE(store.loadCamera(c, std::nullopt, 640, 480).state);
    EXPECT_FALSE(store.loadCamera(c, std::nullopt, 320, 240).state);
  }
}

TEST_F(RigStoreTest, TheRigOfOtherCamerasIsNeitherUsedNorWrittenOver) {
  ASSERT_TRUE(save(converged(0.11)).success);
  options_.camera_names = {"front", "rear"};
  EXPECT_FALSE(load().rig);
  EXPECT_NE(load().problem.find("other names"), std::string::npos) << load().problem;
  const CalibrationStore::Outcome outcome = save(converged(0.5));
  EXPECT_FALSE(outcome.success);
  options_.camera_names = {"left", "right"};
  EXPECT_EQ(load().rig->rig.rig_from_camera[1].translation.x(), 0.11);
}

TEST_F(RigStoreTest, WhatIsNoRigIsLeftUntouched) {
  const std::string file = options_.state_folder + "/rig.json";
  ASSERT_EQ(writeFileAtomically(file, "notes"), "");
  EXPECT_FALSE(load().rig);
  EXPECT_FALSE(save(converged()).success);
  EXPECT_FALSE(save(converged()).refused);  // an operator has to do something about it
  EXPECT_EQ(readFile(file).bytes, "notes");
}

// A lens that is learnt anew has no state yet, or one that does not belong to the rig.
TEST_F(RigStoreTest, NothingIsSavedWhileALensIsLearntAnew) {
  ASSERT_TRUE(save(converged(0.11)).success);
  EXPECT_FALSE(save(converged(0.5), 1).success);
  EXPECT_TRUE(save(converged(0.5), 1).refused);
  RigStore store(options_, "rig", false);
  EXPECT_FALSE(store.save(converged(0.5), infos_, {learnt(0), nullptr}).success);
  EXPECT_EQ(load().rig->rig.rig_from_camera[1].translation.x(), 0.11);
}

TEST_F(RigStoreTest, ARigThatHasNotConvergedIsNotSaved) {
  RigReport report = converged();
  report.state = CalibrationState::kConverging;
  EXPECT_FALSE(save(report).success);
  EXPECT_TRUE(save(report).refused);
  EXPECT_FALSE(load().rig);
}

// A lens that no distortion model of camera_info holds goes out as zeros.
TEST_F(RigStoreTest, ZerosNeverReplaceTheCalibrationOfACamera) {
  options_.camera_info_urls = {"file://" + (folder_ / "left.yaml"),
                               "file://" + (folder_ / "right.yaml")};
  infos_.assign(2, toCameraInfo(kFov)->info);
  ASSERT_TRUE(save(converged()).success);
  const std::string left = readFile(folder_ / "left.yaml").bytes;
  infos_[0] = uncalibratedCameraInfo(640, 480);
  const CalibrationStore::Outcome outcome = save(converged());
  EXPECT_FALSE(outcome.success);
  EXPECT_NE(outcome.message.find("camera_info is zeros"), std::string::npos) << outcome.message;
  EXPECT_EQ(readFile(folder_ / "left.yaml").bytes, left);
}

TEST_F(RigStoreTest, TheFileOfAnotherCameraIsRefusedInWordsThatHoldForRigs) {
  options_.camera_info_urls = {"file://" + (folder_ / "left.yaml"),
                               "file://" + (folder_ / "right.yaml")};
  infos_.assign(2, toCameraInfo(kFov)->info);
  ASSERT_TRUE(save(converged()).success);
  options_.camera_info_urls = {options_.camera_info_urls[1], options_.camera_info_urls[0]};
  const std::string message = save(converged()).message;
  EXPECT_NE(message.find("it is for the camera 'right', this one has the name 'left'"),
            std::string::npos)
      << message;
  EXPECT_EQ(message.find('~'), std::string::npos) << message;
}

TEST_F(RigStoreTest, ACamchainThatOnlyApproximatesALensSaysSo) {
  options_.camchain_file = folder_ / "camchain.yaml";
  RigReport report = converged();
  EXPECT_TRUE(RigStore(options_, "rig", false).notes(report).empty()) << "Kalibr has fov";
  report.estimate.rig.cameras[1] =
      camera640(CameraModel::kRadtan, {460, 460, 320, 240, -0.3, 0.12, 0, 0, -0.03});
  ASSERT_TRUE(save(report).success);
  const std::vector<std::string> notes = RigStore(options_, "rig", false).notes(report);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].find("cam1 in " + options_.camchain_file + " holds an approximation"), 0u)
      << notes[0];
  EXPECT_NE(readFile(options_.camchain_file).bytes.find("# fitted to radtan with k3: off by"),
            std::string::npos);
}

}  // namespace
}  // namespace camera_self_calibration
