#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/simulation/painted_world.h"
#include "camera_self_calibration/simulation/ray_tiles.h"
#include "camera_self_calibration/simulation/sensor.h"
#include "camera_self_calibration/simulation/surface_view.h"
#include "camera_self_calibration/simulation/trajectory.h"

namespace camera_self_calibration {

struct RendererOptions {
  SensorOptions sensor;
  double exposure_s = 0.0;    ///< Motion blur over this time, about the stamp [s].
  int blur_images = 6;        ///< Averaged over the exposure.
  double line_delay_s = 0.0;  ///< Rolling shutter: row r is seen at stamp + r * line_delay_s [s].
  int threads = 1;            ///< The image does not depend on it.

  /// Every violated bound in one sentence each; empty if all is well.
  std::vector<std::string> problems() const;
};

/// Gray images of a painted world through any camera model: one ray a pixel, computed once,
/// textures filtered over the pixel's footprint, edges over its area. Not for use by two threads at
/// once.
class Renderer {
 public:
  /// Throws std::invalid_argument that lists options.problems(), or if there is no world or the
  /// camera is not valid().
  Renderer(std::shared_ptr<const PaintedWorld> world, const Camera& camera,
           const RendererOptions& options);

  /// CV_8UC1 at a time of a trajectory, with blur and rolling shutter as in the options, the light
  /// multiplied by `gain`. Pixels without a ray are black.
  cv::Mat render(const Trajectory& trajectory, double time_s, std::uint64_t noise_seed,
                 double gain = 1.0) const;

  /// The same from one pose, bodies as they are at time 0.
  cv::Mat render(const Rigid3& world_from_camera, std::uint64_t noise_seed) const;

  /// Light before the sensor: CV_32FC1, gray values of the textures, from one pose, bodies as they
  /// are at time 0.
  cv::Mat light(const Rigid3& world_from_camera) const;

  const Camera& camera() const { return camera_; }

 private:
  using Views = std::vector<SurfaceView>;

  // `row_views` has one entry for all rows, or one a row; `weight` times the light is added.
  void add(const std::vector<Views>& row_views, float weight, cv::Mat* light) const;
  void addTileRow(int tile_row, const std::vector<Views>& row_views, float weight,
                  cv::Mat* light) const;
  std::vector<Views> viewsAt(const Trajectory& trajectory, double time_s) const;

  std::shared_ptr<const PaintedWorld> world_;
  Camera camera_;
  RendererOptions options_;
  RayTiles rays_;
  std::vector<RayCone> blocks_;  // cones around runs of tiles, row by row
  Sensor sensor_;
};

}  // namespace camera_self_calibration
