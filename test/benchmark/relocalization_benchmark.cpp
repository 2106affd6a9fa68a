// What becomes of calibration and map when tracking is lost, by kind of loss and seed.
//
//   relocalization_benchmark [SEEDS] [FIRST_SEED] [KIND]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "pipeline/loss_scenarios.h"

namespace camera_self_calibration {
namespace {

double middle(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }),
               values.end());
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void printTrial(LossKind kind, std::uint64_t seed, const LossOutcome& o) {
  std::fprintf(stderr,
               "%-26s seed %2d: lost %d, relocalized %d (elsewhere %d), changes %d, blind %.2f s, "
               "back %.2f s, map %d, %.0f %% known before, position %.4f of %.2f m, calibration "
               "%.3f px (sigma %.3f), %s\n",
               toString(kind).c_str(), static_cast<int>(seed), o.lost, o.relocalized,
               o.relocalized_elsewhere, o.changes, o.blind_s, o.relocalized_s,
               static_cast<int>(o.map_id), 100.0 * o.known_share, o.position_error, o.travelled,
               o.calibration_error_px, o.after.uncertainty.rms, toString(o.after.state).c_str());
}

void printRow(LossKind kind, const std::vector<LossOutcome>& outcomes) {
  int lost = 0, in_old = 0, false_ones = 0, changes = 0, kept = 0, honest = 0;
  double blind = 0.0;
  std::vector<double> back, position;
  for (const LossOutcome& o : outcomes) {
    lost += o.lost > 0;
    in_old += o.map_id == 0;
    const bool wrong = !(o.position_error < 0.1) && o.relocalized > 0;
    false_ones += o.relocalized_elsewhere > 0 || wrong;
    changes += o.changes;
    kept += o.after.handed_over && o.after.queue.segments.size() >= o.before.queue.segments.size();
    honest += o.calibration_error_px < 3.0 * o.after.uncertainty.rms;
    blind = std::max({blind, o.blind_s, o.blind_elsewhere_s});
    back.push_back(o.relocalized_s);
    position.push_back(o.position_error);
  }
  std::printf("| %s | %zu | %d | %.2f | %d | %.1f | %d | %.1f | %d | %d | %d |\n",
              toString(kind).c_str(), outcomes.size(), lost, blind, in_old, middle(back),
              false_ones, 1e3 * middle(position), kept, honest, changes);
  std::fflush(stdout);
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 5;
  const int first = argc > 2 ? std::atoi(argv[2]) : 1;
  std::printf(
      "| | runs | lost | blind at most [s] | ends in the old map | recognised after [s] | "
      "wrongly | position error [mm] | calibration kept | within 3 sigma | changes |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (std::size_t k = 0; k < lossKinds().size(); ++k) {
    if (argc > 3 && static_cast<int>(k) != std::atoi(argv[3])) continue;
    std::vector<LossOutcome> outcomes;
    for (int i = 0; i < seeds; ++i) {
      const auto seed = static_cast<std::uint64_t>(first + i);
      outcomes.push_back(runLoss(lossKinds()[k], seed));
      printTrial(lossKinds()[k], seed, outcomes.back());
    }
    printRow(lossKinds()[k], outcomes);
  }
}
