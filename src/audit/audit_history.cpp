#include "camera_self_calibration/audit/audit_history.h"

namespace camera_self_calibration {

void AuditHistory::date(const CalibrationReport& live, AuditReport* audit) {
  if (audit->verdict == AuditVerdict::kGood) {
    good_ = Good{live.stamp_ns, live.epoch};
    since_ns_.reset();
  }
  if (audit->verdict != AuditVerdict::kWrong) return;
  if (!since_ns_ && good_) {
    // A restored calibration that was set aside begins an epoch without a change that was seen.
    const bool dated = live.epoch != good_->epoch && live.last_change_ns > 0;
    since_ns_ = dated ? live.last_change_ns : good_->stamp_ns;
  }
  audit->since_ns = since_ns_;
}

}  // namespace camera_self_calibration
