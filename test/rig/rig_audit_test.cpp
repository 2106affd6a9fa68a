#include "camera_self_calibration/rig/rig_audit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/rig/rig_calibrator.h"
#include "camera_self_calibration/simulation/random.h"
#include "rig/simulated_rig.h"

namespace camera_self_calibration {
namespace {

std::vector<ImageWeights> everywhere(const Rig& rig) {
  std::vector<ImageWeights> features;
  for (const Camera& camera : rig.cameras) {
    features.emplace_back(camera.width(), camera.height());
    for (int row = 4; row < ImageField::kRows - 4; ++row) {
      for (int column = 4; column < ImageField::kColumns - 4; ++column) {
        features.back().count(ImageField::pixel(column, row, camera.width(), camera.height()));
      }
    }
  }
  return features;
}

// The rig with its variables moved by a step in the layout's order.
Rig stepped(const Rig& rig, const RigLayout& layout, const Eigen::VectorXd& step) {
  Rig result = rig;
  for (int c = 0; c < rig.size(); ++c) {
    if (const int at = layout.pose_at[c]; at >= 0) {
      Rigid3& pose = result.rig_from_camera[c];
      pose.rotation = expSo3(step.segment<3>(at)) * pose.rotation;
      pose.translation += step.segment<3>(at + 3);
    }
    Intrinsics p = rig.cameras[c].parameters();
    const int n = rig.cameras[c].estimatedCount();
    p.head(n) += step.segment(layout.intrinsics_at[c], n);
    result.cameras[c].setParameters(p);
  }
  return result;
}

TEST(PlaceDifference, ItsJacobianIsThatOfItsVariables) {
  Rig rig = stereoRig();
  rig.cameras.push_back(rigLens(380.0, 0.0));
  rig.rig_from_camera.emplace_back(expSo3({0.1, 1.6, 0.0}), Eigen::Vector3d(0.1, 0.05, -0.2));
  const RigLayout layout(rig, {});
  const auto features = everywhere(rig);
  for (const int camera : {1, 2}) {
    const auto j = placeJacobian(rig, layout, camera, features);
    for (int k = 0; k < layout.size; ++k) {
      // Of a few hundredths of a pixel.
      const bool pixels = k >= layout.intrinsics_at[0] && j.col(k).norm() < 0.1;
      const double size = pixels ? 1e-2 : 1e-5;
      Eigen::VectorXd step = Eigen::VectorXd::Zero(layout.size);
      step(k) = size;
      const PlaceVector found =
          placeDifference(stepped(rig, layout, step), rig, camera, features) / size;
      EXPECT_LT((found - j.col(k)).norm(), 0.02 * j.col(k).norm() + 2e-5)
          << camera << " " << k << ": " << found.transpose() << " not " << j.col(k).transpose();
    }
  }
}

// A principal point that lies elsewhere, and a camera that is turned as much the other way, see the
// same.
TEST(PlaceDifference, LensesAndPosesThatMakeUpForEachOtherDoNotDiffer) {
  const Rig rig = stereoRig();
  Rig other = rig;
  Intrinsics p = rig.cameras[1].parameters();
  p(2) += 3.0;
  other.cameras[1].setParameters(p);
  const auto features = everywhere(rig);
  const PlaceVector alone = placeDifference(rig, other, 1, features);
  EXPECT_NEAR(alone.head<3>().norm(), 3.0 / p(0), 0.05 * 3.0 / p(0));
  other.rig_from_camera[1].rotation = expSo3(alone.head<3>()) * other.rig_from_camera[1].rotation;
  EXPECT_LT(placeDifference(rig, other, 1, features).head<3>().norm(), 1e-4);
}

TEST(Epipolar, TheOffsetIsThatFromTheLine) {
  const Rig rig = stereoRig();
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d point(random.uniform(-1.0, 1.0), random.uniform(-0.8, 0.8),
                                random.uniform(1.5, 4.0));
    SharedView view;
    view.to = 1;
    ASSERT_TRUE(rig.cameras[0].project(point, &view.from_pixel));
    ASSERT_TRUE(rig.cameras[1].project(rig.rig_from_camera[1].inverse() * point, &view.to_pixel));
    EXPECT_NEAR(*epipolarOffset(rig, view), 0.0, 1e-6);
    // Along the line is no error; of a pair side by side that is about along the row.
    Eigen::Vector2d nearer;
    ASSERT_TRUE(rig.cameras[0].project(point, &nearer));
    ASSERT_TRUE(rig.cameras[1].project(rig.rig_from_camera[1].inverse() * (0.95 * point), &nearer));
    const Eigen::Vector2d along = (nearer - view.to_pixel).normalized();
    const Eigen::Vector2d across(-along.y(), along.x());
    SharedView off = view;
    off.to_pixel += 0.4 * across + 0.3 * along;
    EXPECT_NEAR(std::abs(*epipolarOffset(rig, off)), 0.4, 0.02);
  }
}

class RigAuditTest : public ::testing::Test {
 protected:
  static const RigEstimate& estimate() {
    static const RigEstimate found = [] {
      SimulatedRigOptions options;
      options.rig = stereoRig();
      const SimulatedRig rig = simulateRig(options);
      RigCalibrator calibrator({}, 2, rig.across);
      for (const RigFrame& frame : rig.frames) calibrator.add(frame);
      return calibrator.estimate(rig.truth.cameras);
    }();
    return found;
  }

  static PlaceAudit judged(const Rig& given) { return auditPlace(estimate(), given, 1, {}); }
};

TEST_F(RigAuditTest, TheEstimateRestsOnSharedViewsThatItExplains) {
  ASSERT_TRUE(estimate().usable) << estimate().sentence;
  const RigEvidence& evidence = *estimate().evidence;
  ASSERT_GT(evidence.shared.size(), 500u);
  double before = 0.0, after = 0.0;
  for (const SharedView& view : evidence.shared) {
    const auto first = epipolarOffset(evidence.before, view);
    const auto last = epipolarOffset(estimate().rig, view);
    ASSERT_TRUE(first && last);
    before += *first * *first;
    after += *last * *last;
  }
  const auto count = static_cast<double>(evidence.shared.size());
  EXPECT_NEAR(std::sqrt(after / count), 0.28, 0.04);  // 0.2 px in both images
  EXPECT_GT(before, after);
}

TEST_F(RigAuditTest, TheTrueCalibrationIsGood) {
  const PlaceAudit audit = judged(stereoRig());
  EXPECT_EQ(audit.verdict, AuditVerdict::kGood) << audit.sentence;
  EXPECT_LT(audit.turn.px, 0.3);
  EXPECT_TRUE(audit.shift_judged);
  EXPECT_NE(audit.sentence.find("is where the calibration puts it"), std::string::npos);
}

// In the words of another model, and in another unit of length.
TEST_F(RigAuditTest, TheSameRigInOtherWordsIsGood) {
  Rig other = stereoRig();
  for (Camera& camera : other.cameras) camera = fitCamera(camera, CameraModel::kRadtan)->camera;
  other.rig_from_camera[1].translation *= 7.0;
  EXPECT_EQ(judged(other).verdict, AuditVerdict::kGood) << judged(other).sentence;
}

TEST_F(RigAuditTest, ACameraThatIsTurnedIsWrong) {
  Rig turned = stereoRig();
  const Eigen::Vector3d turn = kDegree * Eigen::Vector3d(0.3, 0.3, 0.2);
  turned.rig_from_camera[1].rotation = expSo3(turn) * turned.rig_from_camera[1].rotation;
  const PlaceAudit audit = judged(turned);
  EXPECT_EQ(audit.verdict, AuditVerdict::kWrong) << audit.sentence;
  EXPECT_NEAR(audit.turn_deg, turn.norm() / kDegree, 0.05);
  EXPECT_NEAR(audit.turn.px, turn.norm() * 420.0, 0.4);
  EXPECT_LT(audit.turn.p_value, 1e-3);
}

TEST_F(RigAuditTest, ACameraThatIsMovedIsWrong) {
  Rig moved = stereoRig();
  moved.rig_from_camera[1].translation.y() += 0.01;
  const PlaceAudit audit = judged(moved);
  EXPECT_EQ(audit.verdict, AuditVerdict::kWrong) << audit.sentence;
  EXPECT_LT(audit.turn.px, 0.5);
  EXPECT_NEAR(audit.shift_deg, 0.01 / 0.12 / kDegree, 0.7);
}

TEST_F(RigAuditTest, WhatTheVideoDoesNotTellIsLeftOpen) {
  RigEstimate vague = estimate();
  vague.places[1].difference_covariance.setIdentity();
  const PlaceAudit audit = auditPlace(vague, stereoRig(), 1, {});
  EXPECT_EQ(audit.verdict, AuditVerdict::kCannotTell) << audit.sentence;
  EXPECT_FALSE(audit.hint.empty());
  EXPECT_EQ(auditPlace({}, stereoRig(), 1, {}).verdict, AuditVerdict::kCannotTell);
  Rig half = stereoRig();
  half.cameras[1] = Camera(CameraModel::kEquidistant, 320, 240, half.cameras[1].parameters());
  EXPECT_EQ(judged(half).verdict, AuditVerdict::kCannotTell);
}

// Where nothing tells the position, a right turn is not all.
TEST_F(RigAuditTest, APositionThatIsNotToldIsNotGood) {
  RigEstimate vague = estimate();
  vague.places[1].position_known = false;
  const PlaceAudit audit = auditPlace(vague, stereoRig(), 1, {});
  EXPECT_EQ(audit.verdict, AuditVerdict::kCannotTell) << audit.sentence;
  Rig turned = stereoRig();
  turned.rig_from_camera[1].rotation =
      expSo3({0.01, 0.0, 0.0}) * turned.rig_from_camera[1].rotation;
  EXPECT_EQ(auditPlace(vague, turned, 1, {}).verdict, AuditVerdict::kWrong);
}

TEST_F(RigAuditTest, ClocksThatDisagreeDecideNothing) {
  RigEstimate late = estimate();
  late.places[1].time_offset.seconds = 0.01;
  late.places[1].time_offset.sigma = 0.0005;
  ASSERT_TRUE(late.places[1].time_offset.harms());
  EXPECT_EQ(auditPlace(late, stereoRig(), 1, {}).verdict, AuditVerdict::kCannotTell);
}

TEST_F(RigAuditTest, OneWrongPartMakesTheRigWrong) {
  AuditReport good, wrong, open;
  good.verdict = AuditVerdict::kGood;
  wrong.verdict = AuditVerdict::kWrong;
  EXPECT_EQ(auditRig({good, good}, estimate(), stereoRig(), {}).verdict(), AuditVerdict::kGood);
  EXPECT_EQ(auditRig({good, open}, estimate(), stereoRig(), {}).verdict(),
            AuditVerdict::kCannotTell);
  EXPECT_EQ(auditRig({open, wrong}, estimate(), stereoRig(), {}).verdict(), AuditVerdict::kWrong);
}

}  // namespace
}  // namespace camera_self_calibration
