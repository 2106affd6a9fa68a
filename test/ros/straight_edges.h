#pragma once

#include <image_geometry/pinhole_camera_model.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/geometry/rigid3.h"
#include "camera_self_calibration/simulation/world.h"

namespace camera_self_calibration {

/// How far an edge of the scene bends from the straight line between its ends [px].
struct EdgeBow {
  double raw = 0.0;        ///< In the camera's image, as the true lens bends it.
  double rectified = 0.0;  ///< As measured in the rectified image.
};

/// Measures the borders of posters and doors, which are straight in the world, in an image that was
/// rectified.
class StraightEdges {
 public:
  StraightEdges(const World& world, const Camera& lens,
                const image_geometry::PinholeCameraModel& model)
      : world_(world), lens_(lens), model_(model) {}

  std::vector<EdgeBow> measure(const cv::Mat& rectified, const Rigid3& world_from_camera) const {
    std::vector<EdgeBow> bows;
    for (const Surface& surface : world_.surfaces) {
      const TextureKind kind = surface.texture.kind;
      if (kind != TextureKind::kPoster && kind != TextureKind::kPanels) continue;
      for (int side = 0; side < 4; ++side) {
        measureEdge(rectified, world_from_camera, corner(surface, side),
                    corner(surface, (side + 1) % 4), &bows);
      }
    }
    return bows;
  }

 private:
  struct Sample {
    Eigen::Vector2d raw;
    Eigen::Vector2d rectified;
  };
  static constexpr int kSamples = 80;

  static Eigen::Vector3d corner(const Surface& surface, int index) {
    return surface.at(index == 1 || index == 2 ? 1.0 : 0.0, index >= 2 ? 1.0 : 0.0);
  }

  void measureEdge(const cv::Mat& image, const Rigid3& world_from_camera,
                   const Eigen::Vector3d& begin, const Eigen::Vector3d& end,
                   std::vector<EdgeBow>* bows) const {
    std::vector<Sample> samples;
    for (int i = 1; i < kSamples; ++i) {
      const Eigen::Vector3d point = begin + (end - begin) * i / kSamples;
      addSample(image, world_from_camera, point, &samples);
    }
    if (samples.size() < kSamples / 2) return;
    const Eigen::Vector2d span = samples.back().rectified - samples.front().rectified;
    if (span.norm() < 100.0) return;
    std::vector<Eigen::Vector2d> raw;
    std::vector<Eigen::Vector2d> seen;
    for (const Sample& sample : samples) {
      raw.push_back(sample.raw);
      const Eigen::Vector2d normal = Eigen::Vector2d(-span.y(), span.x()).normalized();
      double offset = 0.0;
      if (findEdge(image, sample.rectified, normal, &offset)) {
        seen.push_back(sample.rectified + offset * normal);
      }
    }
    if (seen.size() * 10 < samples.size() * 7) return;
    bows->push_back({bowOf(raw), bowOf(seen)});
  }

  void addSample(const cv::Mat& image, const Rigid3& world_from_camera,
                 const Eigen::Vector3d& point, std::vector<Sample>* samples) const {
    const Eigen::Vector3d p = world_from_camera.inverse() * point;
    Sample sample;
    if (p.z() < 0.2 || !lens_.project(p, &sample.raw) || !lens_.inImage(sample.raw, 8.0)) return;
    const cv::Point2d ideal = model_.project3dToPixel({p.x(), p.y(), p.z()});
    sample.rectified = Eigen::Vector2d(ideal.x, ideal.y);
    const bool inside =
        ideal.x > 8 && ideal.y > 8 && ideal.x < image.cols - 9 && ideal.y < image.rows - 9;
    if (inside && world_.visible(world_from_camera.translation, point)) samples->push_back(sample);
  }

  static double grayAt(const cv::Mat& image, const Eigen::Vector2d& at) {
    const int x = static_cast<int>(at.x());
    const int y = static_cast<int>(at.y());
    const double a = at.x() - x;
    const double b = at.y() - y;
    const auto pixel = [&](int row, int column) {
      return static_cast<double>(image.at<std::uint8_t>(row, column));
    };
    return (1 - b) * ((1 - a) * pixel(y, x) + a * pixel(y, x + 1)) +
           b * ((1 - a) * pixel(y + 1, x) + a * pixel(y + 1, x + 1));
  }

  /// Where within 3 px along the normal the gray value changes most; false without a clear edge.
  static bool findEdge(const cv::Mat& image, const Eigen::Vector2d& at,
                       const Eigen::Vector2d& normal, double* offset) {
    constexpr double kReach = 3.0;
    constexpr double kStep = 0.25;
    constexpr double kLeastContrast = 12.0;
    double weight_sum = 0.0;
    double offset_sum = 0.0;
    double largest = 0.0;
    for (double o = -kReach; o <= kReach; o += kStep) {
      const double gradient =
          std::abs(grayAt(image, at + (o + 0.5) * normal) - grayAt(image, at + (o - 0.5) * normal));
      const double weight = std::pow(gradient, 4);
      weight_sum += weight;
      offset_sum += weight * o;
      largest = std::max(largest, gradient);
    }
    *offset = weight_sum > 0.0 ? offset_sum / weight_sum : 0.0;
    return largest > kLeastContrast;
  }

  /// Height of the arc over its chord, from a parabola through the points, robustly fitted.
  static double bowOf(const std::vector<Eigen::Vector2d>& points) {
    const Eigen::Vector2d begin = points.front();
    const Eigen::Vector2d along = (points.back() - begin).normalized();
    const double length = (points.back() - begin).norm();
    Eigen::Vector3d parabola = Eigen::Vector3d::Zero();
    for (int round = 0; round < 10; ++round) {
      Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
      Eigen::Vector3d g = Eigen::Vector3d::Zero();
      for (const Eigen::Vector2d& point : points) {
        const double t = (point - begin).dot(along) / length - 0.5;
        const double side = (point - begin).x() * along.y() - (point - begin).y() * along.x();
        const Eigen::Vector3d row(1.0, t, t * t);
        const double residual = side - row.dot(parabola);
        const double weight = round == 0 ? 1.0 : 1.0 / (1.0 + std::pow(residual / 0.3, 2));
        h += weight * row * row.transpose();
        g += weight * side * row;
      }
      parabola = h.ldlt().solve(g);
    }
    return std::abs(parabola[2]) / 4.0;
  }

  const World& world_;
  const Camera lens_;
  const image_geometry::PinholeCameraModel model_;
};

}  // namespace camera_self_calibration
