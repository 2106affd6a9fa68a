#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// The tracks of one segment that a comparison of models counts, and how well they are known.
struct ComparedTracks {
  std::set<std::int64_t> ids;
  double unexplained_sigma = 0.0;  ///< Per axis, added to the tracker's own in quadrature [px].
};

/// One model fitted to several segments that share nothing but the intrinsics.
struct JointFit {
  bool usable = false;
  Camera camera;
  std::vector<Segment> segments;       ///< Solved, tracks that do not fit removed.
  std::vector<ComparedTracks> tracks;  ///< Those left, one entry a segment.

  int trackCount() const;  ///< Over all segments.
};

/// Fits poses, landmarks and the intrinsics jointly, starting from `start`, gating as fitSegment.
JointFit fitJointly(const std::vector<Segment>& segments, const Camera& start, int threads);

/// How well intrinsics learnt from the other segments predict each one.
struct HeldOut {
  bool usable = false;
  /// Robust cost of each segment [nats of a Gaussian], its poses and landmarks at their best, with
  /// the intrinsics that all other segments together give.
  std::vector<double> cost;
  double design_effect = 1.0;  ///< Marginal::designEffect of the joint fit.

  double total() const;
};

/// Cross-validation of a fit by leaving out one segment at a time, over the given tracks of
/// `observed` (the segments before gating), so that several models answer for the same
/// observations. With H_i and b_i what segment i contributes to the reduced system of the
/// intrinsics at the joint optimum, H and b their sums, the others' estimate differs from the joint
/// one by `d = (H - H_i)^-1 (b - b_i)`, and the segment's cost by `-b_i^T d + d^T H_i d / 2`.
HeldOut leaveOneOut(const std::vector<Segment>& observed, const std::vector<ComparedTracks>& tracks,
                    const JointFit& fit, int threads);

}  // namespace camera_self_calibration
