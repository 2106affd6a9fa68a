#include "camera_self_calibration/fleet/epoch_solution.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/estimation/marginal.h"
#include "camera_self_calibration/fleet/state_solution.h"
#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/queue/cross_validation.h"

namespace camera_self_calibration {
namespace {

auto rank(const WantedSegment& segment) {
  return std::tie(segment.mark.entropy, segment.mark.begin_ns, segment.mark.end_ns);
}

bool shareMoment(const SegmentMark& a, const SegmentMark& b) {
  return a.begin_ns <= b.end_ns && b.begin_ns <= a.end_ns;
}

// Those of the epoch, the records of which the merged state keeps.
std::vector<BagRecord> recordsOf(const CameraHistory& history, int epoch) {
  std::vector<BagRecord> records;
  for (const HistoricBag& bag : history.bags) {
    // What belongs to no epoch goes along with the last.
    const bool apart = bag.epoch < 0 && epoch + 1 == history.epochs();
    if (bag.epoch == epoch || apart) records.push_back(bag.record);
  }
  return records;
}

// Of the sensor, whatever the lens: from the bags in which it was found to roll, or else all.
void poolLineDelay(const CameraHistory& history, LearntState* state) {
  double weighted[2] = {0.0, 0.0}, weights[2] = {0.0, 0.0};
  for (const HistoricBag& bag : history.bags) {
    const double sigma = bag.record.line_delay_sigma_s;
    if (!(sigma > 0.0)) continue;
    for (const bool rolling : {false, true}) {
      if (rolling && bag.record.line_delay_s == 0.0) continue;
      weighted[rolling] += bag.record.line_delay_s / (sigma * sigma);
      weights[rolling] += 1.0 / (sigma * sigma);
    }
  }
  const bool rolls = weights[true] > 0.0;
  if (!(weights[rolls] > 0.0)) return;
  state->line_delay_s = weighted[rolls] / weights[rolls];
  state->line_delay_sigma_s = 1.0 / std::sqrt(weights[rolls]);
}

// All of the camera's model, numbered anew.
std::vector<Candidate> comparable(std::vector<Candidate> candidates, const Camera& lens) {
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (candidates[i].camera.model() != lens.model() ||
        candidates[i].information.rows() != lens.estimatedCount()) {
      candidates[i] = evaluateCandidate(CandidateOptions(), candidates[i].segment, lens);
    }
    candidates[i].segment.sequence = static_cast<std::int64_t>(i) + 1;
  }
  return candidates;
}

LearntState unsolved(const CameraHistory& history, int epoch) {
  LearntState state;
  state.camera = history.lens;
  Intrinsics values = history.lens.parameters();
  values.head(history.lens.estimatedCount()) = sumOf(history, epoch).mean();
  state.camera.setParameters(values);
  poolLineDelay(history, &state);
  state.epoch = static_cast<std::uint64_t>(epoch);
  state.revision = 1;
  state.bags = recordsOf(history, epoch);
  for (const HistoricBag& bag : history.bags) {
    if (bag.epoch == epoch) state.stamp_ns = std::max(state.stamp_ns, bag.record.end_ns);
  }
  return state;
}

double misfitOf(const CameraHistory& history, int epoch) {
  std::vector<double> misfits;
  for (const HistoricBag& bag : history.bags) {
    if (bag.epoch == epoch) misfits.push_back(bag.used.misfit_px);
  }
  return median(std::move(misfits), 0.0);
}

std::vector<IntrinsicsMatrix> contributionsOf(const CameraHistory& history,
                                              const std::vector<WantedSegment>& wanted,
                                              const QueueSolution& solution) {
  std::vector<IntrinsicsMatrix> contributions(history.bags.size());
  for (std::size_t i = 0; i < solution.shares.size(); ++i) {
    IntrinsicsMatrix& bag = contributions[wanted[i].bag];
    const IntrinsicsMatrix& share = solution.shares[i].information;
    bag = bag.size() == 0 ? share : IntrinsicsMatrix(bag + share);
  }
  return contributions;
}

// What bags scatter among themselves beyond their uncertainties does not shrink with the number of
// their segments.
IntrinsicsMatrix scatterOfBags(const std::vector<IntrinsicsMatrix>& contributions, double tau_px,
                               const Camera& lens) {
  EstimateSum bags(lens.parameters().head(lens.estimatedCount()), pixelUnit(lens));
  for (const IntrinsicsMatrix& bag : contributions) {
    if (bag.size() > 0) bags.addInformation(bag);
  }
  return bags.scatterCovariance(tau_px * tau_px);
}

void judge(const CameraHistory& history, int epoch, const QueueSolution& solution,
           EpochSolution* result) {
  const CrossValidation halves = crossValidate(solution, {});
  const double noise =
      pixelUncertainty(solution.camera, result->covariance).rms * halves.inflation();
  result->uncertainty_px = std::hypot(noise, misfitOf(history, epoch));
  HealthEvidence evidence;
  evidence.has_estimate = true;
  evidence.handed_over = true;
  evidence.information = solution.information;
  evidence.uncertainty = {result->uncertainty_px, result->uncertainty_px};
  evidence.threshold_px = Options().convergedRms(solution.camera);
  evidence.blind_below_px = halves.blindBelowPx();
  result->health = judgeHealth(evidence, solution.camera, CalibrationState::kConverging);
}

}  // namespace

std::vector<WantedSegment> bestSegments(const CameraHistory& history, int epoch, int count,
                                        const SegmentStore& store, int* missing) {
  std::vector<WantedSegment> all, best;
  for (std::size_t b = 0; b < history.bags.size(); ++b) {
    const HistoricBag& bag = history.bags[b];
    if (bag.epoch != epoch) continue;
    for (const SegmentMark& mark : bag.used.segments) {
      all.push_back({mark, b, bag.record.bag, bag.record.state_file});
    }
  }
  std::sort(all.begin(), all.end(),
            [](const WantedSegment& a, const WantedSegment& b) { return rank(a) < rank(b); });
  for (const WantedSegment& segment : all) {
    if (static_cast<int>(best.size()) >= count) break;
    const bool shared = std::any_of(best.begin(), best.end(), [&](const WantedSegment& taken) {
      return shareMoment(taken.mark, segment.mark);
    });
    if (shared) continue;
    if (store.has(history.name, segment)) {
      best.push_back(segment);
    } else {
      ++*missing;
    }
  }
  return best;
}

EpochSolution solveEpoch(const CameraHistory& history, int epoch, const SegmentStore& store,
                         const MergeOptions& options) {
  EpochSolution result;
  std::vector<WantedSegment> wanted =
      bestSegments(history, epoch, options.queue_segments, store, &result.missing);
  std::vector<std::size_t> lost;
  LearntState state = unsolved(history, epoch);
  state.segments = comparable(store.load(history.name, wanted, &lost), state.camera);
  for (std::size_t i = lost.size(); i-- > 0;) {
    wanted.erase(wanted.begin() + static_cast<std::ptrdiff_t>(lost[i]));
  }
  result.missing += static_cast<int>(lost.size());
  const StateSolution solved = solveState(state, options.threads);
  const QueueSolution& solution = solved.queue.solution();
  if (!solution.usable || solution.shares.size() != wanted.size()) return result;
  const EstimateSum bags = sumOf(history, epoch);
  result.tau_px = std::sqrt(scatterBeyond(
      bags, EstimateSum(solution.camera.parameters().head(solution.camera.estimatedCount()),
                        pixelUnit(solution.camera))));
  result.contributions = contributionsOf(history, wanted, solution);
  result.covariance =
      solution.covariance + scatterOfBags(result.contributions, result.tau_px, solution.camera);
  judge(history, epoch, solution, &result);
  state.camera = solution.camera;
  state.line_delay_s = solved.line_delay_s;
  state.line_delay_sigma_s = solved.line_delay_sigma_s;
  state.segments = solved.queue.candidates();
  state.state = result.health.state;
  result.segments = std::move(wanted);
  result.learnt = std::make_shared<LearntState>(std::move(state));
  return result;
}

}  // namespace camera_self_calibration
