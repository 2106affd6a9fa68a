#pragma once

#include <camera_self_calibration/Calibration.h>

#include <string>

namespace camera_self_calibration {

/// An estimate beside the truth.
struct TruthComparison {
  bool converged = false;   ///< The estimate's state.
  bool same_model = false;  ///< Else nothing can be compared.
  double largest_z = 0.0;   ///< Largest |estimate - truth| / sigma.
  std::string table;        ///< parameter | truth | estimate | sigma | error in sigma.

  /// Converged, and every parameter within three sigma of the truth.
  bool passed() const { return converged && same_model && largest_z <= 3.0; }
};

/// A sigma that is 0 or not a number counts as an infinite error, unless the value is exact.
TruthComparison compareWithTruth(const Calibration& truth, const Calibration& estimate);

}  // namespace camera_self_calibration
