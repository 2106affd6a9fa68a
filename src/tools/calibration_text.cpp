#include "camera_self_calibration/tools/calibration_text.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <vector>

namespace camera_self_calibration {
namespace {

constexpr int kRings = 5;

/// rms and largest distance in rings around a's principal point.
std::string ringsText(const Camera& a, const PixelDifference& difference) {
  const Eigen::Vector2d centre = a.parameters().segment<2>(2);
  double reach = 0.0;
  for (const auto& point : difference.samples) {
    reach = std::max(reach, (point.pixel - centre).norm());
  }
  std::vector<double> sum(kRings, 0.0), largest(kRings, 0.0);
  std::vector<int> count(kRings, 0);
  for (const auto& point : difference.samples) {
    const double share = (point.pixel - centre).norm() / reach;
    const auto ring = static_cast<std::size_t>(std::min(kRings - 1, int(share * kRings)));
    sum[ring] += point.offset.squaredNorm();
    largest[ring] = std::max(largest[ring], point.offset.norm());
    ++count[ring];
  }
  std::ostringstream text;
  text << std::fixed << "from the principal point [px]    rms [px]    max [px]\n";
  for (std::size_t i = 0; i < kRings; ++i) {
    if (count[i] == 0) continue;
    text << std::setprecision(0) << std::setw(14) << reach * i / kRings << " -" << std::setw(6)
         << reach * (i + 1) / kRings << std::setprecision(3) << std::setw(19)
         << std::sqrt(sum[i] / count[i]) << std::setw(12) << largest[i] << "\n";
  }
  return text.str();
}

std::string parametersText(const Camera& a, const Camera& b) {
  const bool a_is_longer = a.parameterCount() >= b.parameterCount();
  const std::vector<std::string> names = (a_is_longer ? a : b).parameterNames();
  const auto value = [](const Camera& camera, std::size_t i) {
    const auto index = static_cast<Eigen::Index>(i);  // k3 that is not there is 0
    return index < camera.parameters().size() ? camera.parameters()[index] : 0.0;
  };
  std::ostringstream text;
  text << "           A             B             B - A\n" << std::fixed << std::setprecision(5);
  for (std::size_t i = 0; i < names.size(); ++i) {
    text << std::left << std::setw(4) << names[i] << std::right << std::setw(14) << value(a, i)
         << std::setw(14) << value(b, i) << std::setw(14) << value(b, i) - value(a, i) << "\n";
  }
  return text.str();
}

}  // namespace

std::string describe(const std::string& path, const CalibrationInFile& file) {
  const Camera& camera = file.stored.camera;
  std::ostringstream text;
  text << path << " (" << toString(file.format)
       << (file.stored.name.empty() ? "" : ", " + file.stored.name)
       << "): " << toString(camera.model()) << ", " << camera.width() << " x " << camera.height()
       << "\n     ";
  const std::vector<std::string> names = camera.parameterNames();
  for (std::size_t i = 0; i < names.size(); ++i) {
    text << " " << names[i] << " " << camera.parameters()[static_cast<Eigen::Index>(i)];
  }
  text << "\n";
  return text.str();
}

std::string comparisonText(const Camera& a, const Camera& b, const PixelDifference& difference) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << "distance " << difference.error.rms << " px rms, "
       << difference.error.max << " px at most over the image, after the rotation of "
       << difference.rotation_deg << " deg that fits best\n";
  if (difference.refused > 0) {
    const auto all = static_cast<double>(difference.points.size()) + difference.refused;
    text << std::setprecision(1) << "not counted: " << 100.0 * difference.refused / all
         << " % of A's image, which B cannot see\n";
  }
  text << "\n" << ringsText(a, difference);
  if (a.model() == b.model()) text << "\n" << parametersText(a, b);
  return text.str();
}

}  // namespace camera_self_calibration
