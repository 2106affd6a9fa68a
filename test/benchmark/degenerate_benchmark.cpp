// Motions that tell a lens in part or not at all: is nothing published that is not known, and does
// good motion after them help as if there had been none? On simulated feature tracks.
//
//   degenerate_benchmark run FIRST COUNT > trials.csv
//   degenerate_benchmark table trials.csv...
//   degenerate_benchmark hour early|late MOTION [SECONDS]
//
// run: each motion for 60 s, then 20 s of good motion, and the same good motion alone. Trials go
// through all motions, lens models and seeds; they may be split over processes by their numbers.
// hour: one motion for an hour, from the start (early) or after the calibration has converged
// (late): time and memory by the minute.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "benchmark/csv_rows.h"
#include "benchmark/degenerate_trial.h"
#include "benchmark/random_lens.h"
#include "camera_self_calibration/base/median.h"

namespace camera_self_calibration {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr double kPartS = 10.0;  // of which the cost is told

DegenerateTrial makeTrial(int number) {
  DegenerateTrial trial;
  const int model = number / kDegeneracies % 4;
  trial.degeneracy = static_cast<Degeneracy>(number % kDegeneracies);
  trial.seed = static_cast<std::uint64_t>(number / kDegeneracies) + 1;
  trial.truth = randomLens(static_cast<CameraModel>(model), kWidth, kHeight, trial.seed).camera;
  return trial;
}

const char* const kHeader =
    "number,motion,model,keyframes,states,state,final_state,unfinished,hinted,named,converged_s,"
    "recovered_s,fresh_s,published,worst_ratio,worst_sigmas,false_converged,error_px,stated_px,"
    "travel_deg,lost,early_ms,late_ms,early_kb,late_kb,cpu_s,sentence";

// Mean cost of a keyframe and memory at the end, of the second 10 s and of the last of the
// degenerate minute.
struct Growth {
  double early_ms = 0.0, late_ms = 0.0, early_kb = 0.0, late_kb = 0.0;
};

Growth growthOf(const DegenerateTrial& trial, const DegenerateOutcome& outcome) {
  const auto last = static_cast<std::size_t>(trial.degenerate_s / kPartS) - 1;
  if (outcome.expenses.size() <= last) return {};
  const Expense& early = outcome.expenses[1];
  const Expense& late = outcome.expenses[last];
  return {early.keyframe_ms, late.keyframe_ms, early.memory_kb, late.memory_kb};
}

std::string csvLine(int number, const DegenerateTrial& trial, const DegenerateOutcome& o,
                    double fresh_s) {
  std::ostringstream line;
  const Growth growth = growthOf(trial, o);
  std::string sentence = o.sentence;
  std::replace(sentence.begin(), sentence.end(), ',', ' ');
  line << number << ',' << toString(trial.degeneracy) << ',' << toString(trial.truth.model()) << ','
       << o.keyframes << ',' << (o.states.empty() ? "-" : o.states) << ',' << o.state << ','
       << o.final_state << ',' << o.unfinished << ',' << o.hinted << ',' << o.named << ','
       << o.converged_s << ',' << o.recovered_s << ',' << fresh_s << ',' << o.published << ','
       << o.worst_ratio << ',' << o.worst_sigmas << ',' << o.false_converged << ',' << o.error_px
       << ',' << o.stated_px << ',' << o.travel_deg << ',' << o.lost << ',' << growth.early_ms
       << ',' << growth.late_ms << ',' << growth.early_kb << ',' << growth.late_kb << ',' << o.cpu_s
       << ',' << sentence;
  return line.str();
}

int runTrials(int first, int count) {
  std::cout << kHeader << std::endl;
  for (int number = first; number < first + count; ++number) {
    DegenerateTrial trial = makeTrial(number);
    const DegenerateOutcome outcome = run(trial, kPartS);
    trial.skip_first = true;
    const DegenerateOutcome fresh = run(trial, kPartS);
    std::cout << csvLine(number, trial, outcome, fresh.recovered_s) << std::endl;
  }
  return EXIT_SUCCESS;
}

// What the rows of one motion add up to.
struct Tally {
  int trials = 0, converged = 0, wrong = 0, recovered = 0, fresh = 0;
  double worst_ratio = 0.0, worst_sigmas = 0.0;
  std::vector<double> recovered_s, fresh_s, travel_deg, ratio_ms, ratio_kb;

  void add(const CsvRow& row) {
    ++trials;
    converged += number(row, "converged_s") >= 0.0;
    wrong += number(row, "false_converged") != 0.0;
    if (number(row, "published") > 0.0) {
      worst_ratio = std::max(worst_ratio, number(row, "worst_ratio"));
      worst_sigmas = std::max(worst_sigmas, number(row, "worst_sigmas"));
    }
    recovered += number(row, "recovered_s") >= 0.0;
    if (number(row, "recovered_s") >= 0.0) recovered_s.push_back(number(row, "recovered_s"));
    const double travel = number(row, "travel_deg");
    if (std::isfinite(travel)) travel_deg.push_back(travel);
    fresh += number(row, "fresh_s") >= 0.0;
    if (number(row, "fresh_s") >= 0.0) fresh_s.push_back(number(row, "fresh_s"));
    if (number(row, "early_ms") > 0.0 && number(row, "late_ms") > 0.0) {
      ratio_ms.push_back(number(row, "late_ms") / number(row, "early_ms"));
    }
    if (number(row, "early_kb") > 0.0) {
      ratio_kb.push_back(number(row, "late_kb") / number(row, "early_kb"));
    }
  }
};

void print(const std::string& name, const Tally& t) {
  const double worst_travel =
      t.travel_deg.empty() ? NAN : *std::max_element(t.travel_deg.begin(), t.travel_deg.end());
  std::printf(
      "| %s | %d | %d | %d | %d | %d | %.1f / %.1f s | %.1f | %.1f | %.1f, %.1f | %.2f | "
      "%.2f |\n",
      name.c_str(), t.trials, t.converged, t.wrong, t.recovered, t.fresh,
      median(t.recovered_s, NAN), median(t.fresh_s, NAN), t.worst_ratio, t.worst_sigmas,
      median(t.travel_deg, NAN), worst_travel, median(t.ratio_ms, NAN), median(t.ratio_kb, NAN));
}

int printTable(const std::vector<std::string>& files) {
  std::vector<CsvRow> rows;
  for (const std::string& file : files) {
    if (readCsvRows(file, &rows)) continue;
    std::cerr << "cannot read " << file << "\n";
    return EXIT_FAILURE;
  }
  std::map<std::string, Tally> groups;
  Tally all;
  for (const CsvRow& row : rows) {
    groups[row.at("motion")].add(row);
    all.add(row);
  }
  std::printf(
      "| 60 s of | trials | CONVERGED meanwhile | falsely | CONVERGED after good motion began "
      "| the same motion alone | median time, after / alone | largest error over stated (px rms) "
      "| largest error of a parameter (sigmas) | direction of travel, median, worst (degrees) "
      "| time of a keyframe, late / early | memory, late / early |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [name, tally] : groups) print(name, tally);
  print("all", all);
  return EXIT_SUCCESS;
}

int runHour(bool late, const std::string& motion, double seconds) {
  DegenerateTrial trial;
  bool known = false;
  for (int i = 0; i < kDegeneracies; ++i) {
    if (toString(static_cast<Degeneracy>(i)) != motion) continue;
    trial = makeTrial(i + kDegeneracies);  // a fov lens
    known = true;
  }
  if (!known) {
    std::cerr << "no such motion: " << motion << "\n";
    return EXIT_FAILURE;
  }
  trial.good_first = late;
  trial.good_s = late ? 30.0 : 20.0;
  trial.degenerate_s = seconds;
  const DegenerateOutcome outcome = run(trial, 60.0);
  std::printf("%8s %8s %10s %10s %12s %11s %10s\n", "from s", "frames", "keyframes", "frame ms",
              "keyframe ms", "slowest ms", "held kB");
  for (const Expense& expense : outcome.expenses) {
    std::printf("%8.0f %8d %10d %10.3f %12.2f %11.1f %10.0f\n", expense.begin_s, expense.frames,
                expense.keyframes, expense.frame_ms, expense.keyframe_ms, expense.slowest_ms,
                expense.memory_kb);
  }
  std::printf(
      "%s %s: states %s, at its end %s (%s); CONVERGED left %d times, changes %d, lost %d, "
      "moved %.3f px; at the end %s, error %.3f px, stated %.3f px, worst %.2f sigma\n",
      motion.c_str(), late ? "late" : "early", outcome.states.c_str(), outcome.state.c_str(),
      outcome.sentence.c_str(), outcome.left_converged, outcome.changes, outcome.lost,
      outcome.wander_px, outcome.final_state.c_str(), outcome.error_px, outcome.stated_px,
      outcome.worst_sigmas);
  return EXIT_SUCCESS;
}

int usage() {
  std::cerr << "usage: degenerate_benchmark run FIRST COUNT\n"
               "       degenerate_benchmark table FILE...\n"
               "       degenerate_benchmark hour early|late MOTION [SECONDS]\n"
               "MOTION is one of:";
  for (int i = 0; i < kDegeneracies; ++i) {
    std::cerr << " '" << toString(static_cast<Degeneracy>(i)) << "'";
  }
  std::cerr << "\n";
  return EXIT_FAILURE;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() < 2) return usage();
  if (arguments[0] == "run" && arguments.size() == 3) {
    return runTrials(std::atoi(argv[2]), std::atoi(argv[3]));
  }
  if (arguments[0] == "table") return printTable({arguments.begin() + 1, arguments.end()});
  const bool when = arguments[1] == "early" || arguments[1] == "late";
  if (arguments[0] != "hour" || !when || arguments.size() < 3) return usage();
  const double seconds = arguments.size() > 3 ? std::atof(argv[4]) : 3600.0;
  return runHour(arguments[1] == "late", arguments[2], std::max(kPartS, seconds));
}
