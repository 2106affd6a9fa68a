#include <gtest/gtest.h>

#include <iostream>

#include "pipeline/loss_scenarios.h"
#include "sanitized.h"

namespace camera_self_calibration {
namespace {

// What holds whatever happens to tracking.
void expectCalibrationKept(const LossOutcome& outcome) {
  EXPECT_TRUE(outcome.before.handed_over) << outcome.before.sentence;
  EXPECT_TRUE(outcome.after.handed_over) << outcome.after.sentence;
  EXPECT_EQ(outcome.changes, 0);
  EXPECT_EQ(outcome.after.epoch, 0u);
  EXPECT_GE(outcome.after.queue.segments.size(), outcome.before.queue.segments.size());
  EXPECT_LT(outcome.calibration_error_px, 3.0 * outcome.after.uncertainty.rms);
}

void expectBackInTheOldMap(const LossOutcome& outcome) {
  EXPECT_LT(outcome.blind_s, 1.0);
  EXPECT_EQ(outcome.relocalized, 1);
  EXPECT_LT(outcome.relocalized_s, 2.0);
  EXPECT_EQ(outcome.map_id, 0u);
  EXPECT_LT(outcome.position_error, 0.02);
  std::cout << "back after " << outcome.relocalized_s << " s, position good to "
            << outcome.position_error << " m on " << outcome.travelled << " m\n";
}

TEST(Relocalization, AfterABlackoutTheOldMapGoesOn) {
  const LossOutcome outcome = runLoss(LossKind::kBlackout, 2);
  EXPECT_EQ(outcome.lost, 1);
  expectBackInTheOldMap(outcome);
  expectCalibrationKept(outcome);
}

TEST(Relocalization, AfterAWhipPanToo) {
  const LossOutcome outcome = runLoss(LossKind::kWhipPan, 2);
  EXPECT_EQ(outcome.lost, 1);
  expectBackInTheOldMap(outcome);
  expectCalibrationKept(outcome);
}

TEST(Relocalization, AnotherRoomIsAnotherMap) {
  const LossOutcome outcome = runLoss(LossKind::kTeleport, 2);
  EXPECT_EQ(outcome.lost, 2);
  EXPECT_EQ(outcome.relocalized_elsewhere, 0);
  EXPECT_LT(outcome.blind_elsewhere_s, 1.0);
  expectBackInTheOldMap(outcome);
  expectCalibrationKept(outcome);
}

TEST(Relocalization, MirroredImagesAreNotTakenForTheOldMap) {
  const LossOutcome outcome = runLoss(LossKind::kMirror, 2);
  EXPECT_EQ(outcome.lost, 1);
  EXPECT_EQ(outcome.relocalized, 0);
  EXPECT_NE(outcome.map_id, 0u);
  EXPECT_LT(outcome.blind_s, 1.0);
}

// Where all walls have the same tiles the camera may be somewhere else.
TEST(Relocalization, TilesThatRepeatAreNotTakenForAPlace) {
  const LossOutcome outcome = runLoss(LossKind::kRepetitive, 2);
  EXPECT_TRUE(outcome.relocalized == 0 || outcome.position_error < 0.05);
  expectCalibrationKept(outcome);
}

// People walk through the view: neither they nor their absence teach anything.
TEST(Relocalization, ACrowdChangesNothing) {
  const LossOutcome outcome = runLoss(LossKind::kCrowd, 6);
  EXPECT_EQ(outcome.lost, 0);
  EXPECT_EQ(outcome.map_id, 0u);
  EXPECT_LT(outcome.position_error, 0.05);
  expectCalibrationKept(outcome);
}

}  // namespace
}  // namespace camera_self_calibration
