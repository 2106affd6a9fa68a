#include "camera_self_calibration/rig_node/rig_judgement.h"

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/ros/judgement.h"

namespace camera_self_calibration {

void addVerdict(const RigReport& report, const RigRemarks& remarks,
                diagnostic_updater::DiagnosticStatusWrapper* status) {
  using diagnostic_msgs::DiagnosticStatus;
  const bool converged = report.state == CalibrationState::kConverged;
  status->summary(converged ? DiagnosticStatus::OK : DiagnosticStatus::WARN,
                  sentencesOf(report.sentence, report.hint));
  addJudgement(DiagnosticStatus::WARN, remarks.input, status);
  addJudgement(DiagnosticStatus::ERROR, remarks.failure, status);
  addJudgement(DiagnosticStatus::OK, remarks.pair, status);
}

}  // namespace camera_self_calibration
