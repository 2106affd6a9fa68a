// The readout time of a rolling shutter, and the calibration with it, on simulated feature tracks.
//
//   rolling_shutter_benchmark [--trials 40] [--first-seed 1] [--seconds 15] [--shutter auto]
//                             [--readouts 0,10,15,30] [--noise 0] [--jitter 0] [--speed 1]
//
// Each trial has a lens, a motion and a noise of its own, the same for every readout time [ms].
// `--noise` is that of all trials [px]; 0: 0.05 to 0.2.
// `--jitter` is how far the images' stamps are off at most [ms].
// `--speed` is a factor on the speed of the motion, and on how fast it changes.
// `--shutter` is what the calibrator is told: auto, off or a readout time [s].

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "benchmark/program_arguments.h"
#include "benchmark/random_lens.h"
#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/simulation/random.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {
namespace {

struct Arguments {
  int trials = 0;
  std::uint64_t first_seed = 0;
  double seconds = 0.0;
  std::string shutter;
  std::string readouts_ms;
  double noise_px = 0.0;
  double jitter_s = 0.0;
  double speed = 1.0;
};

struct Row {
  CalibrationReport report;
  double error_px = NAN;
};

Row runTrial(const Arguments& arguments, double readout_s, std::uint64_t seed) {
  const CameraModel model = modelOf(seed);
  Random random(mixSeed(seed, 55));
  const Camera truth = randomLens(model, 640, 480, seed + 1).camera;
  TrackRunOptions tracks;
  tracks.seed = seed;
  tracks.rate_hz = 30.0;
  tracks.motion_speed = arguments.speed * random.uniform(0.4, 1.2);
  tracks.pixel_sigma = random.uniform(0.05, 0.2);
  if (arguments.noise_px > 0.0) tracks.pixel_sigma = arguments.noise_px;
  tracks.outlier_share = 0.01;
  tracks.max_features = 100;
  tracks.readout_s = readout_s;
  tracks.stamp_jitter_s = arguments.jitter_s;
  tracks.duration_s = arguments.seconds + 1.0;
  Options options = optionsFor(model);
  setRollingShutter(arguments.shutter, &options);
  TrackRun run(truth, options, tracks);
  run.run(static_cast<int>(arguments.seconds * tracks.rate_hz));
  Row row;
  row.report = run.report();
  if (row.report.covariance.size() > 0) {
    row.error_px = pixelDistance(truth, row.report.camera).rms;
  }
  return row;
}

void print(double readout_s, std::uint64_t seed, const Row& row) {
  const ShutterReport& shutter = row.report.shutter;
  std::printf(
      "%4.0f ms  seed %4llu  %-12s %-12s error %8.4f px  sigma %7.4f px  readout %8.4f "
      "+- %7.4f ms%s z %5.2f\n",
      1e3 * readout_s, static_cast<unsigned long long>(seed),
      toString(row.report.camera.model()).c_str(), toString(row.report.state).c_str(), row.error_px,
      row.report.uncertainty.rms, 1e3 * shutter.readout_s, 1e3 * shutter.sigma_s,
      shutter.rolls ? " *" : "  ", (shutter.readout_s - readout_s) / shutter.sigma_s);
  std::fflush(stdout);
}

void printSummary(double readout_s, const std::vector<Row>& rows) {
  int converged = 0, inside = 0, rolls = 0, readout_inside = 0;
  double z2 = 0.0;
  std::vector<double> errors, sigmas, readout_errors;
  for (const Row& row : rows) {
    if (row.report.state != CalibrationState::kConverged) continue;
    ++converged;
    const ShutterReport& shutter = row.report.shutter;
    const double z = (shutter.readout_s - readout_s) / shutter.sigma_s;
    inside += row.error_px <= 3.0 * row.report.uncertainty.rms;
    rolls += shutter.rolls;
    readout_inside += std::abs(z) <= 3.0;
    z2 += z * z;
    errors.push_back(row.error_px);
    sigmas.push_back(row.report.uncertainty.rms);
    readout_errors.push_back(1e3 * std::abs(shutter.readout_s - readout_s));
  }
  const double worst = errors.empty() ? NAN : *std::max_element(errors.begin(), errors.end());
  std::printf("| %2.0f ms | %d of %zu | %.4f | %.3f | %.4f | %d | %d | %.3f | %d | %.2f |\n",
              1e3 * readout_s, converged, rows.size(), median(errors, NAN), worst,
              median(sigmas, NAN), inside, rolls, median(readout_errors, NAN), readout_inside,
              std::sqrt(z2 / std::max(1, converged)));
}

int run(const Arguments& arguments) {
  std::vector<double> readouts;
  std::stringstream list(arguments.readouts_ms);
  for (std::string item; std::getline(list, item, ',');) {
    readouts.push_back(1e-3 * std::atof(item.c_str()));
  }
  std::vector<std::vector<Row>> all;
  for (const double readout_s : readouts) {
    all.emplace_back();
    for (int i = 0; i < arguments.trials; ++i) {
      const std::uint64_t seed = arguments.first_seed + static_cast<std::uint64_t>(i);
      all.back().push_back(runTrial(arguments, readout_s, seed));
      print(readout_s, seed, all.back().back());
    }
  }
  std::printf(
      "\n| readout | CONVERGED | error, median [px] | worst | sigma, median [px] | within 3 "
      "sigma | said to roll | readout error, median [ms] | within 3 sigma | rms z |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < readouts.size(); ++i) printSummary(readouts[i], all[i]);
  return 0;
}

std::optional<Arguments> parse(int argc, char** argv) {
  const auto values = readArguments(argc, argv,
                                    {{"--trials", "40"},
                                     {"--first-seed", "1"},
                                     {"--seconds", "15"},
                                     {"--shutter", "auto"},
                                     {"--readouts", "0,10,15,30"},
                                     {"--noise", "0"},
                                     {"--jitter", "0"},
                                     {"--speed", "1"}});
  if (!values) return std::nullopt;
  Arguments arguments;
  arguments.trials = std::stoi(values->at("--trials"));
  arguments.first_seed = std::stoull(values->at("--first-seed"));
  arguments.seconds = std::stod(values->at("--seconds"));
  arguments.shutter = values->at("--shutter");
  arguments.readouts_ms = values->at("--readouts");
  arguments.noise_px = std::stod(values->at("--noise"));
  arguments.jitter_s = 1e-3 * std::stod(values->at("--jitter"));
  arguments.speed = std::stod(values->at("--speed"));
  Options scratch;
  return setRollingShutter(arguments.shutter, &scratch) ? std::make_optional(arguments)
                                                        : std::nullopt;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  const auto arguments = camera_self_calibration::parse(argc, argv);
  if (!arguments) return 1;
  return camera_self_calibration::run(*arguments);
}
