// Rendered structures lie where the camera model projects them, to small fractions of a pixel.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/core.hpp>

#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/renderer.h"
#include "test_cameras.h"

namespace camera_self_calibration {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kGround = 40.0;
constexpr double kTexelsPerMetre = 512.0;

RendererOptions noiseless() {
  RendererOptions options;
  options.sensor.noise_sigma = 0.0;
  return options;
}

Surface wallAhead(double distance, double width, double height, const cv::Mat& image) {
  TextureRecipe recipe;
  recipe.kind = TextureKind::kImage;
  recipe.image = image;
  return Surface::facing({distance, 0.0, 0.0}, -Vector3d::UnitX(), Vector3d::UnitZ(), width, height,
                         recipe);
}

// Near the origin, looking about along x, turned by up to 0.4 rad.
Rigid3 randomPose(Random* random) {
  Eigen::Matrix3d world_from_level;
  world_from_level << 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, -1.0, 0.0;
  Vector3d turn = 0.2 * random->normal3();
  turn.z() += random->uniform(-1.0, 1.0);  // roll
  const Vector3d place(random->uniform(-1.0, 0.8), random->uniform(-0.5, 0.5),
                       random->uniform(-0.5, 0.5));
  return {(Eigen::Quaterniond(world_from_level) * expSo3(turn)).normalized(), place};
}

// Gaussian blobs at known places of a wall.
struct Blobs {
  double sigma_m = 0.012;
  Surface wall;
  std::vector<Vector3d> centres;

  Blobs() {
    const cv::Size size(4096, 3072);
    cv::Mat image(size, CV_8UC1, cv::Scalar(kGround));
    wall = wallAhead(2.5, size.width / kTexelsPerMetre, size.height / kTexelsPerMetre, image);
    Random random(11);
    for (int row = 1; row < 15; ++row) {
      for (int column = 1; column < 20; ++column) {
        const Vector2d centre(200.0 * column + random.uniform(-30.0, 30.0),
                              200.0 * row + random.uniform(-30.0, 30.0));
        draw(centre, &image);
        centres.push_back(wall.at(centre.x() / size.width, centre.y() / size.height));
      }
    }
  }

  // `centre` is continuous: the texel (i, j) has its centre at (i + 0.5, j + 0.5).
  void draw(const Vector2d& centre, cv::Mat* image) const {
    const double sigma = sigma_m * kTexelsPerMetre;
    const int reach = static_cast<int>(4.0 * sigma);
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        const int column = static_cast<int>(centre.x()) + x;
        const int row = static_cast<int>(centre.y()) + y;
        const double r2 = (Vector2d(column + 0.5, row + 0.5) - centre).squaredNorm();
        image->at<std::uint8_t>(row, column) = cv::saturate_cast<std::uint8_t>(
            kGround + 180.0 * std::exp(-0.5 * r2 / (sigma * sigma)));
      }
    }
  }

  double lightAt(const Vector3d& point, const Vector3d& centre) const {
    return 180.0 * std::exp(-0.5 * (point - centre).squaredNorm() / (sigma_m * sigma_m));
  }
};

// Smallest and largest extent (sigma) of a blob in the image [px].
std::pair<double, double> sizeInImage(const Camera& camera, const Rigid3& camera_from_world,
                                      const Vector3d& centre, const Surface& wall, double sigma_m) {
  Vector2d middle, beside;
  double smallest = 1e9;
  double largest = 0.0;
  for (const Vector3d& side : {wall.u, wall.v}) {
    if (!camera.project(camera_from_world * centre, &middle)) return {0.0, 1e9};
    if (!camera.project(camera_from_world * (centre + sigma_m * side.normalized()), &beside)) {
      return {0.0, 1e9};
    }
    smallest = std::min(smallest, (beside - middle).norm());
    largest = std::max(largest, (beside - middle).norm());
  }
  return {smallest, largest};
}

constexpr int kWindow = 9;

// Centroid of the light above the ground in a window about a pixel.
template <typename Light>
std::optional<Vector2d> centroid(const Vector2d& about, const Light& light_at) {
  Vector2d sum = Vector2d::Zero();
  double total = 0.0;
  const Eigen::Vector2i middle = about.array().round().cast<int>();
  for (int y = middle.y() - kWindow; y <= middle.y() + kWindow; ++y) {
    for (int x = middle.x() - kWindow; x <= middle.x() + kWindow; ++x) {
      const std::optional<double> light = light_at(x, y);
      if (!light) return std::nullopt;
      sum += *light * Vector2d(x, y);
      total += *light;
    }
  }
  if (total < 100.0) return std::nullopt;
  return Vector2d(sum / total);
}

struct Errors {
  double sum2 = 0.0;
  double largest = 0.0;
  Vector2d sum = Vector2d::Zero();
  int count = 0;

  void add(const Vector2d& error) {
    sum2 += error.squaredNorm();
    sum += error;
    largest = std::max(largest, error.norm());
    ++count;
  }
  double rms() const { return std::sqrt(sum2 / count); }
  double mean() const { return (sum / count).norm(); }
};

// The centroid that a perfect image of the blob has under this camera, without pixel area: the
// projection of a blob's centre is not the centroid of its image where the projection bends.
std::optional<Vector2d> trueCentroid(const Blobs& blobs, const Camera& camera, const Rigid3& pose,
                                     const Vector3d& centre, const Vector2d& about) {
  const Vector3d normal = blobs.wall.normal();
  return centroid(about, [&](int x, int y) -> std::optional<double> {
    const auto ray = camera.unproject(Vector2d(x, y));
    if (!ray) return std::nullopt;
    const Vector3d direction = pose.rotation * *ray;
    const double approach = normal.dot(direction);
    if (approach > -0.05) return std::nullopt;
    const double distance = normal.dot(blobs.wall.corner - pose.translation) / approach;
    return blobs.lightAt(pose.translation + distance * direction, centre);
  });
}

struct BlobErrors {
  Errors from_projection;  // of the blob's centre
  Errors from_truth;       // the ideal centroid
};

// Adds the errors of all blobs that one image shows whole and at a size that centroids suit.
void measureBlobs(const Blobs& blobs, const Renderer& renderer, const Rigid3& pose,
                  BlobErrors* errors) {
  const Camera& camera = renderer.camera();
  const cv::Mat light = renderer.light(pose);
  for (const Vector3d& centre : blobs.centres) {
    Vector2d projected;
    if (!camera.project(pose.inverse() * centre, &projected)) continue;
    const auto [smallest, largest] =
        sizeInImage(camera, pose.inverse(), centre, blobs.wall, blobs.sigma_m);
    if (!camera.inImage(projected, kWindow + 1) || smallest < 0.9 || largest > 2.2) continue;
    const auto truth = trueCentroid(blobs, camera, pose, centre, projected);
    const auto seen = centroid(projected, [&](int x, int y) -> std::optional<double> {
      if (light.at<float>(y, x) < kGround - 1.0) return std::nullopt;  // the wall ends
      return light.at<float>(y, x) - kGround;
    });
    if (!truth || !seen) continue;
    errors->from_projection.add(*seen - projected);
    errors->from_truth.add(*seen - *truth);
  }
}

TEST(RenderingAccuracy, BlobsLieWhereTheyProject) {
  const Blobs blobs;
  World world;
  world.surfaces.push_back(blobs.wall);
  const auto painted = std::make_shared<const PaintedWorld>(world);
  for (const Camera& camera : testCameras()) {
    const Renderer renderer(painted, camera, noiseless());
    Random random(12);
    BlobErrors errors;
    for (int i = 0; i < 12; ++i) measureBlobs(blobs, renderer, randomPose(&random), &errors);
    const Errors& projection = errors.from_projection;
    const Errors& truth = errors.from_truth;
    std::printf(
        "%-12s %4d blobs: to the projected centre rms %.4f max %.4f mean %.4f px, "
        "to the ideal centroid rms %.4f max %.4f mean %.4f px\n",
        toString(camera.model()).c_str(), projection.count, projection.rms(), projection.largest,
        projection.mean(), truth.rms(), truth.largest, truth.mean());
    EXPECT_GT(projection.count, 200);
    EXPECT_LT(projection.rms(), 0.02);
    EXPECT_LT(truth.rms(), 0.015);
    EXPECT_LT(truth.largest, 0.05);
    EXPECT_LT(truth.mean(), 0.002);
  }
}

// Column at which the edge from `upper` to `lower` crosses a row of the image.
std::optional<double> crossing(const Camera& camera, const Rigid3& camera_from_world,
                               const Vector3d& upper, const Vector3d& lower, double row) {
  double low = 0.0;
  double high = 1.0;
  Vector2d pixel;
  const auto below = [&](double s) {
    return camera.project(camera_from_world * (upper + s * (lower - upper)), &pixel) &&
           pixel.y() > row;
  };
  if (below(0.0) || !below(1.0)) return std::nullopt;
  for (int i = 0; i < 50; ++i) (below(0.5 * (low + high)) ? high : low) = 0.5 * (low + high);
  return pixel.x();
}

// A bright plate before a dark wall: the light in a row about its left edge tells where that is.
TEST(RenderingAccuracy, OutlinesLieWhereTheyProject) {
  World world;
  world.surfaces.push_back(wallAhead(3.0, 40.0, 40.0, cv::Mat(32, 32, CV_8UC1, cv::Scalar(50))));
  world.surfaces.push_back(wallAhead(2.0, 1.6, 1.2, cv::Mat(32, 32, CV_8UC1, cv::Scalar(200))));
  const Surface& plate = world.surfaces[1];
  const auto painted = std::make_shared<const PaintedWorld>(world);
  constexpr int kReach = 6;
  for (const Camera& camera : testCameras()) {
    const Renderer renderer(painted, camera, noiseless());
    Random random(13);
    Errors errors;
    for (int i = 0; i < 20; ++i) {
      const Rigid3 pose = randomPose(&random);
      const cv::Mat light = renderer.light(pose);
      for (int row = 10; row < 470; row += 7) {
        const auto truth =
            crossing(camera, pose.inverse(), plate.at(0.0, 0.05), plate.at(0.0, 0.95), row);
        const auto above =
            crossing(camera, pose.inverse(), plate.at(0.0, 0.0), plate.at(0.0, 1.0), row - 1.0);
        if (!truth || !above || std::abs(*truth - *above) > 0.7) continue;  // too slanted
        const int column = static_cast<int>(std::lround(*truth));
        if (column < 10 || column > 629) continue;
        double bright = 0.0;
        for (int x = column - kReach; x <= column + kReach; ++x) {
          bright += (light.at<float>(row, x) - 50.0) / 150.0;
        }
        // The plate fills the row from its edge to half a pixel beyond the last one.
        errors.add(Vector2d(column + kReach + 0.5 - bright - *truth, 0.0));
      }
    }
    std::printf("%-12s %4d rows of an outline: rms %.4f max %.4f mean %.4f px\n",
                toString(camera.model()).c_str(), errors.count, errors.rms(), errors.largest,
                errors.mean());
    EXPECT_GT(errors.count, 120);
    EXPECT_LT(errors.rms(), 0.025);
    EXPECT_LT(errors.largest, 0.08);
    EXPECT_LT(errors.mean(), 0.005);
  }
}

}  // namespace
}  // namespace camera_self_calibration
