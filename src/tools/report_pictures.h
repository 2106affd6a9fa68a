#pragma once

#include <cstdint>
#include <vector>

#include "camera_self_calibration/plotting/sheet.h"
#include "camera_self_calibration/tools/recording.h"

namespace camera_self_calibration {

/// What the charts of the pages have in common: letters are readable where one is shown 340 px
/// wide.
constexpr int kChartWidth = 420;
constexpr int kMapColumns = 16;  // of maps over the image
constexpr int kMapRows = 12;

/// The part of `parts` equal ones, along a side of `size` pixels, in which a position lies.
int partOf(double position, int size, int parts);

/// Charts of report.html. Those of the queue are empty panels before hand-over.

/// Expected error of a projection over the image by noise and by halves of the video that disagree
/// beyond it, without a misfit of the lens model; the recording must have an estimate.
Sheet drawUncertainty(const Recording& recording);

/// rms residual over the image, with the mean residual as arrows.
Sheet drawResidualMap(const Recording& recording);

/// How often the queue's observations cover each part of the image.
Sheet drawCoverage(const Recording& recording);

/// The distribution of residuals, beside the one that is expected.
Sheet drawResidualDistribution(const Recording& recording);

/// rms of the residuals over what their sigmas lead to expect; 0 without any.
double residualRatio(const Recording& recording);

/// Residuals by distance from the principal point: their size, and their mean outwards.
Sheet drawResidualsByRadius(const Recording& recording);

/// Their size in each keyframe of the queue; `origin_ns` is 0 s of the axis.
Sheet drawResidualsOverTime(const Recording& recording, std::int64_t origin_ns);

/// The path from above, that is, along the mean direction that points down in the images; beside
/// it, aligned, the one with a reference calibration and the ground truth, where there are any.
/// `unit`: in which the poses are; where there is a ground truth all is in its units.
Sheet drawTrajectory(const std::vector<StampedCameraPose>& own,
                     const std::vector<StampedCameraPose>& with_reference,
                     const std::vector<StampedCameraPose>& ground_truth, std::string unit);

/// Of what an audit says.
Colour verdictColour(AuditVerdict verdict);

}  // namespace camera_self_calibration
