#include "camera_self_calibration/plotting/palette.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace camera_self_calibration {
namespace {

Colour rgb(int red, int green, int blue) { return {double(blue), double(green), double(red)}; }

}  // namespace

const Palette& palette(Theme theme) {
  static const Palette light = {rgb(255, 255, 255), rgb(248, 249, 251), rgb(222, 226, 232),
                                rgb(32, 38, 46),    rgb(116, 124, 136), rgb(24, 100, 190),
                                rgb(190, 214, 242), rgb(216, 60, 60)};
  static const Palette dark = {rgb(24, 26, 31),    rgb(32, 35, 42),    rgb(54, 59, 69),
                               rgb(228, 232, 238), rgb(142, 150, 163), rgb(96, 176, 255),
                               rgb(42, 76, 116),   rgb(255, 110, 100)};
  return theme == Theme::kLight ? light : dark;
}

Colour stateColour(CalibrationState state) {
  switch (state) {
    case CalibrationState::kWaitingForMotion:
      return rgb(128, 134, 145);
    case CalibrationState::kInitializing:
      return rgb(70, 130, 220);
    case CalibrationState::kConverging:
      return rgb(226, 150, 20);
    case CalibrationState::kConverged:
      return rgb(46, 160, 87);
    case CalibrationState::kDegenerate:
      return rgb(212, 58, 58);
  }
  return rgb(128, 134, 145);
}

Colour eventColour(EventType type) {
  switch (type) {
    case EventType::kCalibrationChange:
    case EventType::kMountChanged:
    case EventType::kLost:
      return stateColour(CalibrationState::kDegenerate);
    case EventType::kConverged:
    case EventType::kRelocalized:
      return stateColour(CalibrationState::kConverged);
    case EventType::kNoLongerConverged:
      return stateColour(CalibrationState::kConverging);
    case EventType::kHandover:
    case EventType::kInput:
      break;
  }
  return stateColour(CalibrationState::kInitializing);
}

Colour scoreColour(double share) {
  static const std::array<Colour, 5> stops = {
      rgb(253, 231, 37), rgb(94, 201, 98), rgb(33, 145, 140), rgb(64, 92, 160), rgb(104, 52, 140)};
  const double position = std::clamp(std::isfinite(share) ? share : 1.0, 0.0, 1.0) * 4.0;
  const auto index = std::min<std::size_t>(3, static_cast<std::size_t>(position));
  const double t = position - static_cast<double>(index);
  return stops[index] * (1.0 - t) + stops[index + 1] * t;
}

}  // namespace camera_self_calibration
