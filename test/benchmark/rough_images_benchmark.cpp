// Calibration from rough images: rolling shutter, exposure, blur, noise, vignetting, JPEG, drops,
// moving objects, text.
//
//   rough_images_benchmark [--kinds none,rolling] [--sequences 8] [--first-seed 1]
//                          [--seconds 30] [--scale 1] [--shutter auto|off]
//
// The same seed has the same room, lens and motion whatever the roughness.

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
#include "benchmark/rough_sequence.h"
#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/base/parallel.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"

namespace camera_self_calibration {
namespace {

constexpr int kThreads = 2;

struct Arguments {
  std::string kinds;  ///< How their names begin, with commas between; empty: all.
  int sequences = 0;
  std::uint64_t first_seed = 0;
  double seconds = 0.0;
  double scale = 1.0;  ///< Of the images, from 640 x 480.
  bool estimate_readout = true;
};

struct Row {
  CalibrationReport report;
  double error_px = NAN;         ///< rms distance from the truth.
  double deviation = 0.0;        ///< Sum of squared z of the parameters ...
  int parameters = 0;            ///< ... and how many.
  bool false_converged = false;  ///< CONVERGED while further from the truth than its limit.
  int lost = 0;
};

bool converged(const CalibrationReport& report) {
  return report.state == CalibrationState::kConverged;
}

Row runTrial(const Roughness& kind, const Arguments& arguments, std::uint64_t seed) {
  const CameraModel model = modelOf(seed);
  Row row;
  std::vector<Camera> believed;
  Options options;
  options.model = model;
  options.estimate_readout = arguments.estimate_readout;
  Callbacks callbacks;
  callbacks.calibration = [&](const CalibrationReport& report) {
    if (converged(report)) believed.push_back(report.camera);
  };
  callbacks.event = [&](const Event& event) { row.lost += event.type == EventType::kLost; };
  SelfCalibrator calibrator(options, SelfCalibrator::Mode::kInline, callbacks);
  RoughVideo video;
  video.model = model;
  video.seed = seed;
  video.duration_s = arguments.seconds;
  video.scale = arguments.scale;
  const Camera truth =
      renderRough(video, kind, [&](const ImageView& view) { calibrator.process(view); });
  row.report = calibrator.calibration();
  const double limit = options.convergedRms(truth);
  for (const Camera& camera : believed) {
    row.false_converged = row.false_converged || pixelDistance(truth, camera).rms > 2.0 * limit;
  }
  if (row.report.covariance.size() == 0) return row;
  row.error_px = pixelDistance(truth, row.report.camera).rms;
  row.parameters = static_cast<int>(
      std::min<Eigen::Index>(row.report.covariance.rows(), truth.parameters().size()));
  for (int i = 0; i < row.parameters; ++i) {
    const double difference = row.report.camera.parameters()(i) - truth.parameters()(i);
    row.deviation += difference * difference / row.report.covariance(i, i);
  }
  return row;
}

void print(const Roughness& kind, std::uint64_t seed, const Row& row) {
  std::printf(
      "%-18s seed %3llu  %-13s error %7.4f px  sigma %7.4f px  rms z %5.2f  "
      "readout %7.3f +- %6.3f ms%s  keyframes %lld  lost %d  swaps %d\n",
      kind.name.c_str(), static_cast<unsigned long long>(seed), toString(row.report.state).c_str(),
      row.error_px, row.report.uncertainty.rms,
      std::sqrt(row.deviation / std::max(1, row.parameters)), 1e3 * row.report.shutter.readout_s,
      1e3 * row.report.shutter.sigma_s, row.report.shutter.rolls ? " *" : "  ",
      static_cast<long long>(row.report.keyframes), row.lost, row.report.queue.swaps);
  std::fflush(stdout);
}

void printSummary(const Roughness& kind, const std::vector<Row>& rows) {
  int converged_count = 0;
  int inside = 0;
  int false_converged = 0;
  double deviation = 0.0;
  int parameters = 0;
  std::vector<double> errors, sigmas;
  for (const Row& row : rows) {
    false_converged += row.false_converged;
    if (!converged(row.report)) continue;
    ++converged_count;
    inside += row.error_px <= 3.0 * row.report.uncertainty.rms;
    deviation += row.deviation;
    parameters += row.parameters;
    errors.push_back(row.error_px);
    sigmas.push_back(row.report.uncertainty.rms);
  }
  const double worst = errors.empty() ? NAN : *std::max_element(errors.begin(), errors.end());
  std::printf("| %-18s | %2d of %2zu | %7.4f | %7.4f | %7.4f | %2d of %2d | %5.2f | %d |\n",
              kind.name.c_str(), converged_count, rows.size(), median(errors, NAN), worst,
              median(sigmas, NAN), inside, converged_count,
              std::sqrt(deviation / std::max(1, parameters)), false_converged);
}

bool wanted(const Arguments& arguments, const std::string& name) {
  std::istringstream beginnings(arguments.kinds);
  bool found = arguments.kinds.empty();
  for (std::string beginning; std::getline(beginnings, beginning, ',');) {
    found = found || name.compare(0, beginning.size(), beginning) == 0;
  }
  return found;
}

int run(const Arguments& arguments) {
  std::vector<std::pair<Roughness, std::vector<Row>>> all;
  for (const Roughness& kind : roughnessKinds()) {
    if (!wanted(arguments, kind.name)) continue;
    std::vector<Row> rows(static_cast<std::size_t>(arguments.sequences));
    parallelFor(kThreads, arguments.sequences, [&](int i) {
      const std::uint64_t seed = arguments.first_seed + static_cast<std::uint64_t>(i);
      Row& row = rows[static_cast<std::size_t>(i)];
      row = runTrial(kind, arguments, seed);
      print(kind, seed, row);
    });
    all.emplace_back(kind, std::move(rows));
  }
  std::printf(
      "\n| roughness | CONVERGED | error, median [px] | worst [px] | sigma, median [px] "
      "| within 3 sigma | rms z | falsely CONVERGED |\n|---|---|---|---|---|---|---|---|\n");
  for (const auto& [kind, rows] : all) printSummary(kind, rows);
  return 0;
}

std::optional<Arguments> parse(int argc, char** argv) {
  const auto values = readArguments(argc, argv,
                                    {{"--kinds", ""},
                                     {"--sequences", "8"},
                                     {"--first-seed", "1"},
                                     {"--seconds", "30"},
                                     {"--scale", "1"},
                                     {"--shutter", "auto"}});
  if (!values) return std::nullopt;
  Arguments arguments;
  arguments.kinds = values->at("--kinds");
  arguments.sequences = std::stoi(values->at("--sequences"));
  arguments.first_seed = std::stoull(values->at("--first-seed"));
  arguments.seconds = std::stod(values->at("--seconds"));
  arguments.scale = std::stod(values->at("--scale"));
  arguments.estimate_readout = values->at("--shutter") == "auto";
  return arguments;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  const auto arguments = camera_self_calibration::parse(argc, argv);
  if (!arguments) return 1;
  return camera_self_calibration::run(*arguments);
}
