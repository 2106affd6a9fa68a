#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "camera_self_calibration/plotting/sheet.h"
#include "camera_self_calibration/rig/rig_estimate.h"
#include "camera_self_calibration/tools/rig_files.h"

namespace camera_self_calibration {

/// Two cameras of which one sees what the other follows.
struct CameraPair {
  int from = 0;
  int to = 1;
};

/// Pairs with so many views in common that a map of them shows something.
std::vector<CameraPair> pairsOf(const RigEvidence& evidence, int cameras);

struct EpipolarError {
  double rms = 0.0;  ///< [px]
  int views = 0;
};

/// How far the views of a pair are from their epipolar lines.
EpipolarError epipolarError(const Rig& rig, const std::vector<SharedView>& shared,
                            const CameraPair& pair);

/// The same over the image of `pair.to` for several rigs, each with a title, in one scale of
/// colours that suits the last of them.
std::vector<Sheet> drawEpipolarMaps(const std::vector<std::pair<std::string, Rig>>& rigs,
                                    const std::vector<SharedView>& shared, const CameraPair& pair);

/// The images of the example side by side as stereo_image_proc rectifies them, with lines along the
/// rows and the views that both share. Empty without an example.
cv::Mat drawRectifiedPair(const StereoPair& pair, const RigEvidence& evidence);

/// How far the rows of all shared views differ in the rectified pair [px].
EpipolarError rowError(const StereoPair& pair, const std::vector<SharedView>& shared);

}  // namespace camera_self_calibration
