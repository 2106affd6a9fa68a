#include "camera_self_calibration/simulation/renderer.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <thread>

#include "tile_renderer.h"
#include "visibility.h"

namespace camera_self_calibration {
namespace {

constexpr int kBlock = 8;  // tiles in a row that share a list of candidates

// With a rolling shutter the rows of a tile differ in pose: this much wider is the search [rad].
constexpr float kRollingMargin = 0.02f;

Camera checked(const PaintedWorld* world, const Camera& camera, const RendererOptions& options) {
  std::string message;
  if (world == nullptr) message += "a world is needed; ";
  for (const std::string& problem : options.problems()) message += problem + "; ";
  if (!camera.valid() || camera.width() < 1 || camera.height() < 1) {
    message += "the simulated camera's parameters or size are not valid; ";
  }
  if (!message.empty()) throw std::invalid_argument("renderer: " + message);
  return camera;
}

std::vector<RayCone> blocksOf(const RayTiles& rays, float margin) {
  std::vector<RayCone> cones;
  for (int row = 0; row < rays.rows; ++row) {
    for (int column = 0; column < rays.columns; column += kBlock) {
      const int count = std::min(kBlock, rays.columns - column);
      const RayTile* first = &rays.tiles[static_cast<std::size_t>(row * rays.columns + column)];
      float widest_step = 0.0f;
      for (int i = 0; i < count; ++i) {
        widest_step = std::max(widest_step, first[i].d_column.norm() + first[i].d_row.norm());
      }
      cones.push_back(enclosingCone(first, count, widest_step + margin));
    }
  }
  return cones;
}

void addTile(const RayTile& tile, const float* gray, float weight, cv::Mat* light) {
  const int columns = std::min(kTileSize, light->cols - tile.x);
  const int rows = std::min(kTileSize, light->rows - tile.y);
  for (int y = 0; y < rows; ++y) {
    float* to = light->ptr<float>(tile.y + y) + tile.x;
    for (int x = 0; x < columns; ++x) to[x] += weight * gray[y * kTileSize + x];
  }
}

}  // namespace

std::vector<std::string> RendererOptions::problems() const {
  std::vector<std::string> found = sensor.problems();
  if (!(exposure_s >= 0.0 && exposure_s <= 1.0)) found.push_back("exposure_s must be in [0, 1]");
  if (blur_images < 1 || blur_images > 100) found.push_back("blur_images must be in [1, 100]");
  if (!(line_delay_s >= 0.0 && line_delay_s <= 1e-3))
    found.push_back("line_delay_s must be in [0, 1e-3]");
  if (threads < 1 || threads > 64) found.push_back("threads must be in [1, 64]");
  return found;
}

Renderer::Renderer(std::shared_ptr<const PaintedWorld> world, const Camera& camera,
                   const RendererOptions& options)
    : world_(std::move(world)),
      camera_(checked(world_.get(), camera, options)),
      options_(options),
      rays_(camera),
      blocks_(blocksOf(rays_, options.line_delay_s > 0.0 ? kRollingMargin : 0.0f)),
      sensor_(options.sensor, camera) {}

std::vector<Renderer::Views> Renderer::viewsAt(const Trajectory& trajectory, double time_s) const {
  const int rows = options_.line_delay_s > 0.0 ? camera_.height() : 1;
  std::vector<Views> views;
  if (rows == 1) {
    views.push_back(viewsFrom(*world_, trajectory.worldFromCamera(time_s), time_s));
    return views;
  }
  for (int row = 0; row < rows; ++row) {
    const double row_s = time_s + row * options_.line_delay_s;
    views.push_back(viewsFrom(*world_, trajectory.worldFromCamera(row_s), row_s));
  }
  return views;
}

cv::Mat Renderer::render(const Trajectory& trajectory, double time_s, std::uint64_t noise_seed,
                         double gain) const {
  cv::Mat sum(camera_.height(), camera_.width(), CV_32FC1, cv::Scalar(0.0));
  const int images = options_.exposure_s > 0.0 ? options_.blur_images : 1;
  for (int i = 0; i < images; ++i) {
    const double offset = options_.exposure_s * ((i + 0.5) / images - 0.5);
    add(viewsAt(trajectory, time_s + offset), 1.0f / static_cast<float>(images), &sum);
  }
  return sensor_.expose(sum, noise_seed, gain);
}

cv::Mat Renderer::render(const Rigid3& world_from_camera, std::uint64_t noise_seed) const {
  return sensor_.expose(light(world_from_camera), noise_seed);
}

cv::Mat Renderer::light(const Rigid3& world_from_camera) const {
  cv::Mat sum(camera_.height(), camera_.width(), CV_32FC1, cv::Scalar(0.0));
  add({viewsFrom(*world_, world_from_camera, 0.0)}, 1.0f, &sum);
  return sum;
}

void Renderer::add(const std::vector<Views>& row_views, float weight, cv::Mat* light) const {
  const auto work = [&](int first) {
    for (int row = first; row < rays_.rows; row += options_.threads) {
      addTileRow(row, row_views, weight, light);
    }
  };
  std::vector<std::thread> helpers;
  for (int i = 1; i < options_.threads; ++i) helpers.emplace_back(work, i);
  work(0);
  for (std::thread& helper : helpers) helper.join();
}

void Renderer::addTileRow(int tile_row, const std::vector<Views>& row_views, float weight,
                          cv::Mat* light) const {
  RowViews views;
  for (std::size_t i = 0; i < kTileSize; ++i) {
    const std::size_t row = static_cast<std::size_t>(tile_row) * kTileSize + i;
    views[i] = &row_views[std::min(row, row_views.size() - 1)];
  }
  const int blocks = (rays_.columns + kBlock - 1) / kBlock;
  TileRenderer renderer;
  std::vector<int> candidates;
  std::array<float, kTileSize * kTileSize> gray;
  for (int column = 0; column < rays_.columns; ++column) {
    if (column % kBlock == 0) {
      const auto block = static_cast<std::size_t>(tile_row * blocks + column / kBlock);
      findCandidates(*views[kTileSize / 2], blocks_[block], nullptr, &candidates);
    }
    const RayTile& tile = rays_.tiles[static_cast<std::size_t>(tile_row * rays_.columns + column)];
    if (!tile.any) continue;
    renderer.render(tile, views, candidates, gray.data());
    addTile(tile, gray.data(), weight, light);
  }
}

}  // namespace camera_self_calibration
