#pragma once

#include <string>

namespace camera_self_calibration {

class ImageField;
struct QueueSolution;

/// Two calibrations of one lens from two halves of the queue's segments, which share no image: how
/// far they are apart, and how far their uncertainties say that they should be. An error that both
/// halves share, as of a lens model that does not fit, does not show.
struct CrossValidation {
  bool compared = false;       ///< Else a half alone does not determine the intrinsics.
  double difference_px = 0.0;  ///< Over the image, a rotation of the camera removed [px rms].
  double expected_px = 0.0;    ///< By the stated uncertainties of the halves [px rms].
  double p_value = 1.0;        ///< Probability of so large a difference by chance.

  bool agrees() const;
  /// What an error of one half must exceed for the other to notice it [px rms]: expected_px;
  /// infinite where they were not compared.
  double blindBelowPx() const;
  /// The factor that the uncertainty lacks to explain the difference; 1 where chance does.
  double inflation() const;
  /// In words; empty unless compared.
  std::string sentence() const;
};

/// To first order about the joint estimate, from what each segment said there: nothing is solved
/// again. The halves are as equally good as they can be. The squared difference `d^T G d` (see
/// pixelMetric) is held against the chi-square distribution with its mean and variance
/// (Satterthwaite 1946); against Fisher's where the segments' scatter had to be estimated.
CrossValidation crossValidate(const QueueSolution& solution, const ImageField& field);

}  // namespace camera_self_calibration
