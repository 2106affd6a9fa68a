#pragma once

#include <cstdint>

#include "camera_self_calibration/simulation/feature_tracks.h"
#include "camera_self_calibration/simulation/random.h"

namespace camera_self_calibration {

/// Tracks as trials of startup see them: at most 100, noise of 0.1 to 0.3 px, up to 2 % gross
/// errors.
inline FeatureTracksOptions trialTracks(std::uint64_t seed, std::int64_t start_ns, Random* random) {
  FeatureTracksOptions options;
  options.seed = seed;
  options.max_features = 100;
  options.pixel_sigma = random->uniform(0.1, 0.3);
  options.outlier_share = random->uniform(0.0, 0.02);
  options.start_stamp_ns = start_ns;
  return options;
}

}  // namespace camera_self_calibration
