#include "camera_self_calibration/model_choice/held_out.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "camera_self_calibration/base/parallel.h"
#include "camera_self_calibration/estimation/gate.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/linear_segment.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/estimation/pseudo_inverse.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/map/inverse_depth.h"

namespace camera_self_calibration {
namespace {

// Directions that the other segments do not observe are left where they are.
constexpr double kRankTolerance = 1e-10;

Problem problemOf(std::vector<Segment>* segments, Camera* camera) {
  Problem problem;
  problem.camera = camera;
  for (Segment& segment : *segments) problem.blocks.push_back(freeBlock(&segment, *camera));
  return problem;
}

SolverOptions solverOptions(int iterations, int threads) {
  SolverOptions options;
  options.max_iterations = iterations;
  options.step_tolerance = 1e-2;
  options.cost_tolerance = 1e-6;
  options.threads = threads;
  return options;
}

std::map<std::int64_t, const Landmark*> landmarksById(const Segment& segment) {
  std::map<std::int64_t, const Landmark*> known;
  for (const Landmark& landmark : segment.landmarks) known[landmark.track_id] = &landmark;
  return known;
}

// The compared tracks of a segment, at a fit's poses and, where it has them, depths.
Segment comparedSegment(const Segment& observed, const ComparedTracks& tracks,
                        const Segment& fitted) {
  const double typical = medianInverseDepth(fitted, 1.0);
  Segment segment = observed;
  segment.keyframes = fitted.keyframes;
  for (Observation& observation : segment.observations) {
    observation.sigma = std::hypot(observation.sigma, tracks.unexplained_sigma);
  }
  const auto known = landmarksById(fitted);
  std::vector<int> others;
  for (std::size_t l = 0; l < segment.landmarks.size(); ++l) {
    Landmark& landmark = segment.landmarks[l];
    const auto found = known.find(landmark.track_id);
    if (found != known.end()) {
      landmark = *found->second;
    } else {
      landmark.inverse_depth = typical;
    }
    if (tracks.ids.count(landmark.track_id) == 0) others.push_back(static_cast<int>(l));
  }
  removeLandmarks(others, &segment);
  return segment;
}

double costWithoutOwn(const LinearSegment& own, const IntrinsicsMatrix& all_h,
                      const Intrinsics& all_b) {
  const IntrinsicsMatrix& h = own.reducedHessian();
  const Intrinsics& b = own.reducedGradient();
  PseudoInverse others;
  others.compute(Eigen::MatrixXd(all_h - h), kRankTolerance);
  const Eigen::VectorXd d = others.solve(all_b - b);
  return own.cost() - b.dot(d) + 0.5 * d.dot(h * d);
}

}  // namespace

int JointFit::trackCount() const {
  int count = 0;
  for (const ComparedTracks& own : tracks) count += static_cast<int>(own.ids.size());
  return count;
}

double HeldOut::total() const { return std::accumulate(cost.begin(), cost.end(), 0.0); }

JointFit fitJointly(const std::vector<Segment>& segments, const Camera& start, int threads) {
  JointFit fit;
  fit.camera = start;
  fit.segments = segments;
  fit.tracks.resize(segments.size());
  Problem problem = problemOf(&fit.segments, &fit.camera);
  // Under a model that does not fit all residuals are large: the sigma follows them, so that the
  // robust weight still tells outliers from the rest.
  for (SegmentBlock& block : problem.blocks) {
    block.sigma_scale = std::max(1.0, medianResidualScale(block, fit.camera));
  }
  if (!solve(problem, solverOptions(20, threads)).usable || !fit.camera.valid()) return fit;
  for (SegmentBlock& block : problem.blocks) block.sigma_scale = 1.0;
  if (!solve(problem, solverOptions(20, threads)).usable || !fit.camera.valid()) return fit;
  for (std::size_t i = 0; i < fit.segments.size(); ++i) {
    fit.tracks[i].unexplained_sigma = gateSegment(problem.blocks[i], fit.camera).unexplained_sigma;
  }
  problem = problemOf(&fit.segments, &fit.camera);
  if (!solve(problem, solverOptions(20, threads)).usable || !fit.camera.valid()) return fit;
  for (std::size_t i = 0; i < fit.segments.size(); ++i) {
    for (const Landmark& landmark : fit.segments[i].landmarks) {
      fit.tracks[i].ids.insert(landmark.track_id);
    }
  }
  fit.usable = true;
  return fit;
}

HeldOut leaveOneOut(const std::vector<Segment>& observed, const std::vector<ComparedTracks>& tracks,
                    const JointFit& fit, int threads) {
  HeldOut result;
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    segments.push_back(comparedSegment(observed[i], tracks[i], fit.segments[i]));
  }
  Camera camera = fit.camera;
  Problem problem = problemOf(&segments, &camera);
  const SolverOptions options = solverOptions(20, threads);
  if (!solve(problem, options).usable || !camera.valid()) return result;
  const int count = problem.intrinsicsCount();
  std::vector<LinearSegment> linear(segments.size());
  parallelFor(threads, static_cast<int>(segments.size()), [&](int i) {
    linear[i].linearize(problem.blocks[i], camera, count, options.huber);
    linear[i].eliminate(0.0);
  });
  IntrinsicsMatrix h = IntrinsicsMatrix::Zero(count, count);
  Intrinsics b = Intrinsics::Zero(count);
  for (const LinearSegment& own : linear) {
    h += own.reducedHessian();
    b += own.reducedGradient();
  }
  for (const LinearSegment& own : linear) result.cost.push_back(costWithoutOwn(own, h, b));
  result.design_effect = marginalize(problem, options.huber, threads).designEffect();
  result.usable = std::isfinite(result.total());
  return result;
}

}  // namespace camera_self_calibration
