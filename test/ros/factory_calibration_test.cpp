#include "camera_self_calibration/ros/factory_calibration.h"

#include <gtest/gtest.h>

#include "audit/audit_samples.h"
#include "camera/sample_cameras.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "camera_self_calibration/ros/start_camera.h"

namespace camera_self_calibration {
namespace {

const Camera kLens = camera640(CameraModel::kFov, {311, 310, 327, 233, 0.93});

Camera stretched(double factor) { return changed(kLens, factor, {0, 0}); }

bool says(const FactoryCalibration& factory, const std::string& words) {
  return factory.audit().sentence.find(words) != std::string::npos;
}

TEST(FactoryCalibration, SaysWhatIsMissing) {
  FactoryCalibration factory("/camera/camera_info", 1.0);
  EXPECT_FALSE(factory.audit().usable);
  EXPECT_TRUE(says(factory, "/camera/camera_info"));
  factory.update(knownLens(kLens, 0.1));
  factory.take(uncalibratedCameraInfo(640, 480));
  EXPECT_FALSE(factory.audit().usable);
  EXPECT_TRUE(says(factory, "its K is zero"));
  sensor_msgs::CameraInfo strange = toCameraInfo(kLens)->info;
  strange.distortion_model = "thin_prism";
  factory.take(strange);
  EXPECT_FALSE(factory.audit().usable);
  EXPECT_TRUE(says(factory, "thin_prism"));
}

TEST(FactoryCalibration, SaysWhyItIsNotUsed) {
  FactoryCalibration factory("info", 1.0);
  sensor_msgs::CameraInfo info = uncalibratedCameraInfo(640, 480);
  info.distortion_model = "rational_polynomial";
  info.K = {300, 0, 320, 0, 300, 240, 0, 0, 1};
  info.D = {0.2, 0, 0, 0, 0, 0.6, 0, 0};
  factory.take(info);
  std::string problem;
  EXPECT_FALSE(factory.startFor(CameraModel::kRadtan, 640, 480, &problem));
  EXPECT_NE(problem.find("radtan over the whole image"), std::string::npos) << problem;
  info.roi.x_offset = 600;
  info.roi.width = info.roi.height = 100;
  factory.take(info);
  EXPECT_FALSE(factory.startFor(CameraModel::kFov, 100, 100, &problem));
  EXPECT_NE(problem.find("region of interest"), std::string::npos) << problem;
}

TEST(FactoryCalibration, CannotTellBeforeTheLensIsKnown) {
  FactoryCalibration factory("info", 1.0);
  factory.take(toCameraInfo(stretched(1.05))->info);
  EXPECT_EQ(factory.audit().audit.verdict, AuditVerdict::kCannotTell);
  CalibrationReport report = knownLens(kLens, 0.1);
  report.handed_over = false;
  factory.update(report);
  EXPECT_TRUE(factory.audit().usable);
  EXPECT_EQ(factory.audit().audit.verdict, AuditVerdict::kCannotTell);
  EXPECT_TRUE(says(factory, "CANNOT_TELL: The video has not determined the lens yet."));
}

TEST(FactoryCalibration, IsAuditedByTheLiveOne) {
  FactoryCalibration factory("info", 1.0);
  factory.update(knownLens(kLens, 0.1));
  factory.take(toCameraInfo(kLens)->info);
  EXPECT_EQ(factory.audit().audit.verdict, AuditVerdict::kGood) << factory.audit().sentence;
  factory.take(toCameraInfo(stretched(1.05))->info);
  EXPECT_EQ(factory.audit().audit.verdict, AuditVerdict::kWrong);
  EXPECT_TRUE(says(factory, "5.0 % too long")) << factory.audit().sentence;
  EXPECT_TRUE(says(factory, "calibrate again")) << factory.audit().sentence;
  factory.take(toCameraInfo(Camera::defaultGuess(CameraModel::kPinhole, 320, 240))->info);
  EXPECT_EQ(factory.audit().audit.verdict, AuditVerdict::kWrong);
  EXPECT_TRUE(says(factory, "320 x 240")) << factory.audit().sentence;
}

TEST(FactoryCalibration, ALensThatChangesMakesItWrongSinceThen) {
  FactoryCalibration factory("info", 1.0);
  factory.take(toCameraInfo(kLens)->info);
  factory.update(knownLens(kLens, 0.1));
  ASSERT_EQ(factory.audit().audit.verdict, AuditVerdict::kGood);
  CalibrationReport zoomed = knownLens(stretched(1.05), 0.1);
  zoomed.revision = 2;
  zoomed.epoch = 1;
  zoomed.last_change_ns = 5000000000;
  factory.update(zoomed);
  EXPECT_EQ(factory.audit().audit.verdict, AuditVerdict::kWrong);
  EXPECT_TRUE(says(factory, "since the time stamp 5.000 s")) << factory.audit().sentence;
}

TEST(FactoryCalibration, StartsInTheModelToEstimate) {
  FactoryCalibration factory("info", 1.0);
  std::string problem;
  EXPECT_FALSE(factory.startFor(CameraModel::kFov, 640, 480, &problem));
  EXPECT_FALSE(problem.empty());
  factory.take(toCameraInfo(kLens)->info);  // equidistant
  for (const CameraModel model : {CameraModel::kFov, CameraModel::kEquidistant}) {
    const auto start = factory.startFor(model, 640, 480, &problem);
    ASSERT_TRUE(start) << toString(model) << ": " << problem;
    EXPECT_EQ(start->model(), model);
    EXPECT_LT(pixelDistance(kLens, *start).rms, 0.05);
  }
  EXPECT_FALSE(factory.startFor(CameraModel::kFov, 320, 240, &problem));
  EXPECT_NE(problem.find("320 x 240"), std::string::npos);
}

// Where w = 0 the fov model does not feel a change of w: an estimate from there would stay.
TEST(FactoryCalibration, AFovCalibrationDoesNotStartWithoutDistortion) {
  FactoryCalibration factory("info", 1.0);
  const Camera pinhole = camera640(CameraModel::kPinhole, {500, 500, 320, 240});
  factory.take(toCameraInfo(pinhole)->info);
  std::string problem;
  const auto start = factory.startFor(CameraModel::kFov, 640, 480, &problem);
  ASSERT_TRUE(start) << problem;
  EXPECT_GE(start->parameters()[4], 0.2);
  EXPECT_LT(pixelDistance(pinhole, *start).rms, 1.5) << "of 640 px";
}

TEST(FactoryCalibration, ReadsARationalPolynomialByAFit) {
  FactoryCalibration factory("info", 1.0);
  const auto info = toCameraInfo(kLens, OutputModel::kRationalPolynomial)->info;
  ASSERT_NE(info.D[5], 0.0);
  factory.take(info);
  factory.update(knownLens(kLens, 0.1));
  EXPECT_EQ(factory.audit().audit.verdict, AuditVerdict::kGood) << factory.audit().sentence;
  std::string problem;
  const auto start = factory.startFor(CameraModel::kFov, 640, 480, &problem);
  ASSERT_TRUE(start) << problem;
  EXPECT_LT(pixelDistance(kLens, *start).rms, 0.01);
}

TEST(FactoryCalibration, KnowsBinningAndRegion) {
  FactoryCalibration factory("info", 1.0);
  sensor_msgs::CameraInfo info = toCameraInfo(kLens)->info;
  info.binning_x = info.binning_y = 2;
  factory.take(info);
  EXPECT_FALSE(factory.windowFor(640, 480));
  ASSERT_TRUE(factory.windowFor(320, 240));
  std::string problem;
  const auto start = factory.startFor(CameraModel::kFov, 320, 240, &problem);
  ASSERT_TRUE(start) << problem;
  EXPECT_NEAR(start->parameters()[0], 155.5, 0.1);
}

TEST(StartCamera, WaitsForTheFactoryButNotForEver) {
  NodeOptions options;
  options.camera_info_input = "initial";
  options.pipeline.model = CameraModel::kFov;
  FactoryCalibration factory("info", 1.0);
  StartCamera start(&options, &factory);
  EXPECT_TRUE(start.decide(640, 480, ros::WallTime(10.0)).wait);
  EXPECT_TRUE(start.decide(640, 480, ros::WallTime(12.0)).wait);
  StartDecision late = start.decide(640, 480, ros::WallTime(14.0));
  EXPECT_FALSE(late.wait);
  EXPECT_TRUE(late.warning);
  EXPECT_FALSE(late.camera);
  factory.take(toCameraInfo(kLens)->info);
  StartDecision decision = start.decide(640, 480, ros::WallTime(14.1));
  EXPECT_FALSE(decision.wait || decision.warning);
  ASSERT_TRUE(decision.camera);
  EXPECT_EQ(decision.camera->model(), options.pipeline.model);
}

TEST(StartCamera, TakesTheParametersForTheFirstSizeOnly) {
  NodeOptions options;
  options.pipeline.model = CameraModel::kFov;
  options.initial_intrinsics = {300, 300, 320, 240, 0.9};
  StartCamera start(&options, nullptr);
  const StartDecision decision = start.decide(640, 480, ros::WallTime(1.0));
  ASSERT_TRUE(decision.camera);
  EXPECT_EQ(decision.camera->parameters()[0], 300.0);
  EXPECT_FALSE(start.decide(320, 240, ros::WallTime(2.0)).camera);
}

}  // namespace
}  // namespace camera_self_calibration
