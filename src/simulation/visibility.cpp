#include "visibility.h"

#include <algorithm>

namespace camera_self_calibration {

int nearestSurface(const std::vector<SurfaceView>& views, const std::vector<int>& candidates,
                   const Eigen::Vector3f& ray) {
  int best = kNoSurface;
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

void findCandidates(const std::vector<SurfaceView>& views, const RayCone& cone,
                    const std::vector<int>* inside, std::vector<int>* candidates) {
  candidates->clear();
  float nearest_cover = 0.0f;  // everything seen in the cone is at least this near (1 / distance)
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

}  // namespace camera_self_calibration
