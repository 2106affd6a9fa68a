#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/rig/rig_solver.h"

namespace camera_self_calibration {

/// A camera of a rig that was turned or moved against the others, while its lens stayed.
struct MountChange {
  /// The one whose move alone explains most; of two cameras always the second, since nothing tells
  /// which of them moved.
  int camera = 1;
  std::int64_t onset_ns = 0;  ///< When, dated within a segment by what that says between the two.
  std::int64_t found_ns = 0;  ///< Stamp of the newest keyframe that told it.
  /// By how much it was turned: a rotation vector in the rig's frame as it was before [rad].
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation_covariance = Eigen::Matrix3d::Zero();  ///< [rad^2]
  /// Whether the position is told; of two cameras across their baseline only.
  bool shift_known = false;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< Of its position there, in the rig's unit.
  Eigen::Matrix3d shift_covariance = Eigen::Matrix3d::Zero();
  double p_value = 1.0;     ///< Bounds the probability of so much, were nothing changed.
  std::uint64_t epoch = 0;  ///< RigReport::epoch from then on.
  std::string sentence;     ///< For people: which camera, by how much, since when.

  double angle() const { return rotation.norm(); }  ///< [rad]
  double angleSigma() const;                        ///< 1 sigma, along the rotation [rad].
  /// 1 sigma of the shift's length, along it.
  double shiftSigma() const;
  /// Probability of so large a rotation by chance, whatever the camera was shifted.
  double rotationPValue() const;
  /// The same of the shift; 1 where it is not told.
  double shiftPValue() const;
};

/// The rig after a change.
Rig moved(const Rig& rig, const MountChange& change);

/// What several segments of video, in the order of time, say together of whether the cameras still
/// sit where they did.
struct MountVerdict {
  enum class Kind {
    kSame,     ///< Nothing speaks against it.
    kDoubt,    ///< Not decided: what is found from these segments is not to be believed yet.
    kOutlier,  ///< The segment `index` contradicts those before and those after it.
    kChange    ///< A mount changed; the segment `index` is the first wholly after it.
  };
  Kind kind = Kind::kSame;
  bool certain = false;     ///< Something changed, by more than chance is allowed.
  std::optional<int> lens;  ///< Camera whose lens, if it changed, would explain it as well.
  std::size_t index = 0;
  std::int64_t begin_ns = 0;  ///< Of the segment `index`,
  std::int64_t end_ns = 0;    ///< to its last keyframe.
  MountChange change;         ///< The likeliest, but for kSame.
};

/// Compares the segments as quadratic log-likelihoods of poses and intrinsics, all intrinsics free
/// and common to all segments. A change is a likelihood ratio of poses of one camera that differ
/// before and since a moment, against poses that stay; both sides' covariances are in it. It is
/// chi-square if nothing changed, and F by how far the segments scatter anyway. The smallest over
/// all moments and cameras counts, times their number (Bonferroni). A change that one segment that
/// is wrong, or a lens that changed, would explain as well is no change. `level`: probability of
/// one by chance, here.
MountVerdict judgeMounts(const std::vector<RigLikelihood>& segments, const Rig& reference,
                         double level);

}  // namespace camera_self_calibration
