// Change detection on simulated feature tracks.
//   change_benchmark delays TRIALS [FIRST_SEED] [KIND]  delay by kind and size of the change
//   change_benchmark alarms HOURS RATE [FIRST_SEED]     alarms while nothing changes
//   change_benchmark many CHANGES [SECONDS] [SEED]      time and memory over many changes
// Trials of different seeds are independent: several processes may share the work. KIND ("+1 %",
// "drift") leaves the kinds without it in their names out, and each trial then gets its own line on
// standard error.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "benchmark/changing_tracks.h"
#include "benchmark/many_changes.h"
#include "benchmark/random_lens.h"
#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kStartNs = kChangingTracksStartNs;

struct Scenario {
  CameraModel model = CameraModel::kFov;
  ChangingTracks tracks;
  double rate_hz = 10.0;
  double false_alarms_per_hour = 0.1;
};

struct Outcome {
  std::vector<Event> changes;
  CalibrationReport report;
  Camera truth;
  double worst_distance_px = 0.0;  // of the estimate while CONVERGED, from the truth then
  int checks = 0;                  // of it after the change, once a second,
  int outside = 0;                 // and how many were off by more than three stated sigmas
  bool converged_at_change = false;
  std::vector<double> p_values;  // of each keyframe's test
};

using LensOverTime = std::function<Camera(double)>;

Outcome runScenario(const Scenario& scenario, const Camera& camera, const LensOverTime& lens,
                    double change_s) {
  FeatureTracks tracks = makeTracks(scenario.tracks, camera, lens);
  Options options;
  options.model = scenario.model;
  options.false_alarms_per_hour = scenario.false_alarms_per_hour;
  options.tracker.max_features = scenario.tracks.features;
  Outcome outcome;
  Callbacks callbacks;
  callbacks.event = [&](const Event& event) {
    if (event.type == EventType::kCalibrationChange) outcome.changes.push_back(event);
  };
  callbacks.calibration = [&](const CalibrationReport& report) {
    if (report.change_p_value < 1.0) outcome.p_values.push_back(report.change_p_value);
  };
  SelfCalibrator calibrator(options, SelfCalibrator::Mode::kInline, callbacks);
  const int frames = static_cast<int>(scenario.tracks.duration_s * scenario.rate_hz);
  for (int i = 0; i < frames; ++i) {
    const double time = i / scenario.rate_hz;
    const TrackedFrame frame = tracks.track(kStartNs + static_cast<std::int64_t>(1e9 * time));
    calibrator.processTracks(frame, [&] { return tracks.detect(); });
    const bool converged = calibrator.calibration().state == CalibrationState::kConverged;
    if (time < change_s) outcome.converged_at_change = converged;
    outcome.truth = tracks.cameraAt(frame.stamp_ns);
    if (i % 10 == 0 && converged) {
      const CalibrationReport report = calibrator.calibration();
      const double distance = pixelDistance(outcome.truth, report.camera).rms;
      outcome.worst_distance_px = std::max(outcome.worst_distance_px, distance);
      outcome.checks += time >= change_s;
      outcome.outside += time >= change_s && distance > 3.0 * report.uncertainty.rms;
    }
  }
  outcome.report = calibrator.calibration();
  return outcome;
}

Camera changed(const Camera& camera, const std::function<void(Intrinsics*)>& change) {
  Intrinsics parameters = camera.parameters();
  change(&parameters);
  Camera result = camera;
  result.setParameters(parameters);
  return result;
}

struct Kind {
  const char* name;
  std::function<void(Intrinsics*, double amount)> apply;
  double amount;
  double limit_s;
  double drift_s;  // 0: a jump
};

void scaleFocal(Intrinsics* p, double amount) { p->head<2>() *= 1.0 + amount; }
void shiftCentre(Intrinsics* p, double amount) { (*p)(2) += amount; }
// Of a lens with distortion, its first coefficient; of fov, w; pinhole has none.
void bendMore(Intrinsics* p, double amount) {
  if (p->size() > 4) (*p)(4) += p->size() == 5 ? -amount : amount;
}

std::vector<Kind> kinds() {
  return {{"focal +10 %", scaleFocal, 0.10, 2.0, 0.0},
          {"focal -10 %", scaleFocal, -0.10, 2.0, 0.0},
          {"focal +3 %", scaleFocal, 0.03, 5.0, 0.0},
          {"focal +1 %", scaleFocal, 0.01, 30.0, 0.0},
          {"centre 10 px", shiftCentre, 10.0, 5.0, 0.0},
          {"distortion 0.03", bendMore, 0.03, 5.0, 0.0},
          {"drift 1 % in 60 s", scaleFocal, 0.01, 60.0, 60.0}};
}

// Of the trials that were CONVERGED when the change came.
struct Row {
  int trials = 0;
  int in_time = 0;
  int early = 0;  // alarms before the change
  int checks = 0, outside = 0;
  double worst = 0.0;
  std::vector<double> delays, errors;
};

double worstOf(const std::vector<double>& values) {
  return values.empty() ? NAN : *std::max_element(values.begin(), values.end());
}

void printRow(const Kind& kind, CameraModel model, const Row& row) {
  std::printf(
      "| %s | %s | %d | %zu, %d within %.0f s | %d | %.2f, %.2f | %.2f, %.2f | %.2f | %.0f %% |\n",
      kind.name, toString(model).c_str(), row.trials, row.delays.size(), row.in_time, kind.limit_s,
      row.early, median(row.delays, NAN), worstOf(row.delays), median(row.errors, NAN),
      worstOf(row.errors), row.worst, 100.0 * row.outside / std::max(1, row.checks));
  std::fflush(stdout);
}

void printTrial(const Scenario& scenario, const Outcome& outcome) {
  std::fprintf(stderr, "  %-12s seed %llu: error %.2f px, sigma %.2f px; %s\n",
               toString(scenario.model).c_str(),
               static_cast<unsigned long long>(scenario.tracks.seed),
               pixelDistance(outcome.truth, outcome.report.camera).rms,
               outcome.report.uncertainty.rms, outcome.report.sentence.c_str());
  for (const Event& event : outcome.changes) {
    std::fprintf(stderr, "    %.1f s: %s\n", toSeconds(event.stamp_ns - kStartNs),
                 event.sentence.c_str());
  }
}

void benchmarkKind(const Kind& kind, CameraModel model, int trials, std::uint64_t first_seed,
                   bool print_each) {
  constexpr double kChangeS = 30.0;
  Row row;
  for (int i = 0; i < trials; ++i) {
    Scenario scenario;
    scenario.model = model;
    scenario.tracks.seed = first_seed + 100 * i;
    scenario.tracks.duration_s = kChangeS + kind.limit_s + 15.0;
    const Camera camera = randomLens(model, 640, 480, scenario.tracks.seed).camera;
    const auto lens = [&](double t) {
      const double share = kind.drift_s > 0.0 ? std::clamp((t - kChangeS) / kind.drift_s, 0.0, 1.0)
                                              : (t >= kChangeS ? 1.0 : 0.0);
      return changed(camera, [&](Intrinsics* p) { kind.apply(p, share * kind.amount); });
    };
    const Outcome outcome = runScenario(scenario, camera, lens, kChangeS);
    if (print_each) printTrial(scenario, outcome);
    if (!outcome.converged_at_change) continue;
    ++row.trials;
    row.errors.push_back(pixelDistance(outcome.truth, outcome.report.camera).rms);
    row.worst = std::max(row.worst, outcome.worst_distance_px);
    row.checks += outcome.checks;
    row.outside += outcome.outside;
    for (const Event& event : outcome.changes) {
      const double delay = toSeconds(event.stamp_ns - kStartNs) - kChangeS;
      row.early += delay < 0.0;
      if (delay < 0.0) continue;
      row.delays.push_back(delay);
      row.in_time += delay <= kind.limit_s;
      break;
    }
  }
  printRow(kind, model, row);
}

int benchmarkDelays(int trials, std::uint64_t first_seed, const std::string& asked) {
  std::printf(
      "| change | lens | trials | noticed | before the change | delay, median, worst [s] "
      "| error at the end, median, worst [px] | while CONVERGED, worst [px] "
      "| of that time above 3 sigma |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const Kind& kind : kinds()) {
    if (std::string(kind.name).find(asked) == std::string::npos) continue;
    for (const CameraModel model : {CameraModel::kPinhole, CameraModel::kFov, CameraModel::kRadtan,
                                    CameraModel::kEquidistant}) {
      const bool no_distortion = model == CameraModel::kPinhole && kind.apply != nullptr &&
                                 std::string(kind.name).rfind("distortion", 0) == 0;
      if (!no_distortion) benchmarkKind(kind, model, trials, first_seed, !asked.empty());
    }
  }
  return 0;
}

int benchmarkAlarms(double hours, double rate, std::uint64_t first_seed) {
  constexpr double kChunkS = 600.0;
  std::size_t alarms = 0;
  std::vector<double> p_values;
  const int chunks = static_cast<int>(std::ceil(hours * 3600.0 / kChunkS));
  for (int i = 0; i < chunks; ++i) {
    Scenario scenario;
    scenario.model = static_cast<CameraModel>(i % 4);
    scenario.tracks.seed = first_seed + 100 * i;
    scenario.rate_hz = 2.0;
    scenario.tracks.motion_speed = 0.3;
    scenario.tracks.duration_s = kChunkS;
    scenario.tracks.features = 48;
    scenario.false_alarms_per_hour = rate;
    const Camera camera = randomLens(scenario.model, 640, 480, scenario.tracks.seed).camera;
    const Outcome outcome = runScenario(scenario, camera, nullptr, 0.0);
    alarms += outcome.changes.size();
    std::printf("%-12s seed %llu: %zu alarms, %s, error %.3f px; so far %zu in %.2f h\n",
                toString(scenario.model).c_str(),
                static_cast<unsigned long long>(scenario.tracks.seed), outcome.changes.size(),
                toString(outcome.report.state).c_str(),
                pixelDistance(outcome.truth, outcome.report.camera).rms, alarms,
                (i + 1) * kChunkS / 3600.0);
    p_values.insert(p_values.end(), outcome.p_values.begin(), outcome.p_values.end());
    for (const Event& event : outcome.changes) std::printf("  %s\n", event.sentence.c_str());
    std::fflush(stdout);
  }
  // p-values are as small as they claim at most in their own share of the tests.
  std::printf(
      "\n| set rate [1/h] | hours | alarms | tests of a keyframe | p < 0.1 | p < 0.01 | p < 0.001 "
      "|\n|---|---|---|---|---|---|---|\n| %g | %.1f | %zu | %zu |",
      rate, chunks * kChunkS / 3600.0, alarms, p_values.size());
  for (const double limit : {0.1, 0.01, 0.001}) {
    const auto below =
        std::count_if(p_values.begin(), p_values.end(), [&](double p) { return p < limit; });
    std::printf(" %ld |", static_cast<long>(below));
  }
  std::printf("\n");
  return 0;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  const std::string mode = argc > 2 ? argv[1] : "";
  const auto number = [&](int i, double otherwise) {
    return argc > i ? std::atof(argv[i]) : otherwise;
  };
  if (mode == "delays") {
    return benchmarkDelays(std::atoi(argv[2]), static_cast<std::uint64_t>(number(3, 1)),
                           argc > 4 ? argv[4] : "");
  }
  if (mode == "alarms" && argc > 3) {
    return benchmarkAlarms(std::atof(argv[2]), std::atof(argv[3]),
                           static_cast<std::uint64_t>(number(4, 1)));
  }
  if (mode == "many") {
    printManyChanges(std::max(1, std::atoi(argv[2])), std::max(1.0, number(3, 8.0)),
                     static_cast<std::uint64_t>(number(4, 1)));
    return 0;
  }
  std::fprintf(stderr,
               "usage: change_benchmark delays TRIALS [FIRST_SEED] [KIND]\n"
               "       change_benchmark alarms HOURS RATE [FIRST_SEED]\n"
               "       change_benchmark many CHANGES [SECONDS] [SEED]\n");
  return 1;
}
