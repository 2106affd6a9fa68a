#include "camera_self_calibration/tools/report_text.h"

#include <cmath>
#include <iomanip>
#include <sstream>

#include "camera_self_calibration/base/formatted.h"

namespace camera_self_calibration {
namespace {

void writeParameters(const CalibrationReport& report, std::ostream& text) {
  const std::vector<std::string> names = report.camera.parameterNames();
  text << std::fixed << "  parameter |     estimate |      sigma\n";
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    text << "  " << std::left << std::setw(9) << names[i] << " | " << std::right << std::setw(12)
         << std::setprecision(5) << report.camera.parameters()[index] << " | " << std::setw(10);
    if (index < report.covariance.rows()) {
      text << std::sqrt(report.covariance(index, index)) << '\n';
    } else {
      text << (report.covariance.rows() > 0 ? "fixed" : "unknown") << '\n';
    }
  }
}

std::string auditText(const AuditReport& audit) {
  std::string text = "audit: " + toString(audit.verdict) + ": " + asSentence(audit.sentence());
  if (!audit.hint.empty()) text += " " + asSentence(audit.hint);
  return text + '\n';
}

}  // namespace

std::string reportText(const Recording& recording) {
  const CalibrationReport& report = recording.final_report;
  std::ostringstream text;
  if (!recording.complete) text << kPartial << '\n';
  text << toString(report.state) << ": " << asSentence(report.sentence) << '\n';
  if (!report.hint.empty()) text << asSentence(report.hint) << '\n';
  text << toString(report.camera.model()) << ", " << report.camera.width() << "x"
       << report.camera.height() << '\n';
  writeParameters(report, text);
  if (std::isfinite(report.uncertainty.rms)) {
    text << std::setprecision(3) << "  pixel uncertainty: " << report.uncertainty.rms << " px rms, "
         << report.uncertainty.max << " px at worst\n";
  }
  if (report.observed.share > 0.0) {
    text << "  where features were (" << std::lround(100.0 * report.observed.share)
         << " % of the image): " << report.observed.uncertainty.rms << " px rms\n";
  }
  text << "  shutter: " << describe(report.shutter) << '\n';
  text << std::setprecision(1) << "  " << recording.frames << " frames, " << recording.keyframes
       << " keyframes in " << recording.processing_seconds << " s ("
       << static_cast<double>(recording.frames) / recording.processing_seconds << " fps)\n";
  if (recording.audit) text << auditText(*recording.audit);
  return text.str();
}

}  // namespace camera_self_calibration
