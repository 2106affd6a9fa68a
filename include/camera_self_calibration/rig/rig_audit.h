#pragma once

#include <limits>
#include <string>
#include <vector>

#include "camera_self_calibration/audit/audit.h"
#include "camera_self_calibration/rig/rig_estimate.h"

namespace camera_self_calibration {

/// How far a calibration puts something off, in what it costs in the image.
struct AuditDistance {
  double px = std::numeric_limits<double>::infinity();          ///< Beyond the noise [px].
  double sigma_px = std::numeric_limits<double>::infinity();    ///< 1 sigma.
  double at_most_px = std::numeric_limits<double>::infinity();  ///< To three sigma.
  /// Probability that chance makes a tolerable distance look as large.
  double p_value = 1.0;
};

/// Whether a camera still sits where a calibration of its rig says.
struct PlaceAudit {
  AuditVerdict verdict = AuditVerdict::kCannotTell;
  PlaceVector difference = PlaceVector::Zero();  ///< From where that puts it.
  double turn_deg = 0.0;                         ///< How far it is turned against that.
  AuditDistance turn;                            ///< What this moves all that it sees by.
  double shift_deg = 0.0;                        ///< How far the direction of its position differs.
  /// What its position moves features by that have a disparity of a tenth of the longer side.
  AuditDistance shift;
  bool shift_judged = false;  ///< False: neither motion nor shared landmarks tell the position.
  std::string sentence;       ///< The verdict in words.
  std::string hint;           ///< A motion that would decide; empty where it is decided.
};

/// Compares the pose of one camera (not the first) with what is known of the rig. Lenses of other
/// models are no difference (placeDifference). `given` has the estimate's image sizes.
PlaceAudit auditPlace(const RigEstimate& estimate, const Rig& given, int camera,
                      const AuditOptions& options);

/// A calibration of a rig, by video.
struct RigAudit {
  std::vector<AuditReport> lenses;  ///< One for each camera.
  std::vector<PlaceAudit> places;   ///< One for each camera but the first.

  /// WRONG if anything is; GOOD if all is.
  AuditVerdict verdict() const;
};

/// `lenses` and places, from what a run made of the rig.
RigAudit auditRig(std::vector<AuditReport> lenses, const RigEstimate& estimate, const Rig& given,
                  const AuditOptions& options);

}  // namespace camera_self_calibration
