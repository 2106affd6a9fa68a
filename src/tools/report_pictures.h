#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "camera_self_calibration/tools/recording.h"

namespace camera_self_calibration {

/// Pictures of report.html, at twice the size at which they are shown.

/// Expected error of a projection over the image.
cv::Mat drawUncertainty(const Recording& recording);

/// rms residual over the image, with the mean residual as arrows.
cv::Mat drawResidualMap(const Recording& recording);

/// How often the queue's observations cover each part of the image.
cv::Mat drawCoverage(const Recording& recording);

/// The residuals' distribution.
cv::Mat drawResidualDistribution(const Recording& recording);

/// The way from above, that is, along the mean direction that points down in the images; beside it,
/// aligned, the one with the reference calibration and the ground truth.
cv::Mat drawTrajectory(const Recording& recording,
                       const std::vector<StampedCameraPose>& ground_truth);

}  // namespace camera_self_calibration
