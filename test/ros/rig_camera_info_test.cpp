#include "camera_self_calibration/rig_node/rig_camera_info.h"

#include <gtest/gtest.h>

#include "camera/sample_cameras.h"

namespace camera_self_calibration {
namespace {

const Camera kEquidistant =
    camera640(CameraModel::kEquidistant, {400, 401, 322, 238, -0.01, 0.002, 0, 0});
const Camera kRadtan =
    camera640(CameraModel::kRadtan, {600, 601, 318, 242, -0.2, 0.05, 0.01, -0.01});

RigReport converged(const std::vector<Camera>& cameras, std::uint64_t revision) {
  RigReport report;
  report.state = CalibrationState::kConverged;
  report.revision = revision;
  RigEstimate& estimate = report.estimate;
  estimate.usable = estimate.converged = true;
  estimate.rig = {cameras, {Rigid3(), Rigid3(Eigen::Quaterniond::Identity(), {0.1, 0.0, 0.0})}};
  estimate.places.resize(2);
  estimate.uncertainty.resize(2);
  for (const Camera& camera : cameras) {
    const auto count = static_cast<Eigen::Index>(camera.parameterCount());
    estimate.intrinsics_covariance.emplace_back(IntrinsicsMatrix::Identity(count, count));
    CalibrationReport own;
    own.state = CalibrationState::kConverged;
    own.camera = camera;
    report.cameras.push_back(own);
  }
  return report;
}

// plumb_bob and equidistant go out as equidistant both, which has no tangential terms.
TEST(RigCameraInfo, APairThatOnlyApproximatesALensIsWarnedOfOnce) {
  RigCameraInfo info(CameraInfoOptions(), Options(), 2);
  const std::vector<std::string> warnings = info.update(converged({kEquidistant, kRadtan}, 1));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].find("The camera_info of camera 1 holds an approximation, since both of a "
                             "pair have one distortion model: equidistant, off by "),
            0u)
      << warnings[0];
  EXPECT_TRUE(info.update(converged({kEquidistant, kRadtan}, 2)).empty()) << "it is the same";
}

// Nobody may ask for the left one's.
TEST(RigCameraInfo, BothOfAPairNameTheFrameOfTheLeftImages) {
  RigCameraInfo info(CameraInfoOptions(), Options(), 2);
  info.noteFrame(0, "left");
  info.noteFrame(1, "right");
  info.update(converged({kRadtan, kRadtan}, 1));
  std_msgs::Header header;
  header.frame_id = "right";
  EXPECT_EQ(info.infoFor(1, header, 640, 480).header.frame_id, "left");
}

TEST(RigCameraInfo, APairThatIsExactNeedsNoWarning) {
  RigCameraInfo info(CameraInfoOptions(), Options(), 2);
  EXPECT_TRUE(info.update(converged({kRadtan, kRadtan}, 1)).empty());
  EXPECT_EQ(info.infoFor(1, std_msgs::Header(), 640, 480).distortion_model, "plumb_bob");
}

}  // namespace
}  // namespace camera_self_calibration
