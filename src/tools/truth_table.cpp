#include "camera_self_calibration/tools/truth_table.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

namespace camera_self_calibration {
namespace {

double zOf(double truth, double estimate, double sigma) {
  const double error = std::abs(estimate - truth);
  if (error == 0.0) return 0.0;
  return sigma > 0.0 ? error / sigma : std::numeric_limits<double>::infinity();
}

}  // namespace

TruthComparison compareWithTruth(const Calibration& truth, const Calibration& estimate) {
  TruthComparison result;
  result.converged = estimate.calibration_state == Calibration::CONVERGED;
  result.same_model = !truth.parameter_names.empty() && truth.model == estimate.model &&
                      truth.parameter_names == estimate.parameter_names;
  if (!result.same_model) {
    result.table = "no common parameters: the truth is " + truth.model + ", the estimate " +
                   estimate.model + "\n";
    return result;
  }
  std::ostringstream table;
  table << "parameter |      truth |   estimate |    sigma | error / sigma\n" << std::fixed;
  for (std::size_t i = 0; i < truth.values.size(); ++i) {
    const double z = zOf(truth.values[i], estimate.values[i], estimate.sigma[i]);
    result.largest_z = std::max(result.largest_z, z);
    table << std::left << std::setw(9) << truth.parameter_names[i] << " | " << std::right
          << std::setprecision(5) << std::setw(10) << truth.values[i] << " | " << std::setw(10)
          << estimate.values[i] << " | " << std::setw(8) << estimate.sigma[i] << " | "
          << std::setprecision(2) << std::setw(8) << z << '\n';
  }
  result.table = table.str();
  return result;
}

}  // namespace camera_self_calibration
