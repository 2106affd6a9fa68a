#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <random>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/tracking/image_view.h"

namespace camera_self_calibration {

/// An image that owns its pixels.
struct TestImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;

  ImageView view(std::int64_t stamp_ns = 0) const {
    return {nullptr, pixels.data(), width, height, width, stamp_ns};
  }
};

/// A cubic room of 4 m (x right, y down, z forward from its centre) whose walls carry a texture of
/// overlapping random rectangles and discs, and, if wanted, a square card that floats in it. The
/// texture is a continuous function (bilinear between fine texels), so that what a camera sees is
/// known exactly at any sub-pixel position.
class TexturedBox {
 public:
  static constexpr double kHalfSide = 2.0;  // [m]

  explicit TexturedBox(std::uint64_t seed);

  /// A card parallel to the x-y plane: centre and half side [m].
  void setCard(const Eigen::Vector3d& centre, double half_side);

  /// First point hit from `origin`, inside the room, along `direction`.
  struct Hit {
    Eigen::Vector3d point;
    bool on_card = false;
    float gray = 0.0f;
  };
  Hit cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

 private:
  float texture(double u, double v) const;

  static constexpr int kTexels = 1024;  // A side; the texture repeats.
  static constexpr double kTexelsPerMetre = 256.0;
  std::vector<float> texels_;
  bool has_card_ = false;
  Eigen::Vector3d card_ = Eigen::Vector3d::Zero();
  double card_half_side_ = 0.0;
};

/// Renders what a camera sees, each pixel the mean over a grid of rays.
class BoxRenderer {
 public:
  BoxRenderer(const TexturedBox& box, const Camera& camera, int rays_per_side);

  struct Photometry {
    double gain = 1.0;
    double offset = 0.0;
    double noise = 1.0;  ///< Standard deviation [gray].
  };
  TestImage render(const Rigid3& world_from_camera, const Photometry& photometry,
                   std::mt19937_64* random) const;

  /// The point of the world behind a pixel.
  std::optional<TexturedBox::Hit> hit(const Rigid3& world_from_camera,
                                      const Eigen::Vector2d& pixel) const;

  /// Where `seen`, the point behind a pixel of one image, is in another; nothing if hidden.
  std::optional<Eigen::Vector2d> project(const Rigid3& world_from_camera,
                                         const Eigen::Vector3d& point) const;

  const Camera& camera() const { return camera_; }

 private:
  TexturedBox box_;
  Camera camera_;
  int rays_per_pixel_;
  std::vector<Eigen::Vector3f> rays_;  // All rays of a pixel side by side; zero: no ray.
};

}  // namespace camera_self_calibration
