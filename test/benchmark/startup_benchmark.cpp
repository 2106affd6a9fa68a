// Does startup find the optimum? Runs the whole system, but for the images, over many seeds.
//
//   startup_benchmark run SERIES FIRST COUNT > trials.csv
//   startup_benchmark table trials.csv...
//
// SERIES: basin (one wide lens, many first guesses), lenses (many lenses, the default guess),
// uninformative (motions that do not tell the lens), late (nothing to learn from at first).
// Series may be split over processes by their trials' numbers.

#include <cstdlib>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "benchmark/random_lens.h"
#include "benchmark/startup_table.h"
#include "benchmark/startup_trial.h"

namespace camera_self_calibration {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;

Camera fovCamera(double f, double cx, double cy, double w) {
  Intrinsics parameters(5);
  parameters << f, f, cx, cy, w;
  return Camera(CameraModel::kFov, kWidth, kHeight, parameters);
}

// Guesses of 30 to 110 degrees as of a pinhole camera, and w of 0.5 to 1.0.
TrialRecord basinTrial(int number) {
  const int cell = number % 54;
  const double degrees = 30.0 + 10.0 * (cell % 9);
  const double w = 0.5 + 0.1 * (cell / 9);
  TrialRecord record;
  record.group =
      std::to_string(static_cast<int>(degrees)) + " deg w " + std::to_string(w).substr(0, 3);
  record.trial.truth = fovCamera(270.0, 326.0, 235.0, 0.92);
  record.trial.initial = fovCamera(0.5 * kWidth / std::tan(degrees * M_PI / 360.0),
                                   0.5 * (kWidth - 1), 0.5 * (kHeight - 1), w);
  return record;
}

TrialRecord lensTrial(int number) {
  TrialRecord record;
  record.trial.truth =
      randomLens(static_cast<CameraModel>(number % 4), kWidth, kHeight, number + 1).camera;
  record.group = toString(record.trial.truth.model());
  return record;
}

TrialRecord uninformativeTrial(int number) {
  TrialRecord record = lensTrial(number);
  record.trial.scene = static_cast<Scene>(1 + number / 4 % 5);
  record.group = toString(record.trial.scene);
  return record;
}

TrialRecord lateTrial(int number) {
  TrialRecord record = lensTrial(number);
  record.trial.idle = static_cast<Idle>(1 + number / 4 % 3);
  record.trial.idle_s = 40.0;
  record.group = toString(record.trial.idle);
  return record;
}

std::optional<TrialRecord> makeTrial(const std::string& series, int number) {
  TrialRecord record;
  if (series == "basin")
    record = basinTrial(number);
  else if (series == "lenses")
    record = lensTrial(number);
  else if (series == "uninformative")
    record = uninformativeTrial(number);
  else if (series == "late")
    record = lateTrial(number);
  else
    return std::nullopt;
  record.series = series;
  record.number = number;
  record.trial.seed = static_cast<std::uint64_t>(number) + 1;
  return record;
}

int runSeries(const std::string& series, int first, int count) {
  std::cout << csvHeader() << std::endl;
  for (int number = first; number < first + count; ++number) {
    std::optional<TrialRecord> record = makeTrial(series, number);
    if (!record) return EXIT_FAILURE;
    record->outcome = run(record->trial);
    std::cout << csvLine(*record) << std::endl;
  }
  return EXIT_SUCCESS;
}

int usage() {
  std::cerr << "usage: startup_benchmark run basin|lenses|uninformative|late FIRST COUNT\n"
               "       startup_benchmark table FILE...\n";
  return EXIT_FAILURE;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() == 4 && arguments[0] == "run" && makeTrial(arguments[1], 0)) {
    return runSeries(arguments[1], std::atoi(argv[3]), std::atoi(argv[4]));
  }
  if (arguments.size() < 2 || arguments[0] != "table") return usage();
  return printTables({arguments.begin() + 1, arguments.end()}) ? EXIT_SUCCESS : EXIT_FAILURE;
}
