#include "tracking/textured_box.h"

#include <algorithm>
#include <cmath>

namespace camera_self_calibration {
namespace {

constexpr int kLeaves = 9000;

// One pass of a [1 2 1] / 4 kernel along one axis of a texture that repeats.
void blur(std::vector<float>* texels, int side, bool along_x) {
  const std::vector<float> in = *texels;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      const auto at = [&](int k) {
        const int column = along_x ? (x + k + side) % side : x;
        const int row = along_x ? y : (y + k + side) % side;
        return in[static_cast<std::size_t>(row * side + column)];
      };
      (*texels)[static_cast<std::size_t>(y * side + x)] = 0.25f * (at(-1) + 2.0f * at(0) + at(1));
    }
  }
}

}  // namespace

TexturedBox::TexturedBox(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  texels_.assign(kTexels * kTexels, 128.0f);
  for (int leaf = 0; leaf < kLeaves; ++leaf) {
    const double cx = kTexels * unit(random), cy = kTexels * unit(random);
    // Many small ones, few large.
    const double size = 6.0 / std::sqrt(0.02 + unit(random));
    const double angle = 2.0 * M_PI * unit(random), aspect = 0.4 + 0.6 * unit(random);
    const bool disc = unit(random) < 0.3;
    const auto gray = static_cast<float>(30.0 + 190.0 * unit(random));
    const int reach = static_cast<int>(1.5 * size) + 1;
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        const double a = std::cos(angle) * x + std::sin(angle) * y;
        const double b = (std::cos(angle) * y - std::sin(angle) * x) / aspect;
        if (disc ? a * a + b * b > size * size : std::max(std::abs(a), std::abs(b)) > size) {
          continue;
        }
        const int column = (static_cast<int>(cx) + x + kTexels) % kTexels;
        const int row = (static_cast<int>(cy) + y + kTexels) % kTexels;
        texels_[static_cast<std::size_t>(row * kTexels + column)] = gray;
      }
    }
  }
  for (int pass = 0; pass < 2; ++pass) {
    blur(&texels_, kTexels, true);
    blur(&texels_, kTexels, false);
  }
}

void TexturedBox::setCard(const Eigen::Vector3d& centre, double half_side) {
  has_card_ = true;
  card_ = centre;
  card_half_side_ = half_side;
}

float TexturedBox::texture(double u, double v) const {
  constexpr int mask = kTexels - 1;
  const double x = u * kTexelsPerMetre + 64.0 * kTexels, y = v * kTexelsPerMetre + 64.0 * kTexels;
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const auto fx = static_cast<float>(x - ix), fy = static_cast<float>(y - iy);
  const float* top = texels_.data() + (iy & mask) * kTexels;
  const float* bottom = texels_.data() + ((iy + 1) & mask) * kTexels;
  const int x0 = ix & mask, x1 = (ix + 1) & mask;
  return (1.0f - fy) * ((1.0f - fx) * top[x0] + fx * top[x1]) +
         fy * ((1.0f - fx) * bottom[x0] + fx * bottom[x1]);
}

TexturedBox::Hit TexturedBox::cast(const Eigen::Vector3d& origin,
                                   const Eigen::Vector3d& direction) const {
  Hit hit;
  if (has_card_ && direction.z() != 0.0) {
    const double t = (card_.z() - origin.z()) / direction.z();
    const Eigen::Vector3d point = origin + t * direction;
    const Eigen::Vector3d offset = point - card_;
    if (t > 0.0 && std::max(std::abs(offset.x()), std::abs(offset.y())) <= card_half_side_) {
      return {point, true, texture(0.7 + offset.x(), 0.3 + offset.y())};
    }
  }
  int axis = 0;
  double nearest = 1e9;
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0.0) continue;
    const double t = (std::copysign(kHalfSide, direction[k]) - origin[k]) / direction[k];
    if (t < nearest) nearest = t, axis = k;
  }
  hit.point = origin + nearest * direction;
  // Each wall shows another part of the texture.
  const double shift = 0.53 * axis + (direction[axis] > 0.0 ? 0.0 : 1.77);
  hit.gray = texture(hit.point[(axis + 1) % 3] + shift, hit.point[(axis + 2) % 3] + 1.3 * shift);
  return hit;
}

BoxRenderer::BoxRenderer(const TexturedBox& box, const Camera& camera, int rays_per_side)
    : box_(box), camera_(camera), rays_per_pixel_(rays_per_side * rays_per_side) {
  for (int y = 0; y < camera.height(); ++y) {
    for (int x = 0; x < camera.width(); ++x) {
      for (int k = 0; k < rays_per_pixel_; ++k) {
        const double dx = (k % rays_per_side + 0.5) / rays_per_side - 0.5;
        const double dy = (k / rays_per_side + 0.5) / rays_per_side - 0.5;
        const auto ray = camera.unproject(Eigen::Vector2d(x + dx, y + dy));
        rays_.push_back(ray ? Eigen::Vector3f(ray->cast<float>()) : Eigen::Vector3f::Zero());
      }
    }
  }
}

TestImage BoxRenderer::render(const Rigid3& world_from_camera, const Photometry& photometry,
                              std::mt19937_64* random) const {
  TestImage image{camera_.width(), camera_.height(), {}};
  image.pixels.resize(static_cast<std::size_t>(image.width * image.height));
  const Eigen::Matrix3d rotation = world_from_camera.rotation.toRotationMatrix();
  std::normal_distribution<double> normal;
  const Eigen::Vector3f* ray = rays_.data();
  for (std::uint8_t& pixel : image.pixels) {
    double sum = 0.0;
    for (int k = 0; k < rays_per_pixel_; ++k, ++ray) {
      if (ray->isZero()) continue;
      sum += box_.cast(world_from_camera.translation, rotation * ray->cast<double>()).gray;
    }
    const double gray = photometry.gain * sum / rays_per_pixel_ + photometry.offset +
                        photometry.noise * normal(*random);
    pixel = static_cast<std::uint8_t>(std::clamp(std::round(gray), 0.0, 255.0));
  }
  return image;
}

std::optional<TexturedBox::Hit> BoxRenderer::hit(const Rigid3& world_from_camera,
                                                 const Eigen::Vector2d& pixel) const {
  const auto ray = camera_.unproject(pixel);
  if (!ray) return std::nullopt;
  return box_.cast(world_from_camera.translation, world_from_camera.rotation * *ray);
}

std::optional<Eigen::Vector2d> BoxRenderer::project(const Rigid3& world_from_camera,
                                                    const Eigen::Vector3d& point) const {
  const Eigen::Vector3d direction = point - world_from_camera.translation;
  const TexturedBox::Hit seen = box_.cast(world_from_camera.translation, direction);
  if ((seen.point - point).norm() > 1e-6) return std::nullopt;
  Eigen::Vector2d pixel;
  if (!camera_.project(world_from_camera.inverse() * point, &pixel)) return std::nullopt;
  return pixel;
}

}  // namespace camera_self_calibration
