#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/simulation/lens.h"
#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/trajectory.h"
#include "camera_self_calibration/simulation/world.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

struct FeatureTracksOptions {
  std::uint64_t seed = 1;
  int max_features = 128;           ///< Live tracks, at most.
  double pixel_sigma = 0.2;         ///< Of each measurement, per axis, independent [px].
  double reported_sigma = 0.0;      ///< Track::sigma; 0: pixel_sigma, or 0.1 px if that is 0 [px].
  double reference_sigma = 0.0;     ///< Of the reference pixel, per axis: a noisy anchor [px].
  double outlier_share = 0.0;       ///< Of measurements that are off by 3 px to outlier_px.
  double outlier_px = 20.0;         ///< [px]
  double drifting_share = 0.0;      ///< Of tracks that slide along the image, 1 to 3 px a frame.
  double loss_probability = 0.002;  ///< Of a track, per frame, without a cause in the scene.
  double border_px = 8.0;           ///< No measurements nearer to the edge of the image [px].
  bool occlusion = true;            ///< Hidden points are lost.
  double line_delay_s = 0.0;        ///< Rolling shutter: row r is seen at stamp + r * line_delay_s.
  std::int64_t start_stamp_ns = 0;  ///< Stamp of the trajectory's time 0 [ns].

  /// Every violated bound in one sentence each; empty if all is well.
  std::vector<std::string> problems() const;
};

/// Feature tracks without images: points on the world's surfaces, seen through a camera that moves
/// along a trajectory. The protocol is that of Tracker: track(), detect(), drop(), reset(). Equal
/// options and calls give equal tracks.
class FeatureTracks {
 public:
  /// Throws std::invalid_argument that lists options.problems(), or if the camera is not valid().
  FeatureTracks(World world, Lens lens, Trajectory trajectory, const FeatureTracksOptions& options);

  /// Advances all live tracks to the time of a stamp [ns]; those out of view end.
  const TrackedFrame& track(std::int64_t stamp_ns);

  /// Starts tracks at random free places of the frame tracked last, up to max_features.
  std::vector<Track> detect();

  /// Ends tracks. Unknown ids are ignored.
  void drop(const std::vector<std::int64_t>& ids);

  /// Ends all tracks.
  void reset();

  // Ground truth.

  /// The 3-D point of a track that lives, world frame [m].
  std::optional<Eigen::Vector3d> point(std::int64_t id) const;
  /// Whether the track's measurement in the newest frame is a gross error.
  bool isOutlier(std::int64_t id) const { return outliers_.count(id) > 0; }
  /// Where a point is seen at a time without noise; nothing if it is not in the image or hidden.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& point, double time_s) const;
  Rigid3 worldFromCamera(std::int64_t stamp_ns) const {
    return trajectory_.worldFromCamera(timeOf(stamp_ns));
  }
  Camera cameraAt(std::int64_t stamp_ns) const { return lens_.at(timeOf(stamp_ns)); }
  const Trajectory& trajectory() const { return trajectory_; }
  double timeOf(std::int64_t stamp_ns) const {
    return toSeconds(stamp_ns - options_.start_stamp_ns);
  }

 private:
  struct Live {
    Track track;
    Eigen::Vector3d point;
    Eigen::Vector2d drift_per_frame = Eigen::Vector2d::Zero();
    Eigen::Vector2d drift = Eigen::Vector2d::Zero();
  };

  bool advance(Live* live);
  std::optional<Live> startTrack();
  bool isFree(const Eigen::Vector2d& pixel) const;
  Rigid3 poseOfRow(double row) const;

  World world_;
  Lens lens_;
  Trajectory trajectory_;
  FeatureTracksOptions options_;
  Random random_;
  double time_s_ = 0.0;
  std::int64_t next_id_ = 0;
  std::vector<Live> live_;
  TrackedFrame frame_;
  std::unordered_set<std::int64_t> outliers_;
};

}  // namespace camera_self_calibration
