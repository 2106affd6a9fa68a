#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "camera_self_calibration/audit/likely_cause.h"
#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/pipeline/results.h"

namespace camera_self_calibration {

enum class AuditVerdict { kGood, kWrong, kCannotTell };

/// "GOOD", "WRONG", "CANNOT_TELL".
std::string toString(AuditVerdict verdict);

struct AuditOptions {
  double tolerance_px = 1.0;  ///< What a calibration may be off where features are [px rms].
  /// What its optical axis may be off. That of a model without decentring is another than radtan's:
  /// right calibrations of one camera differ by 0.3 to 1 degree, cameras of one type by 1.5 to 2.
  double axis_tolerance_deg = 1.0;
  double chance = 1e-3;  ///< Probability of calling a calibration wrong that is just tolerable.
};

/// Whether a distance is accepted (JCGM 106): it is within the tolerance, and to three sigma
/// (`at_most_px`) less than twice that.
bool isTolerable(double distance_px, double at_most_px, const AuditOptions& options);

/// Whether a calibration is still right, by video. In GOOD the distance is tolerable, and less than
/// twice the tolerance for certain (isTolerable); WRONG: it is beyond the tolerance beyond chance.
struct AuditReport {
  AuditVerdict verdict = AuditVerdict::kCannotTell;
  double tolerance_px = 1.0;
  /// From the true lens, where features are but for their outermost 5 %, a rotation of the camera
  /// removed [px rms]; sigma: of noise, of what halves of the video disagree, of the lens model.
  double distance_px = std::numeric_limits<double>::infinity();
  double sigma_px = std::numeric_limits<double>::infinity();
  double at_most_px = std::numeric_limits<double>::infinity();  ///< To three sigma.
  /// Probability that chance makes a tolerable calibration look as far off.
  double p_value = 1.0;
  double axis_deg = 0.0;  ///< How far the optical axes are apart, and its sigma.
  double axis_sigma_deg = std::numeric_limits<double>::infinity();
  double refused = 0.0;  ///< Share of the features whose rays it cannot project.
  std::string where;     ///< It is off most, in words; empty unless WRONG.
  std::string beyond;    ///< How far it is off beyond most of the features, in words, if it is.
  LikelyCause cause = LikelyCause::kNone;
  std::string cause_sentence;            ///< Empty unless WRONG.
  std::optional<std::int64_t> since_ns;  ///< WRONG since then; none: all along.
  std::string reason;  ///< Why there is no verdict, or it cannot be used, in words.
  std::string hint;    ///< A motion that would decide.

  /// The verdict with all that speaks for it, but for the hint.
  std::string sentence() const;
};

/// Compares the calibration with what is known of the lens; pure, and of constant cost.
AuditReport audit(const Camera& calibration, const CalibrationReport& live,
                  const AuditOptions& options);

}  // namespace camera_self_calibration
