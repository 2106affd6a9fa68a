// Does it notice that no lens model describes the lens? Simulated feature tracks of lenses outside
// the models (rational, decentred beyond p1 and p2, a local bump), of each model calibrated as each
// other, and of each as itself, every one with a hand-held motion and a noise of its own (0.1 to
// 0.3 px).
//
//   misfit_benchmark [--sequences 24] [--seconds 25] [--first-seed 1] [--rows TEXT]
//
// sequences of each row; only rows whose name contains the text.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "benchmark/handheld_run.h"
#include "benchmark/program_arguments.h"
#include "benchmark/random_lens.h"
#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/base/parallel.h"
#include "camera_self_calibration/camera/image_weights.h"
#include "camera_self_calibration/camera/pixel_grid.h"
#include "camera_self_calibration/camera/rotation_compensation.h"
#include "camera_self_calibration/pipeline/front_end.h"
#include "camera_self_calibration/simulation/random.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {
namespace {

constexpr int kThreads = 2;
constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr double kVisiblePx = 1.0;  // what a misfit has to be noticed from

using Warp = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

// A camera, and where what it images at a pixel is seen in truth.
struct TrueLens {
  Camera camera;
  Warp warp;
};

// From the middle of the image, in halves of its width.
Eigen::Vector2d centred(const Eigen::Vector2d& pixel) {
  return (pixel - Eigen::Vector2d(0.5 * kWidth, 0.5 * kHeight)) / (0.5 * kWidth);
}

// r (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6) on a pinhole camera; drawn
// until it is monotonic.
TrueLens rational(std::uint64_t seed) {
  Random random(mixSeed(seed, 21));
  const Camera pinhole = randomLens(CameraModel::kPinhole, kWidth, kHeight, seed).camera;
  const double f = pinhole.parameters()(0);
  const double edge = 0.5 * std::hypot(kWidth, kHeight) / f;
  double k[6];
  const auto distorted = [&k](double r) {
    const double r2 = r * r;
    return r * (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[2]))) /
           (1.0 + r2 * (k[3] + r2 * (k[4] + r2 * k[5])));
  };
  const auto monotonic = [&] {
    for (int i = 0; i < 50; ++i) {
      if (distorted(edge * (i + 1) / 50.0) <= distorted(edge * i / 50.0)) return false;
    }
    return true;
  };
  do {
    double power = 1.0;
    for (int i = 0; i < 3; ++i) {
      power *= edge * edge;
      k[3 + i] = random.uniform(0.0, 1.5) / power;
      k[i] = k[3 + i] + random.uniform(-0.4, 0.2) / power;
    }
  } while (!monotonic());
  const Eigen::Vector2d centre = pinhole.parameters().segment<2>(2);
  const std::vector<double> fixed(k, k + 6);
  return {pinhole, [centre, f, fixed](const Eigen::Vector2d& pixel) {
            const Eigen::Vector2d x = (pixel - centre) / f;
            const double r2 = x.squaredNorm();
            const double up = 1.0 + r2 * (fixed[0] + r2 * (fixed[1] + r2 * fixed[2]));
            const double down = 1.0 + r2 * (fixed[3] + r2 * (fixed[4] + r2 * fixed[5]));
            return Eigen::Vector2d(centre + f * up / down * x);
          }};
}

// Decentring of the next order: 2 to 8 px in the corners.
TrueLens decentred(std::uint64_t seed) {
  Random random(mixSeed(seed, 22));
  const Eigen::Vector2d p = random.uniform(1.0, 4.0) *
                            Eigen::Vector2d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
  return {randomLens(modelOf(seed), kWidth, kHeight, seed).camera,
          [p](const Eigen::Vector2d& pixel) {
            const Eigen::Vector2d x = centred(pixel);
            const double r2 = x.squaredNorm();
            return Eigen::Vector2d(pixel + r2 * (r2 * p + 2.0 * x.dot(p) * x));
          }};
}

// A place of 40 to 100 px where all is seen `height_px` to one side.
TrueLens bumpOf(double height_px, std::uint64_t seed) {
  Random random(mixSeed(seed, 23));
  const Eigen::Vector2d centre(random.uniform(0.2, 0.8) * kWidth,
                               random.uniform(0.2, 0.8) * kHeight);
  const double size = random.uniform(40.0, 100.0);
  const double angle = random.uniform(0.0, 2.0 * M_PI);
  const Eigen::Vector2d side = height_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  return {randomLens(modelOf(seed), kWidth, kHeight, seed).camera,
          [centre, size, side](const Eigen::Vector2d& pixel) {
            const double squared = (pixel - centre).squaredNorm() / (size * size);
            return Eigen::Vector2d(pixel + std::exp(-0.5 * squared) * side);
          }};
}

TrueLens ofModel(CameraModel model, std::uint64_t seed) {
  return {randomLens(model, kWidth, kHeight, seed).camera,
          [](const Eigen::Vector2d& pixel) { return pixel; }};
}

struct Outcome {
  CalibrationReport report;
  double error_px = NAN;  // from the true lens where features were, a rotation removed

  bool converged() const { return report.state == CalibrationState::kConverged; }
  bool flagged() const { return !converged() || report.lens_fit.refuted; }
  double stated() const { return report.observed.uncertainty.rms; }
};

TrackRunOptions runOptions(const TrueLens& lens, std::uint64_t seed, double seconds) {
  Random random(mixSeed(seed, 24));
  TrackRunOptions run = handheldRun(seed, seconds, &random);
  run.outlier_share = 0.01;
  run.warp = lens.warp;
  return run;
}

// The pixels at which features were, with their true rays.
std::vector<PixelRay> seenRays(const TrueLens& lens, const ImageWeights& features) {
  std::vector<PixelRay> rays = pixelGrid(lens.camera, features);
  for (PixelRay& ray : rays) ray.pixel = lens.warp(ray.pixel);
  return rays;
}

Outcome trial(const TrueLens& lens, std::optional<CameraModel> model, std::uint64_t seed,
              double seconds) {
  Options options;
  options.model = model;
  TrackRun run(lens.camera, options, runOptions(lens, seed, seconds));
  ImageWeights features(kWidth, kHeight);
  run.record.on_keyframe = [&features](const KeyframeMessage& message) {
    const int newest = static_cast<int>(message.candidate.keyframes.size()) - 1;
    for (const Observation& observation : message.candidate.observations) {
      if (observation.keyframe == newest) features.count(observation.pixel);
    }
  };
  run.run(static_cast<int>(seconds * kHandheldRateHz));
  Outcome outcome{run.report()};
  outcome.error_px = bestRotation(seenRays(lens, features), outcome.report.camera).error.rms;
  return outcome;
}

struct Row {
  std::string name;
  std::function<TrueLens(std::uint64_t)> lens;
  std::function<std::optional<CameraModel>(std::uint64_t)> model;
};

const CameraModel kModels[] = {CameraModel::kPinhole, CameraModel::kFov, CameraModel::kRadtan,
                               CameraModel::kEquidistant};

// Those whose name contains the text.
std::vector<Row> rowsNamed(const std::string& text) {
  const auto automatic = [](std::uint64_t) { return std::optional<CameraModel>(); };
  const auto given = [](std::uint64_t seed) {
    return std::optional<CameraModel>(kModels[seed / 4 % 4]);
  };
  const auto itself = [](std::uint64_t seed) { return std::optional<CameraModel>(modelOf(seed)); };
  const auto another = [](std::uint64_t seed) {
    const CameraModel model = kModels[seed / 4 % 4];
    return std::optional<CameraModel>(model != modelOf(seed) ? model : kModels[(seed / 4 + 1) % 4]);
  };
  const auto own = [](std::uint64_t seed) { return ofModel(modelOf(seed), seed); };
  const auto bump1 = [](std::uint64_t seed) { return bumpOf(1.0, seed); };
  const auto bump4 = [](std::uint64_t seed) { return bumpOf(4.0, seed); };
  std::vector<Row> all = {
      {"of the models, as itself", own, itself},    {"of the models, auto", own, automatic},
      {"of the models, as another", own, another},  {"rational, auto", rational, automatic},
      {"rational, model given", rational, given},   {"decentred, auto", decentred, automatic},
      {"decentred, model given", decentred, given}, {"bump of 1 px, auto", bump1, automatic},
      {"bump of 4 px, auto", bump4, automatic}};
  all.erase(
      std::remove_if(all.begin(), all.end(),
                     [&](const Row& row) { return row.name.find(text) == std::string::npos; }),
      all.end());
  return all;
}

void print(const Row& row, std::uint64_t seed, const Outcome& outcome) {
  std::printf("%s, seed %llu: %s %s, error %.3f px, stated %.3f px, misfit %.3f px%s%s\n",
              row.name.c_str(), static_cast<unsigned long long>(seed),
              toString(outcome.report.camera.model()).c_str(),
              toString(outcome.report.state).c_str(), outcome.error_px, outcome.stated(),
              outcome.report.lens_fit.misfit_observed.rms,
              outcome.report.lens_fit.better.empty() ? "" : ", better: ",
              outcome.report.lens_fit.better.c_str());
}

void printRow(const Row& row, const std::vector<Outcome>& outcomes) {
  int converged = 0, visible = 0, noticed = 0, faint = 0, faint_flagged = 0, inside = 0;
  std::vector<double> errors, stated;
  for (const Outcome& outcome : outcomes) {
    const bool wrong = !(outcome.error_px <= kVisiblePx);
    visible += wrong;
    noticed += wrong && outcome.flagged();
    faint += !wrong;
    faint_flagged += !wrong && outcome.flagged();
    if (!outcome.converged()) continue;
    ++converged;
    inside += outcome.error_px <= 3.0 * outcome.stated();
    errors.push_back(outcome.error_px);
    stated.push_back(outcome.stated());
  }
  std::printf("| %s | %zu | %d | %d of %d | %d of %d | %.3f | %.3f | %.3f | %d of %d |\n",
              row.name.c_str(), outcomes.size(), converged, noticed, visible, faint_flagged, faint,
              median(errors, NAN),
              errors.empty() ? NAN : *std::max_element(errors.begin(), errors.end()),
              median(stated, NAN), inside, converged);
}

int run(const std::vector<Row>& rows, int sequences, double seconds, std::uint64_t first_seed) {
  std::vector<std::vector<Outcome>> all;
  for (const Row& row : rows) {
    std::vector<Outcome> outcomes(static_cast<std::size_t>(sequences));
    parallelFor(kThreads, sequences, [&](int i) {
      const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
      outcomes[static_cast<std::size_t>(i)] = trial(row.lens(seed), row.model(seed), seed, seconds);
    });
    for (int i = 0; i < sequences; ++i) {
      print(row, first_seed + static_cast<std::uint64_t>(i), outcomes[static_cast<std::size_t>(i)]);
    }
    std::fflush(stdout);
    all.push_back(std::move(outcomes));
  }
  std::puts(
      "\n| lens | sequences | CONVERGED | beyond 1 px, flagged | within 1 px, flagged | error of "
      "CONVERGED, median [px] | worst | stated, median | inside 3 sigma |\n"
      "|---|---|---|---|---|---|---|---|---|");
  for (std::size_t i = 0; i < all.size(); ++i) printRow(rows[i], all[i]);
  return 0;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  const auto values = camera_self_calibration::readArguments(
      argc, argv,
      {{"--sequences", "24"}, {"--seconds", "25"}, {"--first-seed", "1"}, {"--rows", ""}});
  if (!values) return 1;
  return camera_self_calibration::run(camera_self_calibration::rowsNamed(values->at("--rows")),
                                      std::stoi(values->at("--sequences")),
                                      std::stod(values->at("--seconds")),
                                      std::stoull(values->at("--first-seed")));
}
