#include "camera_self_calibration/audit/audit.h"

#include <gtest/gtest.h>

#include "audit/audit_samples.h"
#include "camera_self_calibration/camera/fit.h"

namespace camera_self_calibration {
namespace {

const Camera kRadtan = camera640(CameraModel::kRadtan, {400, 402, 325, 236, -0.28, 0.07, 2e-4, 0});
const Camera kEquidistant =
    camera640(CameraModel::kEquidistant, {300, 301, 330, 230, -0.02, 0.005, -0.003, 0.0004});
const Camera kWide = camera640(CameraModel::kFov, {311, 310, 327, 233, 0.93});
const Camera kNarrow = camera640(CameraModel::kPinhole, {600, 603, 310, 250});

AuditReport auditOf(const Camera& calibration, const Camera& lens, double uncertainty_px = 0.05) {
  return audit(calibration, knownLens(lens, uncertainty_px), AuditOptions());
}

TEST(Audit, TheTrueCalibrationIsGood) {
  for (const Camera& lens : {kRadtan, kEquidistant, kWide, kNarrow}) {
    const AuditReport report = auditOf(lens, lens);
    EXPECT_EQ(report.verdict, AuditVerdict::kGood) << report.sentence();
    EXPECT_LT(report.distance_px, 0.05);
    EXPECT_GT(report.p_value, 0.9);
    EXPECT_EQ(report.cause, LikelyCause::kNone);
    EXPECT_NE(report.sentence().find("is right"), std::string::npos) << report.sentence();
  }
}

// The same lens in other words.
TEST(Audit, AnotherModelOfTheSameLensIsGood) {
  const AuditReport report = auditOf(fitCamera(kWide, CameraModel::kEquidistant)->camera, kWide);
  EXPECT_EQ(report.verdict, AuditVerdict::kGood) << report.sentence();
}

TEST(Audit, WhatIsBeyondTheToleranceBeyondChanceIsWrong) {
  const Camera off = changed(kNarrow, 1.01, {0, 0});
  const double distance = pixelDistance(kNarrow, off).rms;
  ASSERT_GT(distance, 1.5);
  const AuditReport report = auditOf(off, kNarrow);
  EXPECT_EQ(report.verdict, AuditVerdict::kWrong);
  EXPECT_NEAR(report.distance_px, distance, 0.3);  // without the image's border
  EXPECT_LT(report.p_value, 1e-6);
  EXPECT_EQ(report.cause, LikelyCause::kFocalLength);
  EXPECT_NE(report.sentence().find("1.0 % too long"), std::string::npos) << report.sentence();
  EXPECT_NE(report.sentence().find("from the beginning"), std::string::npos) << report.sentence();
}

TEST(Audit, TheToleranceIsTheUsers) {
  const Camera off = changed(kNarrow, 1.002, {0, 0});  // 0.4 px
  AuditOptions strict;
  strict.tolerance_px = 0.2;
  EXPECT_EQ(auditOf(off, kNarrow).verdict, AuditVerdict::kGood);
  EXPECT_EQ(audit(off, knownLens(kNarrow, 0.02), strict).verdict, AuditVerdict::kWrong);
}

TEST(Audit, WhatChanceExplainsIsNotWrong) {
  const Camera off = changed(kNarrow, 1.01, {0, 0});
  const AuditReport report = auditOf(off, kNarrow, 3.0);
  EXPECT_EQ(report.verdict, AuditVerdict::kCannotTell) << report.sentence();
  EXPECT_FALSE(report.hint.empty());
  // A true calibration is not called good by a vague estimate either.
  const AuditReport vague = auditOf(kNarrow, kNarrow, 2.0);
  EXPECT_EQ(vague.verdict, AuditVerdict::kCannotTell) << vague.sentence();
  EXPECT_NE(vague.sentence().find("needed: 2.00 px"), std::string::npos) << vague.sentence();
}

TEST(Audit, WithoutAnEstimateNothingCanBeTold) {
  CalibrationReport nothing;
  nothing.camera = Camera::defaultGuess(CameraModel::kPinhole, 640, 480);
  nothing.hint = "move the camera";
  const AuditReport report = audit(kNarrow, nothing, AuditOptions());
  EXPECT_EQ(report.verdict, AuditVerdict::kCannotTell);
  EXPECT_EQ(report.hint, "move the camera");
}

// Such as one of a wide lens, seen through a narrow model that folds.
TEST(Audit, WithoutRaysForTheFeaturesItIsWrong) {
  const Camera folded = camera640(CameraModel::kRadtan, {311, 310, 327, 233, -2.0, 0, 0, 0});
  const AuditReport report = auditOf(folded, kWide);
  EXPECT_EQ(report.verdict, AuditVerdict::kWrong) << report.sentence();
  EXPECT_GT(report.refused, 0.1);
  EXPECT_NE(report.sentence().find("no ray for"), std::string::npos) << report.sentence();
}

TEST(Audit, DoubtOfTheLensModelAndOfTheHalvesCounts) {
  const Camera off = changed(kNarrow, 1.01, {0, 0});
  CalibrationReport live = knownLens(kNarrow, 0.05);
  live.lens_fit.misfit_observed = {1.0, 3.0};
  live.lens_fit.better = "radtan";
  const AuditReport misfit = audit(off, live, AuditOptions());
  EXPECT_EQ(misfit.verdict, AuditVerdict::kCannotTell) << misfit.sentence();
  EXPECT_NE(misfit.hint.find("radtan fits the lens better"), std::string::npos) << misfit.hint;
  live.lens_fit.better = "";
  EXPECT_NE(audit(off, live, AuditOptions()).hint.find("no other model was found"),
            std::string::npos);
  live = knownLens(kNarrow, 0.05);
  live.cross_validation.compared = true;
  live.cross_validation.difference_px = 3.0;
  live.cross_validation.expected_px = 0.05;
  live.cross_validation.p_value = 1e-9;
  const AuditReport halves = audit(off, live, AuditOptions());
  EXPECT_EQ(halves.verdict, AuditVerdict::kCannotTell);
  EXPECT_EQ(halves.hint.find("no motion would help"), std::string::npos) << halves.hint;
}

struct Mistake {
  Camera given;
  Camera lens;
  LikelyCause cause;
  std::string words;
};

TEST(Audit, NamesTheLikelyCause) {
  const auto as = [](CameraModel model, const Camera& camera) {
    return Camera(model, 640, 480, camera.parameters());
  };
  Intrinsics half = kRadtan.parameters();
  half.head<4>() *= 0.5;
  const Camera small(CameraModel::kRadtan, 320, 240, half);
  const Camera small_in_large(CameraModel::kRadtan, 640, 480, half);
  const Camera turned = camera640(CameraModel::kPinhole, {603, 600, 250, 310});
  const Camera bare = camera640(CameraModel::kPinhole, {400, 402, 325, 236});
  const Camera square(CameraModel::kPinhole, 600, 600, Eigen::Vector4d(500, 500, 299, 299));
  const Camera cropped(CameraModel::kPinhole, 640, 400, kNarrow.parameters());
  const std::vector<Mistake> mistakes = {
      {changed(square, 1.03, {0, 0}), square, LikelyCause::kFocalLength, "3.0 % too long"},
      {kNarrow, cropped, LikelyCause::kResolution, "only the image size differs"},
      {small, kRadtan, LikelyCause::kResolution, "320 x 240"},
      {small_in_large, kRadtan, LikelyCause::kResolution, "2 times as large"},
      {as(CameraModel::kEquidistant, kRadtan), kRadtan, LikelyCause::kModel,
       "those of radtan, but are given as equidistant"},
      {as(CameraModel::kRadtan, kEquidistant), kEquidistant, LikelyCause::kModel,
       "those of equidistant, but are given as radtan"},
      {turned, kNarrow, LikelyCause::kAxes, "swapped"},
      {changed(kWide, 0.95, {0, 0}), kWide, LikelyCause::kFocalLength, "5.0 % too short"},
      {changed(kRadtan, 1.0, {25, -12}), kRadtan, LikelyCause::kPrincipalPoint, "(25.0, -12.0) px"},
      {changed(kRadtan, 1.03, {25, -12}), kRadtan, LikelyCause::kBoth, "another camera's file"},
      {bare, kRadtan, LikelyCause::kDistortion, "missing"},
      {changed(kRadtan, 1.2, {30, 40}), kWide, LikelyCause::kUnknown, "unknown; perhaps"}};
  for (const Mistake& mistake : mistakes) {
    const AuditReport report = auditOf(mistake.given, mistake.lens);
    EXPECT_EQ(report.verdict, AuditVerdict::kWrong) << report.sentence();
    EXPECT_EQ(report.cause, mistake.cause)
        << toString(report.cause) << " for " << toString(mistake.cause) << report.sentence();
    EXPECT_NE(report.sentence().find(mistake.words), std::string::npos) << report.sentence();
  }
}

// A rotation of the camera hides most of it.
TEST(Audit, AnotherOpticalAxisIsWrong) {
  const Camera lens = camera640(CameraModel::kPinhole, {900, 900, 320, 240});
  const AuditReport report = auditOf(changed(lens, 1.0, {20, 0}), lens);
  EXPECT_LT(report.distance_px, 1.0);
  EXPECT_EQ(report.verdict, AuditVerdict::kWrong) << report.sentence();
  EXPECT_NE(report.sentence().find("optical axis is off by 1.2"), std::string::npos)
      << report.sentence();
  EXPECT_EQ(auditOf(changed(lens, 1.0, {10, 0}), lens).verdict, AuditVerdict::kGood);
}

// A calibration that never fitted the corners, where few features are, does what it is used for.
TEST(Audit, CornersAreToldApart) {
  CalibrationReport live = knownLens(kRadtan, 0.05);
  ImageWeights features(640, 480);
  for (int i = 0; i < 60; ++i) {
    for (int row = 6; row < 24; ++row) {
      for (int column = 8; column < 32; ++column) {
        features.count(ImageField::pixel(column, row, 640, 480));
      }
    }
  }
  for (int i = 0; i < 300; ++i) {
    for (const Eigen::Vector2d& corner : {Eigen::Vector2d(5, 5), Eigen::Vector2d(634, 5),
                                          Eigen::Vector2d(5, 474), Eigen::Vector2d(634, 474)}) {
      features.count(corner);
    }
  }
  live.observed.features = std::make_shared<const ImageWeights>(features);
  Camera given = kRadtan;
  Intrinsics p = kRadtan.parameters();
  p(5) += 0.01;  // k2
  given.setParameters(p);
  const AuditReport report = audit(given, live, AuditOptions());
  EXPECT_EQ(report.verdict, AuditVerdict::kGood) << report.sentence();
  EXPECT_NE(report.sentence().find("where few features are"), std::string::npos)
      << report.sentence();
}

}  // namespace
}  // namespace camera_self_calibration
