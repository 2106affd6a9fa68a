#include "camera_self_calibration/rig/rig_audit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/distributions.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/noisy_length.h"
#include "camera_self_calibration/rig/place_difference.h"

namespace camera_self_calibration {
namespace {

// As distanceFromEstimate(): the square's variance is `4 e^T C e + 2 trace(C C)`.
AuditDistance distanceOf(const Eigen::Vector3d& difference, const Eigen::Matrix3d& covariance,
                         double px_per_unit, double tolerance_px) {
  const Eigen::Vector3d e = px_per_unit * difference;
  const Eigen::Matrix3d c = px_per_unit * px_per_unit * covariance;
  const NoisyLength length(e.squaredNorm(), c.trace(), 4.0 * e.dot(c * e) + 2.0 * (c * c).trace());
  return {length.length(), length.sigma(), length.atMost(),
          chanceBeyond(length.length(), length.sigma(), tolerance_px, 0.0)};
}

std::string text(const AuditDistance& distance) {
  return formatted("%.2f +- %.2f px", distance.px, distance.sigma_px);
}

void decide(const std::vector<AuditDistance>& distances, const AuditOptions& options,
            PlaceAudit* audit) {
  const auto wrong = [&](const AuditDistance& d) { return d.p_value < options.chance; };
  const auto good = [&](const AuditDistance& d) {
    return isTolerable(d.px, d.at_most_px, options);
  };
  if (std::any_of(distances.begin(), distances.end(), wrong)) {
    audit->verdict = AuditVerdict::kWrong;
  } else if (std::all_of(distances.begin(), distances.end(), good)) {
    audit->verdict = AuditVerdict::kGood;
  }
}

void say(int camera, const AuditOptions& options, PlaceAudit* audit) {
  const std::string turned =
      formatted("turned by %.3f degrees against that, which moves what it sees by ",
                audit->turn_deg) +
      text(audit->turn);
  const std::string shifted =
      audit->shift_judged
          ? formatted("; its position lies %.2f degrees off, which moves what is near by ",
                      audit->shift_deg) +
                text(audit->shift)
          : std::string("; its position cannot be judged, since the video does not tell it");
  const std::string all =
      "it is " + turned + shifted + formatted(" (tolerance %.2f px)", options.tolerance_px);
  switch (audit->verdict) {
    case AuditVerdict::kGood:
      audit->sentence = formatted("camera %d is where the calibration puts it: ", camera) + all;
      return;
    case AuditVerdict::kWrong:
      audit->sentence = formatted("camera %d is not where the calibration puts it: ", camera) + all;
      return;
    case AuditVerdict::kCannotTell:
      audit->sentence =
          formatted("whether camera %d is where the calibration puts it is open: ", camera) + all;
  }
}

PlaceAudit undecided(const std::string& sentence, const std::string& hint) {
  PlaceAudit audit;
  audit.sentence = sentence;
  audit.hint = hint;
  return audit;
}

}  // namespace

PlaceAudit auditPlace(const RigEstimate& estimate, const Rig& given, int camera,
                      const AuditOptions& options) {
  const std::string hint = "turn the rig about all axes, where there is much to see";
  if (!estimate.usable || !estimate.evidence) return undecided(estimate.sentence, hint);
  if (estimate.places[camera].time_offset.harms()) {
    return undecided(formatted("the clocks of camera 0 and camera %d disagree", camera),
                     "trigger the cameras together, or correct the stamps");
  }
  for (const int c : {0, camera}) {
    const Camera& seen = estimate.rig.cameras[c];
    const Camera& other = given.cameras[c];
    if (seen.width() == other.width() && seen.height() == other.height()) continue;
    return undecided(formatted("the calibration of camera %d is for images of another size", c),
                     "give one for images of this size");
  }
  const PlaceInRig& place = estimate.places[camera];
  const Camera& lens = estimate.rig.cameras[camera];
  PlaceAudit audit;
  audit.difference = placeDifference(estimate.rig, given, camera, estimate.evidence->features);
  const Eigen::Vector3d turn = audit.difference.head<3>();
  const Eigen::Vector3d shift = audit.difference.tail<3>();
  const double distance = relativePosition(estimate.rig, camera).norm();
  audit.turn_deg = turn.norm() / kDegree;
  audit.turn = distanceOf(turn, place.difference_covariance.topLeftCorner<3, 3>(),
                          lens.parameters()(0), options.tolerance_px);
  audit.shift_judged = place.position_known;
  if (audit.shift_judged) {
    audit.shift_deg = shift.norm() / distance / kDegree;
    audit.shift =
        distanceOf(shift, place.difference_covariance.bottomRightCorner<3, 3>(),
                   kTypicalDisparity * lens.longerSide() / distance, options.tolerance_px);
  }
  decide({audit.turn, audit.shift}, options, &audit);
  say(camera, options, &audit);
  if (audit.verdict == AuditVerdict::kCannotTell) {
    audit.hint = estimate.hint.empty() ? hint : estimate.hint;
  }
  return audit;
}

AuditVerdict RigAudit::verdict() const {
  std::vector<AuditVerdict> all;
  for (const AuditReport& lens : lenses) all.push_back(lens.verdict);
  for (const PlaceAudit& place : places) all.push_back(place.verdict);
  const auto has = [&](AuditVerdict verdict) {
    return std::find(all.begin(), all.end(), verdict) != all.end();
  };
  return has(AuditVerdict::kWrong)        ? AuditVerdict::kWrong
         : has(AuditVerdict::kCannotTell) ? AuditVerdict::kCannotTell
                                          : AuditVerdict::kGood;
}

RigAudit auditRig(std::vector<AuditReport> lenses, const RigEstimate& estimate, const Rig& given,
                  const AuditOptions& options) {
  RigAudit audit;
  audit.lenses = std::move(lenses);
  for (int c = 1; c < given.size(); ++c) {
    audit.places.push_back(auditPlace(estimate, given, c, options));
  }
  return audit;
}

}  // namespace camera_self_calibration
