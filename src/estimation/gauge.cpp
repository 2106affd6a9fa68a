#include "camera_self_calibration/estimation/gauge.h"

#include <algorithm>
#include <vector>

#include "camera_self_calibration/estimation/observation_model.h"
#include "camera_self_calibration/estimation/transfer.h"

namespace camera_self_calibration {
namespace {

// rho^2 H_rhorho of the `wanted` landmarks: (rho / conditional sigma of rho)^2.
std::vector<double> inverseDepthInformation(const Segment& segment, const Camera& camera,
                                            const std::vector<char>& wanted) {
  std::vector<double> information(segment.landmarks.size(), 0.0);
  Transfers transfers(segment);
  for (const Observation& observation : segment.observations) {
    if (wanted[observation.landmark] == 0) continue;
    const Landmark& landmark = segment.landmarks[observation.landmark];
    const Transfer& transfer = transfers.between(landmark.reference, observation.keyframe);
    Eigen::Vector3d ray;
    Eigen::Vector2d pixel;
    Matrix23d d_point;
    if (!landmarkRay(segment.cameraOf(landmark.reference, camera), landmark, &ray, nullptr) ||
        !segment.cameraOf(observation.keyframe, camera)
             .project(transfer(ray, landmark.inverse_depth), &pixel, &d_point)) {
      continue;
    }
    const Eigen::Vector2d d_depth = d_point * transfer.translation;
    information[observation.landmark] +=
        (landmark.inverse_depth * d_depth / observation.sigma).squaredNorm();
  }
  return information;
}

}  // namespace

SegmentBlock freeBlock(Segment* segment, const Camera& camera) {
  SegmentBlock block;
  block.segment = segment;
  std::vector<int> counts(segment->landmarks.size(), 0);
  for (const Observation& observation : segment->observations) ++counts[observation.landmark];
  int most = 1;
  for (const int count : counts) most = std::max(most, count);
  std::vector<char> seen_most(counts.size());
  for (std::size_t l = 0; l < counts.size(); ++l) {
    // An inherited landmark has one observation more for the same number of views.
    const int views = counts[l] - (segment->landmarks[l].anchored ? 0 : 1);
    seen_most[l] = views + 1 >= most;
  }
  const std::vector<double> information = inverseDepthInformation(*segment, camera, seen_most);
  double best = -1.0;
  for (std::size_t l = 0; l < counts.size(); ++l) {
    if (seen_most[l] == 0 || information[l] <= best) continue;
    best = information[l];
    block.fixed_landmark = static_cast<int>(l);
  }
  return block;
}

}  // namespace camera_self_calibration
