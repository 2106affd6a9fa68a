// What an audit says of right and wrong calibrations, over simulated feature tracks of random
// lenses, each with a hand-held motion, noise (0.1 to 0.3 px) and gross errors (to 2 %) of its own.
// The model is found by itself (auto).
//
//   audit_benchmark [SEQUENCES [SECONDS [FIRST SEED]]]
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "benchmark/handheld_run.h"
#include "benchmark/random_lens.h"
#include "camera_self_calibration/audit/audit.h"
#include "camera_self_calibration/base/parallel.h"
#include "camera_self_calibration/simulation/random.h"
#include "pipeline/track_run.h"

namespace camera_self_calibration {
namespace {

constexpr int kThreads = 2;

Camera with(const Camera& camera, double focal, double shift_px, double k) {
  Intrinsics p = camera.parameters();
  p.head<2>() *= focal;
  p(2) += shift_px;
  p.head<4>() *= k;
  return Camera(camera.model(), camera.width(), camera.height(), p);
}

std::optional<Camera> misnamed(const Camera& camera) {
  if (camera.model() == CameraModel::kRadtan) {
    return Camera(CameraModel::kEquidistant, camera.width(), camera.height(), camera.parameters());
  }
  if (camera.model() == CameraModel::kEquidistant) {
    return Camera(CameraModel::kRadtan, camera.width(), camera.height(), camera.parameters());
  }
  return std::nullopt;
}

// A calibration that is given for the true one.
struct Case {
  const char* name;
  std::function<std::optional<Camera>(const Camera&)> given;
  LikelyCause cause;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"true", [](const Camera& c) { return c; }, LikelyCause::kNone},
      {"focal length +0.2 %", [](const Camera& c) { return with(c, 1.002, 0, 1); },
       LikelyCause::kNone},
      {"focal length +1 %", [](const Camera& c) { return with(c, 1.01, 0, 1); },
       LikelyCause::kFocalLength},
      {"focal length -1 %", [](const Camera& c) { return with(c, 0.99, 0, 1); },
       LikelyCause::kFocalLength},
      {"focal length +5 %", [](const Camera& c) { return with(c, 1.05, 0, 1); },
       LikelyCause::kFocalLength},
      {"principal point 30 px off", [](const Camera& c) { return with(c, 1, 30, 1); },
       LikelyCause::kPrincipalPoint},
      {"half of K", [](const Camera& c) { return with(c, 1, 0, 0.5); }, LikelyCause::kResolution},
      {"radtan as equidistant, or the reverse", misnamed, LikelyCause::kModel}};
  return all;
}

struct Outcome {
  std::vector<std::optional<AuditReport>> audits;  // by case, at the end
  bool ever_wrong = false;                         // said of the true one at any keyframe
};

TrackRunOptions runOptions(std::uint64_t seed, double seconds) {
  Random random(mixSeed(seed, 91));
  TrackRunOptions run = handheldRun(seed, seconds, &random);
  run.outlier_share = random.uniform(0.0, 0.02);
  return run;
}

Outcome trial(std::uint64_t seed, double seconds) {
  const Camera truth = randomLens(modelOf(seed), 640, 480, seed).camera;
  TrackRun run(truth, Options(), runOptions(seed, seconds));
  Outcome outcome;
  std::uint64_t judged = 0;
  for (int i = 0; i < seconds * kHandheldRateHz; ++i) {
    run.step();
    const CalibrationReport report = run.report();
    if (report.revision == judged) continue;
    judged = report.revision;
    const AuditVerdict verdict = audit(truth, report, AuditOptions()).verdict;
    outcome.ever_wrong |= verdict == AuditVerdict::kWrong;
  }
  for (const Case& made : cases()) {
    const std::optional<Camera> given = made.given(truth);
    outcome.audits.push_back(given ? std::optional(audit(*given, run.report(), AuditOptions()))
                                   : std::nullopt);
  }
  return outcome;
}

void printRow(std::size_t index, const std::vector<Outcome>& outcomes) {
  int count[3] = {0, 0, 0};
  int all = 0;
  int named = 0;
  for (const Outcome& outcome : outcomes) {
    const std::optional<AuditReport>& audit = outcome.audits[index];
    if (!audit) continue;
    ++all;
    ++count[static_cast<int>(audit->verdict)];
    named += audit->verdict == AuditVerdict::kWrong && audit->cause == cases()[index].cause;
  }
  std::printf("| %s | %d | %d | %d | %d | %d |\n", cases()[index].name, all, count[0], count[1],
              count[2], named);
}

int run(int sequences, double seconds, int first) {
  std::vector<Outcome> outcomes(static_cast<std::size_t>(sequences));
  parallelFor(kThreads, sequences, [&](int i) {
    outcomes[static_cast<std::size_t>(i)] = trial(static_cast<std::uint64_t>(first + i), seconds);
  });
  std::puts("| calibration given | sequences | GOOD | WRONG | CANNOT_TELL | WRONG, cause right |");
  std::puts("|---|---|---|---|---|---|");
  for (std::size_t i = 0; i < cases().size(); ++i) printRow(i, outcomes);
  int ever = 0;
  for (const Outcome& outcome : outcomes) ever += outcome.ever_wrong;
  std::printf("\nthe true one called WRONG at any keyframe: %d of %d sequences\n", ever, sequences);
  return 0;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  const int sequences = argc > 1 ? std::atoi(argv[1]) : 120;
  const double seconds = argc > 2 ? std::atof(argv[2]) : 20.0;
  const int first = argc > 3 ? std::atoi(argv[3]) : 5001;
  return camera_self_calibration::run(sequences, seconds, first);
}
