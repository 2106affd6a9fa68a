#include "camera_self_calibration/lens_change/lens_change.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "camera_self_calibration/estimation/gate.h"
#include "camera_self_calibration/estimation/gauge.h"
#include "camera_self_calibration/estimation/robust_cost.h"
#include "camera_self_calibration/estimation/solver.h"
#include "camera_self_calibration/map/inverse_depth.h"
#include "camera_self_calibration/map/segment_edit.h"
#include "camera_self_calibration/queue/segment_fit.h"

namespace camera_self_calibration {
namespace {

constexpr int kMinLandmarks = 20;
// p-value below which a change has to show in the tracks that fit one lens best, too.
constexpr double kToBeVerified = 1e-2;
// Of the tracks, left out then: it is assumed that things that move hold no more.
constexpr double kTrimmedShare = 0.15;

Segment withoutDepths(const Segment& segment) {
  return asIfTurning(segment, 1, typicalInverseDepth(inverseDepths(segment)));
}

// The robust cost of one lens throughout.
double costOfOneLens(Segment segment, const Camera& lens, double sigma_scale) {
  setOneLens(&segment);
  Camera held = lens;
  Problem problem{&held, false, {freeBlock(&segment, lens)}};
  problem.blocks[0].sigma_scale = sigma_scale;
  SolverOptions options;
  options.precision = kComparisonPrecision;
  const SolveSummary summary = solve(problem, options);
  return summary.usable ? summary.final_cost : std::numeric_limits<double>::infinity();
}

// The segment with a change after so many keyframes.
struct Changed {
  Segment segment;
  Camera camera;                                          // since then
  double cost = std::numeric_limits<double>::infinity();  // robust
};

// From the state of `start`.
Changed solveWithChange(const Changed& start, int earlier_keyframes, const Camera& reference) {
  Changed changed = start;
  if (earlier_keyframes > 0) setEarlierLens(reference, earlier_keyframes, &changed.segment);
  const Problem problem{&changed.camera, true, {freeBlock(&changed.segment, changed.camera)}};
  SolverOptions options;
  options.precision = kEstimatePrecision;
  const SolveSummary summary = solve(problem, options);
  changed.cost = summary.usable ? summary.final_cost : std::numeric_limits<double>::infinity();
  return changed;
}

// Solves the segment with one lens throughout. Returns the robust cost.
double fitOneLens(Segment* segment, Camera* lens) {
  SegmentFitOptions options;
  options.estimate_intrinsics = false;
  options.gating_rounds = 0;
  if (!fitSegment(options, segment, lens).usable) return std::numeric_limits<double>::infinity();
  return robustCost(freeBlock(segment, *lens), *lens, options.huber);
}

// The two hypotheses compared on the tracks that fit under a change.
LensChange compare(const Segment& segment, int earlier_keyframes, const Reference& reference) {
  LensChange change;
  change.segment = segment;
  change.camera = reference.camera;
  if (earlier_keyframes > 0) setEarlierLens(reference.camera, earlier_keyframes, &change.segment);
  const SegmentFit fit = fitSegment(SegmentFitOptions(), &change.segment, &change.camera);
  if (!fit.usable || !change.camera.valid() ||
      static_cast<int>(change.segment.landmarks.size()) < kMinLandmarks) {
    return change;
  }
  change.residual_scale = fit.residual_scale;
  const double birge_ratio = reference.scatter.birgeRatio();
  const double sigma_scale = fit.marginal.sigmaScale() * birge_ratio;
  change.information = fit.marginal.information / (sigma_scale * sigma_scale);
  const int count = change.camera.estimatedCount();
  QuadraticLikelihood likelihood;
  likelihood.point = change.camera.parameters().head(count);
  likelihood.gradient = Intrinsics::Zero(count);
  likelihood.information = change.information * (birge_ratio * birge_ratio);
  const double quadratic = agreement({likelihood}, reference).statistic;
  const Intrinsics between = compromise({likelihood}, reference);
  const Camera lens = withEstimated(reference.camera, between);
  if (!lens.valid()) return change;
  SegmentBlock block = freeBlock(&change.segment, change.camera);
  block.sigma_scale = sigma_scale;
  const double free_cost = robustCost(block, change.camera, SolverOptions().huber);
  // From several states: a wrong minimum would feign a change.
  const Segment before = restarted(change.segment, segment);
  const double held_cost = std::min({costOfOneLens(before, lens, sigma_scale),
                                     costOfOneLens(withoutDepths(before), lens, sigma_scale),
                                     costOfOneLens(change.segment, lens, sigma_scale)});
  const Intrinsics off = between - reference.camera.parameters().head(count);
  const double exact = 2.0 * (held_cost - free_cost) + off.dot(reference.information * off);
  change.statistic = std::max(0.0, std::min(quadratic, exact));
  change.p_value = pValue(change.statistic, reference);
  change.usable = true;
  return change;
}

}  // namespace

Segment fittingOneLens(const Segment& segment, const Camera& camera) {
  Camera lens = camera;
  Segment result = segment;
  setOneLens(&result);
  Segment other = withoutDepths(result);
  if (fitOneLens(&other, &lens) < fitOneLens(&result, &lens)) result = std::move(other);
  const int count = static_cast<int>(kTrimmedShare * static_cast<double>(result.landmarks.size()));
  removeLandmarks(worstTracks(freeBlock(&result, lens), lens, count), &result);
  const int earlier = earlierKeyframes(segment);
  if (earlier > 0) setEarlierLens(segment.held_lenses.front(), earlier, &result);
  return result;
}

// Each date is tried from the solution of the best so far, which is near its own.
int dateLensChange(const Segment& segment, const Reference& reference, int first, int last) {
  const int newest = static_cast<int>(segment.keyframes.size()) - 1;
  int best_date = std::clamp(first, 0, std::max(0, newest));
  Changed best{segment, reference.camera};
  for (int k = best_date; k <= std::min(last, newest); ++k) {
    Changed changed = solveWithChange(best, k, reference.camera);
    if (!(changed.cost < best.cost)) continue;
    best = std::move(changed);
    best_date = k;
  }
  return best_date;
}

LensChange testLensChange(const Segment& segment, int earlier_keyframes,
                          const Reference& reference) {
  LensChange change = compare(segment, earlier_keyframes, reference);
  if (!change.usable || change.p_value > kToBeVerified) return change;
  const Segment fitting = fittingOneLens(segment, reference.camera);
  const LensChange verified = compare(fitting, earlier_keyframes, reference);
  if (verified.usable && verified.statistic < change.statistic) {
    change.statistic = verified.statistic;
    change.p_value = verified.p_value;
  }
  return change;
}

}  // namespace camera_self_calibration
