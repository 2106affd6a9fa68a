#pragma once

#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/map/segment.h"

namespace camera_self_calibration {

/// Vague knowledge of where the landmarks are: their inverse depths are independent normal. It
/// keeps depths, and with them scale and sign of the motion, where too little parallax determines
/// them, and is far too weak to matter where there is parallax: a landmark seen from two places
/// with a parallax of n sigmas moves by 1 / n^2 of its distance from the mean. sigma 0: no prior.
struct InverseDepthPrior {
  double mean = 0.0;
  double sigma = 0.0;

  double weight() const { return sigma > 0.0 ? 1.0 / (sigma * sigma) : 0.0; }
  /// `sum (rho - mean)^2 / sigma^2 / 2` over the landmarks; no robust loss concerns it.
  double cost(const Segment& segment) const;
};

/// A segment's part in a problem: what is held, and its weight.
struct SegmentBlock {
  Segment* segment = nullptr;
  int fixed_keyframes = 1;   ///< The first so many keyframes keep their poses.
  int fixed_landmark = -1;   ///< This landmark keeps its inverse depth; -1: none.
  double sigma_scale = 1.0;  ///< Multiplies every observation's sigma.
  /// Of every landmark; for solve() alone, as Problem::prior.
  InverseDepthPrior inverse_depth_prior = {};
};

/// Vague knowledge of the intrinsics: independent normal errors, and pixels that are about square.
/// It keeps directions that nothing observes from running away, and is far too weak to matter in
/// others. Entries beyond n_c are ignored; parameters beyond the entries have none. Empty: no
/// prior.
struct IntrinsicsPrior {
  Intrinsics mean;
  Intrinsics sigma;           ///< Positive.
  double aspect_sigma = 0.0;  ///< Of `ln(fx / fy)`, about 0; 0: no prior.

  /// `sum (x_c - mean)^2 / sigma^2 / 2` over the first `count` parameters, and the same of the
  /// aspect.
  double cost(const Intrinsics& parameters, int count) const;
  /// Its negative gradient; `count` entries.
  Intrinsics gradient(const Intrinsics& parameters, int count) const;
  /// Its Gauss-Newton Hessian, `count` x `count`; 0 where there is no prior.
  IntrinsicsMatrix information(const Intrinsics& parameters, int count) const;
};

/// Everything that is estimated together: the intrinsics are all that the segments share.
struct Problem {
  Camera* camera = nullptr;
  bool estimate_intrinsics = true;
  std::vector<SegmentBlock> blocks;
  IntrinsicsPrior prior =
      {};  ///< For solve() alone: what marginalize() returns comes from observations.

  /// n_c, or 0 if the intrinsics are held.
  int intrinsicsCount() const { return estimate_intrinsics ? camera->estimatedCount() : 0; }
};

}  // namespace camera_self_calibration
