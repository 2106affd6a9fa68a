#include "camera_self_calibration/audit/audit_history.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

CalibrationReport at(std::int64_t stamp_ns, std::uint64_t epoch = 0, std::int64_t change_ns = 0) {
  CalibrationReport report;
  report.stamp_ns = stamp_ns;
  report.epoch = epoch;
  report.last_change_ns = change_ns;
  return report;
}

std::optional<std::int64_t> since(AuditHistory* history, const CalibrationReport& live,
                                  AuditVerdict verdict) {
  AuditReport audit;
  audit.verdict = verdict;
  history->date(live, &audit);
  return audit.since_ns;
}

TEST(AuditHistory, NeverGoodIsAllAlong) {
  AuditHistory history;
  EXPECT_FALSE(since(&history, at(10), AuditVerdict::kCannotTell));
  EXPECT_FALSE(since(&history, at(20), AuditVerdict::kWrong));
}

TEST(AuditHistory, AChangeOfTheLensDatesIt) {
  AuditHistory history;
  EXPECT_FALSE(since(&history, at(10), AuditVerdict::kGood));
  EXPECT_FALSE(since(&history, at(30, 1, 18), AuditVerdict::kCannotTell));
  EXPECT_EQ(since(&history, at(40, 1, 18), AuditVerdict::kWrong), 18);
  // A later change does not make it right.
  EXPECT_EQ(since(&history, at(60, 2, 50), AuditVerdict::kWrong), 18);
}

// As where a restored calibration was set aside.
TEST(AuditHistory, AnEpochWithoutADatedChangeIsDatedByTheLastGood) {
  AuditHistory history;
  since(&history, at(20), AuditVerdict::kGood);
  EXPECT_EQ(since(&history, at(40, 1), AuditVerdict::kWrong), 20);
}

TEST(AuditHistory, WithoutAChangeTheLastGoodDoes) {
  AuditHistory history;
  since(&history, at(10), AuditVerdict::kGood);
  since(&history, at(20), AuditVerdict::kGood);
  EXPECT_EQ(since(&history, at(30), AuditVerdict::kWrong), 20);
  EXPECT_FALSE(since(&history, at(40), AuditVerdict::kGood));
  EXPECT_EQ(since(&history, at(50), AuditVerdict::kWrong), 40);
}

}  // namespace
}  // namespace camera_self_calibration
