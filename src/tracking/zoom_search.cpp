#include "camera_self_calibration/tracking/zoom_search.h"

#include <algorithm>
#include <utility>

namespace camera_self_calibration {
namespace {

constexpr std::size_t kMinPoints = 16;
constexpr double kEnough = 0.5;     // of the points, to be content with
constexpr double kClearGain = 1.3;  // in points found, for a zoom to be believed
constexpr float kScales[] = {1.1F, 0.91F, 1.25F, 0.8F, 1.45F, 0.69F};

std::size_t countFound(const FlowPrediction& flow, std::size_t points) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < points; ++i) found += flow.found(i);
  return found;
}

}  // namespace

void ZoomSearch::run(const ImagePyramid& from, const ImagePyramid& to,
                     const std::vector<cv::Point2f>& points, FlowPrediction* flow,
                     std::vector<cv::Point2f>* predicted) {
  const std::size_t enough = static_cast<std::size_t>(kEnough * static_cast<double>(points.size()));
  const std::size_t found = countFound(*flow, points.size());
  if (points.size() < kMinPoints || found >= enough) return;
  const cv::Point2f centre(0.5F * static_cast<float>(to.size().width),
                           0.5F * static_cast<float>(to.size().height));
  best_ = *predicted;
  FlowPrediction best_flow = *flow;
  auto most = static_cast<std::size_t>(kClearGain * static_cast<double>(found));
  for (const float scale : kScales) {
    trial_.clear();
    for (const cv::Point2f& point : points) trial_.push_back(centre + scale * (point - centre));
    flow->run(from, to, points, &trial_);
    const std::size_t count = countFound(*flow, points.size());
    if (count <= most) continue;
    most = count;
    std::swap(best_, trial_);
    std::swap(best_flow, *flow);
  }
  *predicted = best_;
  std::swap(*flow, best_flow);
}

}  // namespace camera_self_calibration
