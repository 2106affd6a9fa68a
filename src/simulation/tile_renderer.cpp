#include "camera_self_calibration/simulation/tile_renderer.h"

#include <algorithm>

namespace camera_self_calibration {
namespace {

constexpr int kNothing = -1;
constexpr int kSamples = 16;  // per pixel on an edge

// Offsets from the pixel's centre [px]: a Hammersley set, whose 16 samples have 16 different
// columns and rows, so that an edge moves in steps of 1/16 px.
constexpr std::array<float, kSamples> kAcross = [] {
  std::array<float, kSamples> offsets{};
  for (int i = 0; i < kSamples; ++i) {
    offsets[static_cast<std::size_t>(i)] = (static_cast<float>(i) + 0.5f) / kSamples - 0.5f;
  }
  return offsets;
}();
constexpr std::array<float, kSamples> kDown = [] {
  std::array<float, kSamples> offsets{};
  for (int i = 0; i < kSamples; ++i) {
    const int reversed = (i & 1) << 3 | (i & 2) << 1 | (i & 4) >> 1 | (i & 8) >> 3;
    offsets[static_cast<std::size_t>(i)] = (static_cast<float>(reversed) + 0.5f) / kSamples - 0.5f;
  }
  return offsets;
}();

int nearest(const std::vector<SurfaceView>& views, const std::vector<int>& candidates,
            const Eigen::Vector3f& ray) {
  int best = kNothing;
  float best_inverse_distance = 0.0f;
  for (const int candidate : candidates) {
    const SurfaceView& view = views[static_cast<std::size_t>(candidate)];
    const float inverse_distance = view.inverse_distance.dot(ray);
    if (inverse_distance <= best_inverse_distance || !view.meets(ray)) continue;
    best = candidate;
    best_inverse_distance = inverse_distance;
  }
  return best;
}

// The change of the texture position over one pixel follows from the quotient rule:
// d(x/q) = (dx - (x/q) dq) / q, with x, y, q linear in the ray.
struct Footprint {
  Eigen::Vector3f column;  // change of (x, y, q) per column
  Eigen::Vector3f row;     // change of (x, y, q) per row

  Footprint(const RayTile& tile, const SurfaceView& view)
      : column(along(view, tile.d_column)), row(along(view, tile.d_row)) {}

  static Eigen::Vector3f along(const SurfaceView& view, const Eigen::Vector3f& d) {
    return {view.x.dot(d), view.y.dot(d), view.inverse_distance.dot(d)};
  }

  float shade(const SurfaceView& view, const Eigen::Vector3f& ray) const {
    const float distance = 1.0f / view.inverse_distance.dot(ray);
    const float x = view.x.dot(ray) * distance;
    const float y = view.y.dot(ray) * distance;
    return view.texture->sampleFootprint(
        x, y, (column.x() - x * column.z()) * distance, (column.y() - y * column.z()) * distance,
        (row.x() - x * row.z()) * distance, (row.y() - y * row.z()) * distance);
  }
};

}  // namespace

void TileRenderer::findCandidates(const std::vector<SurfaceView>& views, const RayCone& cone,
                                  const std::vector<int>* inside, std::vector<int>* candidates) {
  candidates->clear();
  float nearest_cover = 0.0f;  // everything inside the cone is at least this near (1 / distance)
  const auto consider = [&](int i) {
    const SurfaceView& view = views[static_cast<std::size_t>(i)];
    const SurfaceView::Cover cover = view.cover(cone);
    if (cover == SurfaceView::Cover::kNone) return;
    candidates->push_back(i);
    if (cover == SurfaceView::Cover::kPart) return;
    const float spread = view.inverse_distance.norm() * cone.chord;
    nearest_cover = std::max(nearest_cover, view.inverse_distance.dot(cone.axis) - spread);
  };
  if (inside != nullptr) {
    for (const int i : *inside) consider(i);
  } else {
    for (int i = 0; i < static_cast<int>(views.size()); ++i) consider(i);
  }
  const auto hidden = [&](int i) {
    const Eigen::Vector3f& q = views[static_cast<std::size_t>(i)].inverse_distance;
    return q.dot(cone.axis) + q.norm() * cone.chord < nearest_cover;
  };
  candidates->erase(std::remove_if(candidates->begin(), candidates->end(), hidden),
                    candidates->end());
}

void TileRenderer::render(const RayTile& tile, const RowViews& views,
                          const std::vector<int>& candidates, float* gray) {
  const std::vector<SurfaceView>& middle = *views[kTileSize / 2];
  findCandidates(middle, tile.cone, &candidates, &narrowed_);
  const bool one =
      narrowed_.size() == 1 && tile.all && views.front() == views.back() &&
      middle[static_cast<std::size_t>(narrowed_[0])].cover(tile.cone) == SurfaceView::Cover::kAll;
  if (one) {
    fill(tile, views, narrowed_[0], gray);
  } else {
    fillMixed(tile, views, views.front() == views.back() ? narrowed_ : candidates, gray);
  }
}

void TileRenderer::fill(const RayTile& tile, const RowViews& views, int surface,
                        float* gray) const {
  const SurfaceView& view = (*views[0])[static_cast<std::size_t>(surface)];
  const Footprint footprint(tile, view);
  for (std::size_t i = 0; i < tile.rays.size(); ++i) gray[i] = footprint.shade(view, tile.rays[i]);
}

void TileRenderer::fillMixed(const RayTile& tile, const RowViews& views,
                             const std::vector<int>& candidates, float* gray) {
  const Eigen::Vector3f half = 0.5f * (tile.d_column + tile.d_row);
  const Eigen::Vector3f cross = 0.5f * (tile.d_column - tile.d_row);
  for (std::size_t i = 0; i < tile.rays.size(); ++i) {
    gray[i] = 0.0f;
    if (!tile.valid[i]) continue;
    const std::vector<SurfaceView>& row = *views[i / kTileSize];
    const Eigen::Vector3f& ray = tile.rays[i];
    const int surface = nearest(row, candidates, ray);
    const bool uniform = nearest(row, candidates, ray + half) == surface &&
                         nearest(row, candidates, ray - half) == surface &&
                         nearest(row, candidates, ray + cross) == surface &&
                         nearest(row, candidates, ray - cross) == surface;
    if (!uniform) {
      gray[i] = supersample(tile, row, candidates, ray);
    } else if (surface != kNothing) {
      const SurfaceView& view = row[static_cast<std::size_t>(surface)];
      gray[i] = Footprint(tile, view).shade(view, ray);
    }
  }
}

// Each surface is shaded once, at the middle of the samples that meet it, and weighted by their
// number.
float TileRenderer::supersample(const RayTile& tile, const std::vector<SurfaceView>& views,
                                const std::vector<int>& candidates, const Eigen::Vector3f& ray) {
  std::array<int, kSamples> surface;
  for (std::size_t k = 0; k < kSamples; ++k) {
    surface[k] =
        nearest(views, candidates, ray + kAcross[k] * tile.d_column + kDown[k] * tile.d_row);
  }
  float sum = 0.0f;
  for (std::size_t k = 0; k < kSamples; ++k) {
    const int id = surface[k];
    if (id == kNothing) continue;
    float across = 0.0f;
    float down = 0.0f;
    float count = 0.0f;
    for (std::size_t other = k; other < kSamples; ++other) {
      if (surface[other] != id) continue;
      surface[other] = kNothing;
      across += kAcross[other];
      down += kDown[other];
      count += 1.0f;
    }
    const Eigen::Vector3f middle = ray + across / count * tile.d_column + down / count * tile.d_row;
    const SurfaceView& view = views[static_cast<std::size_t>(id)];
    sum += count / kSamples * Footprint(tile, view).shade(view, middle);
  }
  return sum;
}

}  // namespace camera_self_calibration
