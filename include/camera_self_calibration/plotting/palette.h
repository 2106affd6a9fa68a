#pragma once

#include <opencv2/core/types.hpp>

#include "camera_self_calibration/pipeline/health.h"
#include "camera_self_calibration/pipeline/results.h"

namespace camera_self_calibration {

/// Blue, green, red, 0 to 255 each.
using Colour = cv::Scalar;

/// Light for paper and web pages, dark to stand beside the 3D view of rviz.
enum class Theme { kLight, kDark };

struct Palette {
  Colour background;
  Colour panel;  ///< Behind curves.
  Colour grid;
  Colour text;
  Colour faint_text;
  Colour curve;
  Colour band;   ///< Around the curve: 3 sigma.
  Colour truth;  ///< A known value to compare with.
};

const Palette& palette(Theme theme);

/// The colour that stands for a state everywhere: grey waiting, blue initializing, amber
/// converging, green converged, red degenerate.
Colour stateColour(CalibrationState state);

/// Red for what went wrong, green for what is well again, blue for the rest.
Colour eventColour(EventType type);

/// From yellow (0, best) over green to dark blue (1, worst); values outside are clamped. Differs in
/// lightness too, so that it reads without colour vision.
Colour scoreColour(double share);

/// From dark blue (0) to bright yellow (1) for maps of an error: the reverse of scoreColour.
inline Colour errorColour(double share) { return scoreColour(1.0 - share); }

}  // namespace camera_self_calibration
