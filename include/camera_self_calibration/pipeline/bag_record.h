#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/pipeline/health.h"
#include "camera_self_calibration/queue/scatter.h"

namespace camera_self_calibration {

/// A segment of video by which it is found again: the moments that it covers, and its score.
struct SegmentMark {
  std::int64_t begin_ns = 0;  ///< First and last keyframe.
  std::int64_t end_ns = 0;
  double entropy = 0.0;  ///< Normalised [nats]; lower is better.
};

/// The result of one bag for one camera, in a kilobyte: enough to hold it against other bags
/// without their video, and to know which segments are wanted.
struct BagRecord {
  std::string bag;            ///< Path of the bag, folder or video.
  std::string camera;         ///< Name of the physical camera.
  std::string version;        ///< Of the program that read it.
  std::string state_file;     ///< Which holds all of its segments; empty: not known.
  std::int64_t begin_ns = 0;  ///< First and last image.
  std::int64_t end_ns = 0;
  std::int64_t images = 0;
  CalibrationState state = CalibrationState::kWaitingForMotion;
  std::uint64_t lens_changes = 0;  ///< Within the bag; all below is of the lens after the last.
  Camera lens;
  IntrinsicsMatrix covariance;  ///< n_c x n_c, of noise.
  double uncertainty_px = 0.0;  ///< Expected error over the image, all considered [px rms].
  double misfit_px = 0.0;       ///< Of the lens model, in it [px rms].
  Scatter scatter;              ///< Of its segments about `lens`.
  double line_delay_s = 0.0;    ///< LearntState::line_delay_s.
  double line_delay_sigma_s = 0.0;
  std::vector<SegmentMark> segments;
};

}  // namespace camera_self_calibration
