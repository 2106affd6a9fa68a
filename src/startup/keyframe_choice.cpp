#include "camera_self_calibration/startup/keyframe_choice.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "camera_self_calibration/base/parallel.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/linear_segments.h"
#include "camera_self_calibration/estimation/robust.h"
#include "camera_self_calibration/map/segment_edit.h"

namespace camera_self_calibration {
namespace {

std::vector<int> commonToNeighbours(const Segment& segment) {
  const int count = static_cast<int>(segment.keyframes.size());
  std::vector<int> common(count, 0);
  std::vector<std::vector<char>> sees(segment.landmarks.size(), std::vector<char>(count, 0));
  for (const Observation& o : segment.observations) sees[o.landmark][o.keyframe] = 1;
  for (std::size_t l = 0; l < sees.size(); ++l) {
    if (segment.landmarks[l].anchored) sees[l][segment.landmarks[l].reference] = 1;
    for (int k = 1; k + 1 < count; ++k) common[k] += sees[l][k - 1] & sees[l][k + 1];
  }
  return common;
}

// Log determinant of what the other keyframes say of the intrinsics; -inf where it is no number.
double informationWithout(int k, const Segment& segment, const Camera& camera,
                          const IntrinsicsPrior& prior) {
  Segment rest = withoutKeyframe(segment, k);
  LinearSegments only(1);
  LinearSegment& linear = only[0];
  linear.linearize(freeBlock(&rest, camera), camera, camera.estimatedCount(), kHuberThreshold);
  linear.eliminate(0.0);
  IntrinsicsMatrix information = linear.reducedHessian();
  information += prior.information(camera.parameters(), camera.estimatedCount());
  const double determinant =
      Eigen::LDLT<Eigen::MatrixXd>(information).vectorD().array().max(1e-300).log().sum();
  return std::isnan(determinant) ? -std::numeric_limits<double>::infinity() : determinant;
}

}  // namespace

int leastInformative(const KeyframeChoiceOptions& options, const Segment& segment,
                     const Camera& camera, const IntrinsicsPrior& prior, int threads) {
  const std::vector<int> bridging = commonToNeighbours(segment);
  std::vector<std::pair<int, int>> order;
  const int end = static_cast<int>(segment.keyframes.size()) - options.keep_newest;
  for (int k = 1; k < end; ++k) {
    if (bridging[k] >= options.min_bridging_tracks) order.push_back({-bridging[k], k});
  }
  std::sort(order.begin(), order.end());
  order.insert(order.begin(), {0, 0});
  order.resize(std::min(order.size(), static_cast<std::size_t>(options.trials)));
  std::vector<double> left(order.size());
  parallelFor(threads, static_cast<int>(order.size()), [&](int i) {
    left[i] = informationWithout(order[i].second, segment, camera, prior);
  });
  return order[std::max_element(left.begin(), left.end()) - left.begin()].second;
}

}  // namespace camera_self_calibration
