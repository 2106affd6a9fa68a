// How far calibrations from rendered images are from the truth, against what they say of
// themselves: over sequences of random lens, room, noise and motion, with both scores of the queue
// on the same images.
//
//   consistency_benchmark [SEQUENCES [SECONDS [FOLDER OF TRAJECTORIES]]]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "benchmark/random_sequence.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"

namespace camera_self_calibration {
namespace {

constexpr double kLimit = 3.0;  // sigmas

double medianOf(std::vector<double> values) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// What many runs of one kind came to.
struct Tally {
  int runs = 0;
  int converged = 0;
  int parameters = 0;
  int inside = 0;
  double sum_z2 = 0.0;
  std::vector<double> error_px;
  std::vector<double> stated_px;

  void add(const CalibrationReport& report, const Camera& truth);
  void print(const char* name) const;
};

double truthOf(const Camera& truth, Eigen::Index i) {
  return i < truth.parameters().size() ? truth.parameters()(i) : 0.0;  // a k3 that was added
}

void Tally::add(const CalibrationReport& report, const Camera& truth) {
  ++runs;
  if (report.state != CalibrationState::kConverged) return;
  ++converged;
  error_px.push_back(pixelDistance(truth, report.camera).rms);
  stated_px.push_back(report.uncertainty.rms);
  if (report.camera.model() != truth.model()) return;
  for (Eigen::Index i = 0; i < report.covariance.rows(); ++i) {
    const double z =
        (report.camera.parameters()(i) - truthOf(truth, i)) / std::sqrt(report.covariance(i, i));
    ++parameters;
    inside += std::abs(z) < kLimit;
    sum_z2 += z * z;
  }
}

void Tally::print(const char* name) const {
  std::vector<double> errors = error_px;
  std::sort(errors.begin(), errors.end());
  std::printf("| %s | %d | %d | %.1f %% | %.2f | %.3f | %.3f | %.3f |\n", name, runs, converged,
              100.0 * inside / std::max(1, parameters), std::sqrt(sum_z2 / std::max(1, parameters)),
              medianOf(errors), errors.empty() ? NAN : errors.back(), medianOf(stated_px));
}

void printRow(const char* kind, const CalibrationReport& report, const Camera& truth) {
  std::printf("  %-7s %-11s %-10s error %.3f px, stated %.3f px, %zu segments, %d swaps, z", kind,
              toString(report.camera.model()).c_str(), toString(report.state).c_str(),
              pixelDistance(truth, report.camera).rms, report.uncertainty.rms,
              report.queue.segments.size(), report.queue.swaps);
  for (Eigen::Index i = 0; i < report.covariance.rows(); ++i) {
    if (report.camera.model() != truth.model()) break;
    std::printf(" %.1f", (report.camera.parameters()(i) - truthOf(truth, i)) /
                             std::sqrt(report.covariance(i, i)));
  }
  std::printf("\n");
  std::fflush(stdout);
}

struct Contestant {
  const char* name;
  ScoreKind score;
  Tally all;
  std::vector<Tally> of_model = std::vector<Tally>(4);
};

void runSequence(int number, double seconds, const std::string& trajectories,
                 std::vector<Contestant>* contestants) {
  const auto model = static_cast<CameraModel>(number % 4);
  const RandomSequence random = randomSequence(model, seconds, number, trajectories);
  const SimulatedSequence sequence(random.options);
  const Camera truth = random.options.lens.camera;
  std::printf("%d %s, %s\n", number, toString(model).c_str(), random.motion.c_str());
  std::vector<std::unique_ptr<SelfCalibrator>> calibrators;
  for (const Contestant& contestant : *contestants) {
    Options options;
    options.model = model;
    options.score = contestant.score;
    calibrators.push_back(
        std::make_unique<SelfCalibrator>(options, SelfCalibrator::Mode::kInline, Callbacks()));
  }
  for (int i = 0; i < sequence.size(); ++i) {
    const SimulatedFrame frame = sequence.frame(i);
    for (const auto& calibrator : calibrators) calibrator->process(frame.view());
  }
  for (std::size_t c = 0; c < calibrators.size(); ++c) {
    Contestant& contestant = (*contestants)[c];
    const CalibrationReport report = calibrators[c]->calibration();
    printRow(contestant.name, report, truth);
    contestant.all.add(report, truth);
    contestant.of_model[number % 4].add(report, truth);
  }
}

void printTable(const std::vector<Contestant>& contestants) {
  std::printf(
      "\n| score, model | runs | converged | inside 3 sigma | rms z | error, median [px] | worst "
      "[px] | stated, median [px] |\n|---|---|---|---|---|---|---|---|\n");
  for (const Contestant& contestant : contestants) {
    for (int m = 0; m < 4; ++m) {
      const std::string name =
          std::string(contestant.name) + ", " + toString(static_cast<CameraModel>(m));
      contestant.of_model[m].print(name.c_str());
    }
    contestant.all.print((std::string(contestant.name) + ", all").c_str());
  }
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  using namespace camera_self_calibration;
  const int sequences = argc > 1 ? std::atoi(argv[1]) : 32;
  const double seconds = argc > 2 ? std::atof(argv[2]) : 30.0;
  const std::string trajectories = argc > 3 ? argv[3] : "";
  if (sequences < 1 || !(seconds > 1.0)) {
    std::fprintf(stderr, "usage: %s [SEQUENCES [SECONDS [FOLDER OF TRAJECTORIES]]]\n", argv[0]);
    return 1;
  }
  std::vector<Contestant> contestants = {
      {"entropy", ScoreKind::kEntropy, {}, std::vector<Tally>(4)},
      {"pixel", ScoreKind::kPixel, {}, std::vector<Tally>(4)}};
  for (int i = 0; i < sequences; ++i) runSequence(i, seconds, trajectories, &contestants);
  printTable(contestants);
  return 0;
}
