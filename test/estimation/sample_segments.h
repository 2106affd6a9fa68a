#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/simulation/segment_maker.h"

namespace camera_self_calibration {

/// One ordinary lens of each model.
inline std::vector<Camera> ordinaryCameras() {
  return {camera640(CameraModel::kPinhole, {420, 418, 322, 238}),
          camera640(CameraModel::kFov, {300, 302, 318, 242, 0.95}),
          camera640(CameraModel::kRadtan, {420, 422, 318, 243, -0.25, 0.07, 1e-3, -5e-4}),
          camera640(CameraModel::kEquidistant, {300, 301, 322, 238, -0.02, 0.01, -0.004, 0.001})};
}

/// A simulated segment, small enough for dense algebra.
inline SimulatedSegment smallSegment(const Camera& camera, LandmarkOrigin origin,
                                     double pixel_sigma, std::uint64_t seed, int keyframes = 5,
                                     int features = 16) {
  SegmentOptions options;
  options.camera = camera;
  options.origin = origin;
  options.keyframes = keyframes;
  options.keyframe_interval_s = 0.3;
  options.tracks.max_features = features;
  options.tracks.pixel_sigma = pixel_sigma;
  return makeSegment(options, seed);
}

/// Every `nth` landmark moves through the image by itself, 3 px a keyframe, or stays where it was
/// first seen, as what the camera carries does. Tells for each whether it does.
inline std::vector<char> letMove(std::size_t nth, bool carried, Segment* segment) {
  constexpr double kStepPx = 3.0;
  std::vector<char> moves(segment->landmarks.size(), 0);
  for (std::size_t l = 0; l < moves.size(); l += nth) moves[l] = 1;
  std::vector<const Observation*> first(moves.size(), nullptr);
  for (Observation& observation : segment->observations) {
    const auto l = static_cast<std::size_t>(observation.landmark);
    if (moves[l] == 0) continue;
    if (first[l] == nullptr) first[l] = &observation;
    const Landmark& landmark = segment->landmarks[l];
    const double steps = observation.keyframe - landmark.reference;
    const auto angle = static_cast<double>(l);
    observation.pixel =
        carried ? (landmark.anchored ? landmark.reference_pixel : first[l]->pixel)
                : observation.pixel +
                      kStepPx * steps * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
  return moves;
}

inline Camera withParameters(Camera camera, const Intrinsics& parameters) {
  camera.setParameters(parameters);
  return camera;
}

/// Start values for the intrinsics: a few per cent of the focal length, pixels of the centre, and
/// of the distortion what moves the image's corners by some pixels.
inline Camera perturbedCamera(const Camera& camera, std::uint64_t seed, double amount = 1.0) {
  Random random(mixSeed(seed, 77));
  Intrinsics parameters = camera.parameters();
  for (int i = 0; i < camera.estimatedCount(); ++i) {
    const double size = i < 2   ? 0.02 * parameters(i)
                        : i < 4 ? 5.0
                        : i < 6 ? 0.02
                                : (camera.model() == CameraModel::kRadtan ? 1e-3 : 0.005);
    parameters(i) += amount * size * random.uniform(-1.0, 1.0);
  }
  return withParameters(camera, parameters);
}

}  // namespace camera_self_calibration
