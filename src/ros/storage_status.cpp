#include "camera_self_calibration/ros/storage_status.h"

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/ros/judgement.h"

namespace camera_self_calibration {

using diagnostic_msgs::DiagnosticStatus;

void StorageStatus::setProblems(const std::vector<std::string>& problems) {
  problems_.clear();
  for (const std::string& problem : problems) problems_ = sentencesOf(problems_, problem);
}

void StorageStatus::summarize(diagnostic_updater::DiagnosticStatusWrapper* status) const {
  if (saving_) {
    status->summary(saving_->success ? DiagnosticStatus::OK : DiagnosticStatus::ERROR,
                    asSentence(saving_->message));
  } else if (keeps_) {
    status->summary(
        DiagnosticStatus::OK,
        "Nothing has been saved yet: the first save is when the calibration has CONVERGED.");
  } else {
    status->summary(DiagnosticStatus::OK,
                    "Nothing is saved: the next start calibrates again. Set ~camera_info_url or "
                    "~state_file to keep the calibration.");
  }
  addJudgement(DiagnosticStatus::WARN, problems_, status);
}

}  // namespace camera_self_calibration
