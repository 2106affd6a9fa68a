#include "camera_self_calibration/rig/rig_convergence.h"

#include <gtest/gtest.h>

#include <optional>

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kStamp = 7000000000;

RigReport report(bool converged, std::uint64_t revision, std::uint64_t epoch = 0) {
  RigReport result;
  result.state = converged ? CalibrationState::kConverged : CalibrationState::kConverging;
  result.sentence = converged ? "It is." : "It is not.";
  result.revision = revision;
  result.epoch = epoch;
  result.estimate.poses.resize(1);
  result.estimate.poses.back().stamp_ns = kStamp;
  return result;
}

TEST(RigConvergence, EachTurnOfTheStateIsToldOnce) {
  RigConvergence convergence;
  EXPECT_FALSE(convergence.next(report(false, 1)));
  const std::optional<Event> reached = convergence.next(report(true, 2));
  ASSERT_TRUE(reached);
  EXPECT_EQ(reached->type, EventType::kConverged);
  EXPECT_EQ(reached->stamp_ns, kStamp);
  EXPECT_FALSE(convergence.next(report(true, 3)));

  const std::optional<Event> lost = convergence.next(report(false, 3));
  ASSERT_TRUE(lost);
  EXPECT_EQ(lost->type, EventType::kNoLongerConverged);
  EXPECT_EQ(lost->sentence, "It is not.");
  EXPECT_FALSE(convergence.next(report(false, 4)));
  EXPECT_TRUE(convergence.next(report(true, 5)));
}

TEST(RigConvergence, AChangeTellsOfItselfThatTheRigIsLearntAnew) {
  RigConvergence convergence;
  EXPECT_TRUE(convergence.next(report(true, 1)));
  EXPECT_FALSE(convergence.next(report(false, 1, 1)));
  EXPECT_TRUE(convergence.next(report(true, 2, 1)));
  const std::optional<Event> of_new_rig = convergence.next(report(true, 3, 2));
  ASSERT_TRUE(of_new_rig) << "known again as soon as it changed";
  EXPECT_EQ(of_new_rig->type, EventType::kConverged);
}

TEST(RigConvergence, AReportThatWasOvertakenTellsNothing) {
  RigConvergence convergence;
  EXPECT_TRUE(convergence.next(report(true, 4, 1)));
  EXPECT_FALSE(convergence.next(report(false, 3, 1)));
  EXPECT_FALSE(convergence.next(report(false, 4, 0)));
  EXPECT_FALSE(convergence.next(report(true, 4, 1))) << "it still is";
}

TEST(RigConvergence, WithoutAJointSolutionThereIsNothingToDate) {
  RigConvergence convergence;
  RigReport early = report(true, 0);
  early.estimate.poses.clear();
  EXPECT_FALSE(convergence.next(early));
}

}  // namespace
}  // namespace camera_self_calibration
