#include "camera_self_calibration/fleet/state_solution.h"

#include <algorithm>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/map/rolling_shutter.h"
#include "camera_self_calibration/queue/cross_validation.h"

namespace camera_self_calibration {
namespace {

Options shutterOptions(const LearntState& state) {
  Options options;
  options.estimate_readout = state.line_delay_sigma_s > 0.0;
  options.readout_s = state.line_delay_s * rowSteps(state.camera.height());
  return options;
}

}  // namespace

StateSolution solveState(const LearntState& state, int threads) {
  const Options options = shutterOptions(state);
  const int capacity = std::max(1, static_cast<int>(state.segments.size()));
  StateSolution solution{SegmentQueue(QueuePolicy(capacity, options.alpha), threads)};
  SegmentQueue& queue = solution.queue;
  Shutter shutter(options, state.camera.height());
  shutter.restore(state);
  shutter.solve(state.segments, state.camera, &queue);
  solution.line_delay_s = shutter.lineDelay().inUse();
  const LineDelayEstimate& line_delay = shutter.lineDelay().estimate();
  if (line_delay.usable) solution.line_delay_sigma_s = line_delay.sigma_s;
  return solution;
}

std::shared_ptr<const LearntState> withModel(const LearntState& state, const Camera& lens) {
  auto result = std::make_shared<LearntState>(state);
  result->segments.clear();
  for (const Candidate& candidate : state.segments) {
    Candidate anew = evaluateCandidate(CandidateOptions(), candidate.segment, lens);
    if (anew.well_posed) result->segments.push_back(std::move(anew));
  }
  result->camera = lens;
  if (result->segments.empty()) return nullptr;
  const StateSolution solution = solveState(*result);
  if (!solution.queue.solution().usable) return nullptr;
  result->camera = solution.queue.solution().camera;
  return result;
}

std::optional<BagRecord> recordOf(const LearntState& state) {
  const StateSolution solved = solveState(state);
  const QueueSolution& solution = solved.queue.solution();
  if (!solution.usable) return std::nullopt;
  BagRecord record;
  record.version = programVersion();
  record.state = state.state;
  record.lens = solution.camera;
  record.covariance = solution.covariance;
  record.scatter = solution.scatter;
  record.uncertainty_px = pixelUncertainty(solution.camera, solution.covariance).rms *
                          crossValidate(solution, {}).inflation();
  record.line_delay_s = solved.line_delay_s;
  record.line_delay_sigma_s = solved.line_delay_sigma_s;
  record.begin_ns = state.segments.front().segment.beginNs();
  record.end_ns = record.begin_ns;
  for (const Candidate& candidate : state.segments) {
    const Segment& segment = candidate.segment;
    record.segments.push_back({segment.beginNs(), segment.endNs(), candidate.entropy});
    record.begin_ns = std::min(record.begin_ns, segment.beginNs());
    record.end_ns = std::max(record.end_ns, segment.endNs());
  }
  return record;
}

std::string programVersion() { return SELFCAL_VERSION; }

}  // namespace camera_self_calibration
