#include "camera_self_calibration/tools/fleet_results.h"

#include <cctype>
#include <ctime>
#include <sstream>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {
namespace {

// Stamps before 2001 are of clocks that count from when they were switched on.
constexpr std::int64_t kClockWasSet = 1000000000;  // [s]

std::string qualityOf(const CameraResult& camera) {
  const EpochResult& present = camera.present();
  if (!present.solved) return "no bag determines this lens";
  std::string text = present.solution.health.sentence;
  if (!present.solution.health.hint.empty()) text += ": " + present.solution.health.hint;
  return text;
}

std::string changeText(const CameraResult& camera, std::size_t number) {
  const EpochBoundary& change = camera.history.changes[number];
  const std::vector<HistoricBag>& bags = camera.history.bags;
  const HistoricBag* before = &bags[change.first];
  for (std::size_t i = 0; i < change.first; ++i) {
    if (bags[i].epoch >= 0) before = &bags[i];
  }
  std::string text = "it changed between " + timeText(before->record.end_ns) + " and " +
                     timeText(bags[change.first].record.begin_ns);
  const EpochResult& a = camera.epochs[number];
  const EpochResult& b = camera.epochs[number + 1];
  if (a.solved && b.solved) {
    text += formatted(", by %.2f px rms", pixelDistance(a.lens, b.lens).rms);
  }
  return text + " (" + pText(change.p_value) + ")";
}

// Only the better of segments that share a moment counts, and the order in time is in doubt.
std::string overlapText(const std::vector<HistoricBag>& bags) {
  const BagRecord* last = nullptr;
  const BagRecord* example[2] = {};
  int overlaps = 0;
  for (const HistoricBag& bag : bags) {
    if (last && bag.record.begin_ns <= last->end_ns && ++overlaps == 1) {
      example[0] = last;
      example[1] = &bag.record;
    }
    if (!last || bag.record.end_ns > last->end_ns) last = &bag.record;
  }
  if (overlaps == 0) return "";
  return formatted(
      " %d of its bags overlap%s in time with one before (%s with %s): they pass for views of "
      "the same thing, of which the better segment counts. If they are not, correct "
      "their stamps.",
      overlaps, overlaps == 1 ? "s" : "", example[1]->bag.c_str(), example[0]->bag.c_str());
}

std::string aside(const CameraResult& camera) {
  std::string text = overlapText(camera.history.bags);
  for (const HistoricBag& bag : camera.history.bags) {
    if (!bag.problem.empty()) {
      text += " " + bag.record.bag + " is left out: " + withFullStop(bag.problem);
    } else if (bag.epoch < 0) {
      text += " " + bag.record.bag +
              " is left out: it contradicts the bags before and after it, which agree. It may be "
              "of another camera.";
    }
  }
  return text;
}

std::string siblingsText(const SiblingVerdict& siblings) {
  if (!siblings.outlier) return "";
  return formatted(
      " It is %.2f px rms from the mean of its %d siblings, which differ by %.2f px among "
      "themselves (%s).",
      siblings.distance_px, siblings.siblings, siblings.spread_px, pText(siblings.p_value).c_str());
}

}  // namespace

std::string toString(CameraVerdict verdict) {
  switch (verdict) {
    case CameraVerdict::kSteady:
      return "STEADY";
    case CameraVerdict::kChanged:
      return "CHANGED";
    case CameraVerdict::kOutlier:
      return "OUTLIER";
    case CameraVerdict::kVague:
      return "VAGUE";
    case CameraVerdict::kUnknown:
      return "UNKNOWN";
  }
  return "";
}

CameraVerdict verdictOf(const CameraResult& camera) {
  const EpochResult& present = camera.present();
  if (!present.solved) return CameraVerdict::kUnknown;
  if (present.solution.health.state != CalibrationState::kConverged) return CameraVerdict::kVague;
  if (camera.siblings.outlier) return CameraVerdict::kOutlier;
  return camera.history.changes.empty() ? CameraVerdict::kSteady : CameraVerdict::kChanged;
}

std::string sentenceOf(const CameraResult& camera) {
  std::string text = asSentence(qualityOf(camera));
  for (std::size_t i = 0; i < camera.history.changes.size(); ++i) {
    text += " " + asSentence(changeText(camera, i));
  }
  int missing = 0;
  for (const EpochResult& epoch : camera.epochs) missing += epoch.solution.missing;
  if (missing > 0) {
    text += formatted(" %d better segments are in state files that are gone.", missing);
  }
  for (const EpochResult& epoch : camera.epochs) {
    if (!epoch.approximation.empty()) text += " " + epoch.approximation;
  }
  return text + aside(camera) + siblingsText(camera.siblings);
}

std::string pText(double p_value) {
  // Beyond that it is a matter of rounding.
  return p_value < 1e-99 ? "p < 1e-99" : formatted("p = %.1g", p_value);
}

std::string fileStem(const std::string& camera) {
  std::string stem;
  std::istringstream parts(camera);
  for (std::string part; std::getline(parts, part, '/');) {
    if (part.empty()) continue;
    for (char& c : part) {
      if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '.') c = '_';
    }
    if (part.front() == '.') part.front() = '_';
    stem += (stem.empty() ? "" : "/") + part;
  }
  return stem.empty() ? "camera" : stem;
}

std::string timeText(std::int64_t stamp_ns) {
  const std::int64_t seconds = stamp_ns / 1000000000;
  if (seconds < kClockWasSet) return formatted("%.1f s", toSeconds(stamp_ns));
  const auto time = static_cast<std::time_t>(seconds);
  std::tm utc{};
  gmtime_r(&time, &utc);
  return formatted("%04d-%02d-%02d %02d:%02d UTC", utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday,
                   utc.tm_hour, utc.tm_min);
}

}  // namespace camera_self_calibration
