#include "camera_self_calibration/tools/report_text.h"

#include <algorithm>
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
  if (report.covariance.rows() > 0) {
    text << "  (sigma: of noise and of segments that disagree; the pixel uncertainty also contains "
            "a misfit of the lens model)\n";
  }
}

std::string auditText(const AuditReport& audit) {
  const std::string text =
      "audit: " + toString(audit.verdict) + ": " + sentencesOf(audit.sentence(), audit.hint);
  return text + '\n';
}

// "a pose for 88 of 165 images; tracking was lost 10 times".
std::string trackingText(const Recording& recording) {
  const auto lost =
      std::count_if(recording.events.begin(), recording.events.end(),
                    [](const Event& event) { return event.type == EventType::kLost; });
  std::string text = "a pose for " + std::to_string(recording.poses.size()) + " of " +
                     std::to_string(recording.frames) + " images; tracking was ";
  if (lost == 0) return text + "never lost";
  return text + "lost " + (lost == 1 ? "once" : std::to_string(lost) + " times");
}

}  // namespace

namespace {

/// The verdict with its reasons, one a line, and what would help.
std::string verdictText(const CalibrationReport& report) {
  const std::vector<std::string> reasons = clauses(report.sentence);
  std::string text = toString(report.state) + (reasons.empty() ? "\n" : ": ");
  for (std::size_t i = 0; i < reasons.size(); ++i) text += (i > 0 ? "  " : "") + reasons[i] + "\n";
  if (!report.hint.empty()) text += "  What would help: " + asSentence(report.hint) + "\n";
  return text;
}

}  // namespace

std::vector<std::string> clauses(const std::string& sentence) {
  const std::string kBetween = "; ";
  std::vector<std::string> all;
  std::size_t begin = 0;
  while (begin < sentence.size()) {
    const std::size_t end = std::min(sentence.find(kBetween, begin), sentence.size());
    all.push_back(asSentence(sentence.substr(begin, end - begin)));
    begin = end + kBetween.size();
  }
  return all;
}

std::string reportText(const Recording& recording) {
  const CalibrationReport& report = recording.final_report;
  std::ostringstream text;
  if (!recording.complete) text << kPartial << '\n';
  text << verdictText(report);
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
       << (recording.keyframes == 1 ? " keyframe in " : " keyframes in ")
       << recording.processing_seconds << " s ("
       << static_cast<double>(recording.frames) / recording.processing_seconds << " fps)\n";
  text << "  " << trackingText(recording) << '\n';
  if (recording.carried > 0) {
    text << "  " << recording.carried
         << " features moved with the camera (on the robot itself, or in "
         << "letters over the image) and were left out\n";
  }
  if (recording.audit) text << auditText(*recording.audit);
  return text.str();
}

}  // namespace camera_self_calibration
