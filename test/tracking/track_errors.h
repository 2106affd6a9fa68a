#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
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

struct SequenceOptions {
  int images = 40;
  int detect_every = 5;
  std::uint64_t noise_seed = 1;
  TrackerOptions tracker;
  std::function<Rigid3(int)> world_from_camera;
  std::function<BoxRenderer::Photometry(int)> photometry = [](int) {
    return BoxRenderer::Photometry();
  };
};

/// Renders a sequence, tracks through it, and compares every measurement with the truth.
std::vector<TrackSample> trackSequence(const BoxRenderer& renderer, const SequenceOptions& options);

double median(std::vector<double> values);

/// Smooth motion of a hand-held camera: amplitudes of translation [m] and rotation [rad] per axis.
Rigid3 handHeldPose(int image, const Eigen::Vector3d& translation, const Eigen::Vector3d& rotation,
                    double period_images);

}  // namespace camera_self_calibration
