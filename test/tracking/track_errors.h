#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "camera_self_calibration/tracking/tracker.h"
#include "tracking/textured_box.h"

namespace camera_self_calibration {

/// A measurement of a track, with the truth.
struct TrackSample {
  std::int64_t id = 0;
  int image = 0;
  int age = 0;  ///< Images since detection.
  Eigen::Vector2d reference = Eigen::Vector2d::Zero();
  Eigen::Vector2d truth = Eigen::Vector2d::Zero();
  Eigen::Vector2d last_truth = Eigen::Vector2d::Zero();  ///< One image earlier.
  Eigen::Vector2d error = Eigen::Vector2d::Zero();       ///< Measured less true pixel.
  double sigma = 0.0;
  bool hidden = false;  ///< The point is not visible; truth and error mean nothing.
};

/// Images of a scene, and what is true of it. Images are asked for in order.
struct ExactScene {
  std::function<TestImage(int)> image;
  /// The point of the world behind a pixel of an image.
  std::function<std::optional<Eigen::Vector3d>(int, const Eigen::Vector2d&)> point;
  /// Where a point is in an image; nothing if hidden.
  std::function<std::optional<Eigen::Vector2d>(int, const Eigen::Vector3d&)> pixel;
};

/// Tracks through a scene, detecting in every `detect_every`-th image from the first, and compares
/// every measurement with the truth.
std::vector<TrackSample> trackScene(const ExactScene& scene, int images, int detect_every);

struct BoxSequence {
  int images = 40;
  int detect_every = 5;
  std::uint64_t noise_seed = 1;
  std::function<Rigid3(int)> world_from_camera;
  std::function<BoxRenderer::Photometry(int)> photometry = [](int) {
    return BoxRenderer::Photometry();
  };
};

/// The same for a camera in a textured box.
std::vector<TrackSample> trackSequence(const BoxRenderer& renderer, const BoxSequence& sequence);

/// Signed mean errors of tracks that have moved far along the radius.
struct RadialBin {
  double count = 0.0;
  double radial = 0.0;          ///< [px]
  double along_motion = 0.0;    ///< Of the last image [px].
  double from_reference = 0.0;  ///< Along the motion since detection [px].
};

/// By radius about `centre` in steps of 75 px: the samples of tracks whose radius has grown (or
/// shrunk, if not `outwards`) by 100 px or more since detection.
std::map<int, RadialBin> byRadius(const std::vector<TrackSample>& samples,
                                  const Eigen::Vector2d& centre, bool outwards);

/// Prints the bins, and returns the largest of the means' magnitudes over bins of `least` samples
/// or more [px].
double worstMean(const std::map<int, RadialBin>& bins, const char* direction, double least);

double medianOf(std::vector<double> values);

/// Smooth motion of a hand-held camera: amplitudes of translation [m] and rotation [rad] per axis.
Rigid3 handHeldPose(int image, const Eigen::Vector3d& translation, const Eigen::Vector3d& rotation,
                    double period_images);

}  // namespace camera_self_calibration
