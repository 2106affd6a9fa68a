#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/image_weights.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/rig/epipolar.h"
#include "camera_self_calibration/rig/place_difference.h"
#include "camera_self_calibration/rig/rig.h"
#include "camera_self_calibration/rig/rig_solver.h"
#include "camera_self_calibration/rig/time_offset.h"

namespace camera_self_calibration {

/// 1 sigma along each axis.
Eigen::Vector3d sigmasOf(const Eigen::Matrix3d& covariance);

/// How well a camera's place in the rig is known.
struct PlaceInRig {
  /// Of the rotation vector of rig_from_camera, in the rig's frame [rad^2].
  Eigen::Matrix3d rotation_covariance = Eigen::Matrix3d::Zero();
  /// Whether the position is told: where it is not, that of the rig is not to be used.
  bool position_known = false;
  /// Of the position, in the unit of the positions; of a camera whose distance is the unit or
  /// given, of its direction alone.
  Eigen::Matrix3d position_covariance = Eigen::Matrix3d::Zero();
  /// Of what placeDifference() finds: smaller than the two above where lenses and poses make up for
  /// each other. Of the shift only where the position is known.
  PlaceMatrix difference_covariance = PlaceMatrix::Zero();
  TimeOffset time_offset;    ///< Of its images.
  int shared_landmarks = 0;  ///< Of its tracks, those that another camera sees too.

  /// 1 sigma about the axis that is known least [rad].
  double rotationSigma() const;
  /// 1 sigma of the direction from the rig's origin, for a position at `position` [rad].
  double directionSigma(const Eigen::Vector3d& position) const;
};

/// A keyframe of the rig and where it was.
struct RigPose {
  std::int64_t stamp_ns = 0;
  int segment = 0;  ///< Those of different segments do not share a frame.
  Rigid3 world_from_rig;
};

/// What an estimate rests on, for whoever draws or checks it.
struct RigEvidence {
  Rig before;                          ///< Each camera by itself, placed by motion alone.
  std::vector<SharedView> shared;      ///< Those that the joint solution keeps.
  std::vector<ImageWeights> features;  ///< Of each camera (featuresOf).
  /// The images of the keyframe with most shared views, one for each camera; empty without any.
  std::vector<ImageView> example;
  std::int64_t example_ns = 0;  ///< Its stamp.
};

/// What is known of a rig.
struct RigEstimate {
  bool usable = false;   ///< False: `sentence` says why, and nothing else counts.
  std::string sentence;  ///< For people: how well, or why not.
  std::string hint;      ///< What would help; empty if nothing is needed.
  /// Positions in metres if `metric`; else the second camera is at distance 1, where its position
  /// is known.
  Rig rig;
  bool metric = false;
  bool converged = false;          ///< All that is asked for is known well enough (see rigLimits).
  std::vector<PlaceInRig> places;  ///< One for each camera; that of the first is exact.
  std::vector<IntrinsicsMatrix> intrinsics_covariance;  ///< Of each camera; empty where held.
  /// Of each camera over the image [px]: of noise, and of what lens models disagree about.
  std::vector<PixelError> uncertainty;
  std::vector<RigPose> poses;  ///< Of the keyframes that it rests on.
  int observations = 0;
  /// Typical, of what the first camera follows [1/unit of the positions]: how far away things are.
  double inverse_depth = 1.0;
  /// Null where it is not usable, or was saved and read again.
  std::shared_ptr<const RigEvidence> evidence;
};

/// Of what is near, as a share of the image's longer side.
constexpr double kTypicalDisparity = 0.1;

/// What is asked of a rig, from the pixels that a wrong pose costs: a pixel for 640 px of side, as
/// of a lens that has converged. A rotation moves what is seen by its angle times the focal length;
/// a wrong direction of the baseline moves a feature off its row by its angle times the disparity
/// (kTypicalDisparity).
struct RigLimits {
  double rotation = 0.0;   ///< [rad]
  double direction = 0.0;  ///< [rad]
};
RigLimits rigLimits(const Camera& camera);

/// From a covariance in the layout of rigCovariance: all but the verdict (judgeRig). `other`: the
/// rig under lens models that explain the tracks as well; by how much it differs counts as one
/// sigma, since noise is often less than what no model describes. With `baseline_m`, the distance
/// between the first two cameras [m], lengths become metric. `segments` are scaled too. `features`
/// as of featuresOf.
RigEstimate describeRig(const Rig& rig, const RigLayout& layout, const Eigen::MatrixXd& covariance,
                        const std::optional<Rig>& other, std::optional<double> baseline_m,
                        const std::vector<ImageWeights>& features,
                        std::vector<RigSegment>* segments);

/// In words: metres, or distances between the first two cameras.
std::string lengthUnit(bool metric);
std::string lengthUnit(const RigEstimate& estimate);

/// The verdict on a usable estimate: `converged`, `sentence` and `hint`, from the places of the
/// cameras and their sigmas, their clocks and the unit of lengths.
void judgeRig(RigEstimate* estimate);

/// Gives the lengths of a usable estimate another unit: positions, their covariance and the
/// verdict. With the distance between the first two cameras [m] lengths are metres; without it that
/// distance is 1. Nothing changes where the second camera's position is not known.
void setBaseline(std::optional<double> baseline_m, RigEstimate* estimate);

/// The place of one camera in words: how it is turned, where it sits, and how well both are known.
std::string placeText(const RigEstimate& estimate, int camera);

}  // namespace camera_self_calibration
