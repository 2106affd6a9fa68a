#include "camera_self_calibration/ros/judgement.h"

#include <algorithm>

#include "camera_self_calibration/base/formatted.h"

namespace camera_self_calibration {

void addJudgement(unsigned char level, const std::string& text,
                  diagnostic_updater::DiagnosticStatusWrapper* status) {
  if (text.empty()) return;
  status->summary(std::max<unsigned char>(level, status->level),
                  sentencesOf(status->message, text));
}

}  // namespace camera_self_calibration
