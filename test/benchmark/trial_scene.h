#pragma once

#include <cstdint>
#include <string>

#include "camera_self_calibration/simulation/trajectory.h"
#include "camera_self_calibration/simulation/world.h"

namespace camera_self_calibration {

/// How a camera moves in a trial, and before what.
enum class Scene {
  kHandheld,    ///< All six degrees of freedom, in a furnished room.
  kForward,     ///< Along the optical axis, no rotation.
  kSideways,    ///< Across it, no rotation.
  kOneAxis,     ///< Pans on the spot.
  kYawDriving,  ///< As a car.
  kPlane,       ///< Across and along the optical axis and rolling, before one wall seen frontally.
};

/// What a camera does before its motion begins.
enum class Idle { kNone, kStanding, kDriving, kNoTexture };

std::string toString(Scene scene);
std::string toString(Idle idle);

struct TrialScene {
  World world;
  Trajectory trajectory;
};

/// A room (or wall) and a motion of `good_s` seconds, after `idle_s` seconds of standing or of
/// driving to and fro along the optical axis without rotation, from the same pose. The seed decides
/// on room, motion and its speed.
TrialScene makeScene(Scene scene, double good_s, Idle idle, double idle_s, std::uint64_t seed);

}  // namespace camera_self_calibration
