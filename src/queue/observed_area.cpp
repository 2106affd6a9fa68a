#include "camera_self_calibration/queue/observed_area.h"

#include <algorithm>
#include <bitset>
#include <cmath>

namespace camera_self_calibration {
namespace {

constexpr int kColumns = ImageField::kColumns;
constexpr int kRows = ImageField::kRows;
// A corner is an eighth of the image's width and height.
constexpr int kCornerColumns = kColumns / 8;
constexpr int kCornerRows = kRows / 8;

struct Corner {
  const char* name;
  int column;  // of its first grid point
  int row;
};

constexpr Corner kCorners[] = {{"upper left", 0, 0},
                               {"upper right", kColumns - kCornerColumns, 0},
                               {"lower left", 0, kRows - kCornerRows},
                               {"lower right", kColumns - kCornerColumns, kRows - kCornerRows}};

bool seesCorner(const ImageField& field, const Corner& corner) {
  for (int row = corner.row; row < corner.row + kCornerRows; ++row) {
    for (int column = corner.column; column < corner.column + kCornerColumns; ++column) {
      if (field.sees(column, row)) return true;
    }
  }
  return false;
}

}  // namespace

ImageField observedArea(const std::vector<Candidate>& queue, const Camera& camera,
                        const ImageField& seeing) {
  std::bitset<kColumns * kRows> reached;
  const auto reach = [&](const Eigen::Vector2d& pixel) {
    const double x = pixel.x() * (kColumns - 1.0) / (camera.width() - 1);
    const double y = pixel.y() * (kRows - 1.0) / (camera.height() - 1);
    if (!(std::abs(x) < 2.0 * kColumns && std::abs(y) < 2.0 * kRows)) return;
    const int column = static_cast<int>(std::lround(x));
    const int row = static_cast<int>(std::lround(y));
    for (int r = std::max(0, row - 1); r <= std::min(kRows - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(kColumns - 1, column + 1); ++c) {
        reached.set(static_cast<std::size_t>(r * kColumns + c));
      }
    }
  };
  for (const Candidate& candidate : queue) {
    for (const Observation& seen : candidate.segment.observations) reach(seen.pixel);
  }
  ImageField observed = seeing;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      if (!reached[static_cast<std::size_t>(row * kColumns + column)]) {
        observed.setDark(column, row);
      }
    }
  }
  return observed;
}

ImageWeights featureWeights(const std::vector<Candidate>& queue, const Camera& camera) {
  ImageWeights weights(camera.width(), camera.height());
  for (const Candidate& candidate : queue) {
    for (const Observation& seen : candidate.segment.observations) weights.count(seen.pixel);
  }
  return weights;
}

std::string unseenCorners(const ImageField& observed, const ImageField& seeing) {
  std::vector<std::string> names;
  for (const Corner& corner : kCorners) {
    if (seesCorner(seeing, corner) && !seesCorner(observed, corner)) names.push_back(corner.name);
  }
  if (names.empty()) return "";
  std::string text = "no feature of the images that the calibration rests on reached the ";
  if (names.size() == std::size(kCorners)) return text + "corners";
  for (std::size_t i = 0; i < names.size(); ++i) {
    const char* const before = i == 0 ? "" : i + 1 < names.size() ? ", the " : " and the ";
    text += before + names[i];
  }
  return text + (names.size() == 1 ? " corner" : " corners");
}

}  // namespace camera_self_calibration
