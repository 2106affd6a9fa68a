#include "camera_self_calibration/tools/batch_comparison.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

Camera cameraOf(double focal) {
  return Camera(CameraModel::kPinhole, 640, 480,
                (Intrinsics(4) << focal, focal, 320, 240).finished());
}

CalibrationReport reportOf(double focal) {
  CalibrationReport report;
  report.camera = cameraOf(focal);
  report.covariance = IntrinsicsMatrix::Identity(4, 4);
  return report;
}

BatchEstimate estimateOf(double focal) {
  BatchEstimate estimate;
  estimate.camera = cameraOf(focal);
  estimate.covariance = 0.25 * IntrinsicsMatrix::Identity(4, 4);
  return estimate;
}

TEST(BatchComparison, TellsHowManyKeyframesWereSolved) {
  BatchComparison comparison;
  comparison.batch = {estimateOf(400.0)};
  comparison.solved_keyframes = 57;
  const std::string text = batchText(reportOf(400.0), comparison);
  EXPECT_NE(text.find("57 keyframes"), std::string::npos) << text;
  EXPECT_EQ(text.find("present lens"), std::string::npos) << text;
}

TEST(BatchComparison, IsOfThePresentLensAlone) {
  BatchComparison comparison;
  comparison.batch = {estimateOf(400.0)};
  comparison.present_lens = 1;
  comparison.changes = 1;
  EXPECT_EQ(batchText(reportOf(440.0), comparison), "") << "there is none of the new lens yet";
  EXPECT_TRUE(batchJson(reportOf(440.0), comparison).is_null());
  comparison.batch.push_back(estimateOf(440.5));
  comparison.solved_keyframes = 31;
  const std::string text = batchText(reportOf(440.0), comparison);
  EXPECT_NE(text.find("31 keyframes"), std::string::npos) << text;
  EXPECT_NE(text.find("of the present lens alone: it changed 1 time before"), std::string::npos)
      << text;
  EXPECT_EQ(batchJson(reportOf(440.0), comparison)["epoch"], 1);
}

}  // namespace
}  // namespace camera_self_calibration
