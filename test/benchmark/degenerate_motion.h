#pragma once

#include <cstdint>
#include <string>

#include "camera_self_calibration/simulation/trajectory.h"
#include "camera_self_calibration/simulation/world.h"

namespace camera_self_calibration {

/// Motions and scenes that tell a lens in part or not at all, and two that look as if.
enum class Degeneracy {
  kStanding,
  kNoTexture,     ///< Hand-held, but nothing can be tracked.
  kForward,       ///< To and fro along the optical axis.
  kSideways,      ///< To and fro across it.
  kPan,           ///< Turns about the camera's y axis on the spot.
  kTilt,          ///< ... about x.
  kRoll,          ///< ... about z.
  kYawDriving,    ///< As a car, round and round.
  kFrontalPlane,  ///< Across and along the optical axis and rolling, before one wall.
  kFarScene,      ///< Moves and pans before a scene that is hundreds of metres away.
  kTurning,       ///< Turns about several axes on the spot: informative.
  kVariedPlane    ///< One wall from all sides: informative.
};
constexpr int kDegeneracies = 12;

std::string toString(Degeneracy degeneracy);

/// Whether it tells the whole lens although it is singular.
bool isInformative(Degeneracy degeneracy);

struct DegenerateScene {
  World world;
  Trajectory trajectory;
};

/// `degenerate_s` seconds of one motion, and from then on hand-held motion in the same scene for
/// `good_s` seconds, joined smoothly. The seed decides on room, motion and speed.
DegenerateScene makeDegenerateScene(Degeneracy degeneracy, double degenerate_s, double good_s,
                                    std::uint64_t seed);

/// `good_s` seconds of hand-held motion first, and from then on the degenerate one.
DegenerateScene makeLateDegenerateScene(Degeneracy degeneracy, double good_s, double degenerate_s,
                                        std::uint64_t seed);

}  // namespace camera_self_calibration
