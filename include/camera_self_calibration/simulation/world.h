#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace camera_self_calibration {

/// How a surface is painted. All but kImage are drawn by a program from a seed (paintTexture).
enum class TextureKind {
  kPlain,    ///< Nearly uniform: weak texture.
  kPlaster,  ///< Faint clouds and a few marks.
  kBricks,
  kPanels,  ///< Nested frames, as of doors and cupboards.
  kPlanks,
  kTiles,
  kCarpet,
  kPoster,  ///< Figures, stripes and writing of many sizes.
  kBooks,
  kCrate,
  kImage  ///< The given image.
};

/// What a surface looks like: a recipe, so that a world without images costs nothing.
struct TextureRecipe {
  TextureKind kind = TextureKind::kPlain;
  std::uint64_t seed = 0;
  double gray = 128.0;              ///< Mean gray level, roughly [0 ... 255].
  double texels_per_metre = 256.0;  ///< Finest detail; ignored by kImage.
  cv::Mat image;                    ///< Of kImage, CV_8UC1; stretched over the whole surface.
};

/// A rectangle seen from one side: the one from which `u` points right and `v` points down, as the
/// columns and rows of its texture do.
struct Surface {
  Eigen::Vector3d corner = Eigen::Vector3d::Zero();  ///< Upper left, world frame [m].
  Eigen::Vector3d u = Eigen::Vector3d::UnitX();      ///< Whole upper edge [m].
  Eigen::Vector3d v = Eigen::Vector3d::UnitY();      ///< Whole left edge, perpendicular to u [m].
  TextureRecipe texture;

  /// Unit normal, towards the side from which it is seen.
  Eigen::Vector3d normal() const { return v.cross(u).normalized(); }
  /// Point at the fractions a, b in [0, 1] of u and v.
  Eigen::Vector3d at(double a, double b) const { return corner + a * u + b * v; }

  /// Rectangle of `width` x `height` [m] about `centre` whose unit normal is `normal` and whose
  /// texture stands upright with respect to the unit vector `up` (perpendicular to the normal).
  static Surface facing(const Eigen::Vector3d& centre, const Eigen::Vector3d& normal,
                        const Eigen::Vector3d& up, double width, double height,
                        const TextureRecipe& texture);
};

/// Where a ray meets the world first.
struct Hit {
  int surface = 0;        ///< Index into World::surfaces.
  double distance = 0.0;  ///< In lengths of the ray's direction vector.
  double a = 0.0;         ///< Fraction of the surface's u, in [0, 1].
  double b = 0.0;         ///< Fraction of the surface's v, in [0, 1].
};

/// A scene of textured rectangles: a plain value. z points up; lengths in metres.
struct World {
  std::vector<Surface> surfaces;
  /// Where a camera may move without touching anything.
  Eigen::AlignedBox3d free_space;

  /// The nearest surface along a ray (direction of any length); nothing where the ray leaves.
  std::optional<Hit> castRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  /// Whether nothing stands between `eye` and a point on a surface (or in free space).
  bool visible(const Eigen::Vector3d& eye, const Eigen::Vector3d& point) const;
};

/// Appends the outer faces of a box that stands upright, turned by `yaw` [rad] about its vertical
/// axis. `size` are full edge lengths [m]. The faces' seeds follow from that of the recipes.
void addBox(const Eigen::Vector3d& centre, const Eigen::Vector3d& size, double yaw,
            const TextureRecipe& sides, const TextureRecipe& top, World* world);

}  // namespace camera_self_calibration
