// The queue against the batch solution of the whole trajectory, and the self-calibrating trajectory
// against the one with the true intrinsics, over rendered sequences.
//
//   queue_versus_batch [--sequences 32] [--first-seed 1] [--seconds 60] [--trajectories FOLDER]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "benchmark/program_arguments.h"
#include "benchmark/random_lens.h"
#include "benchmark/random_sequence.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/pipeline/front_end.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"
#include "camera_self_calibration/reference/trajectory_batch.h"
#include "camera_self_calibration/reference/trajectory_comparison.h"

namespace camera_self_calibration {
namespace {

struct Arguments {
  int sequences = 0;
  std::uint64_t first_seed = 0;
  double seconds = 0.0;
  std::string trajectories;
};

/// The models in turn.
RandomSequence sequenceOf(const Arguments& arguments, int index) {
  const std::uint64_t seed = arguments.first_seed + static_cast<std::uint64_t>(index);
  return randomSequence(modelOf(seed), arguments.seconds, seed, arguments.trajectories);
}

/// One calibrator and what it said.
struct Run {
  explicit Run(const Options& options)
      : calibrator(options, SelfCalibrator::Mode::kInline, callbacks()) {}

  Callbacks callbacks() {
    Callbacks result;
    result.frame = [this](const FrameResult& frame) {
      if (frame.state != TrackingState::kTracking) return;
      poses.push_back({frame.stamp_ns, frame.map_id, frame.world_from_camera});
    };
    result.event = [this](const Event& event) {
      if (event.type == EventType::kHandover && !handover_ns) handover_ns = event.stamp_ns;
    };
    result.keyframe = [this](const KeyframeMessage& message) { batch.add(message.candidate); };
    return result;
  }

  std::vector<StampedCameraPose> poses;
  std::optional<std::int64_t> handover_ns;
  TrajectoryBatch batch;
  SelfCalibrator calibrator;
};

struct Row {
  bool converged = false;
  double queue_px = NAN;  ///< rms distance from the truth.
  double batch_px = NAN;
  double queue_sigma_px = NAN;
  double batch_sigma_px = NAN;
  int inside = 0;  ///< Parameters of queue minus batch inside 3 sqrt(diag(C_queue - C_batch)).
  int inside_loosely = 0;  ///< Inside 3 sqrt(diag(C_queue + C_batch)).
  int parameters = 0;
  double startup_share = NAN;  ///< Mean distance of the trajectories over the way.
  double share = NAN;          ///< The same after hand-over.
  double ate_self = NAN;       ///< After hand-over, from the truth [m].
  double ate_fixed = NAN;
};

void compareEstimates(const CalibrationReport& queue, const BatchEstimate& batch,
                      const Camera& truth, Row* row) {
  row->queue_px = pixelDistance(truth, queue.camera).rms;
  row->batch_px = pixelDistance(truth, batch.camera).rms;
  row->queue_sigma_px = queue.uncertainty.rms;
  row->batch_sigma_px = batch.uncertainty.rms;
  const Eigen::Index n = queue.covariance.rows();
  if (batch.covariance.rows() != n) return;
  row->parameters = static_cast<int>(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double difference = std::abs(queue.camera.parameters()(i) - batch.camera.parameters()(i));
    const double queue_variance = queue.covariance(i, i);
    const double batch_variance = batch.covariance(i, i);
    row->inside += difference <= 3.0 * std::sqrt(std::max(0.0, queue_variance - batch_variance));
    row->inside_loosely += difference <= 3.0 * std::sqrt(queue_variance + batch_variance);
  }
}

std::vector<StampedCameraPose> truthOf(const SimulatedSequence& sequence) {
  std::vector<StampedCameraPose> poses;
  for (int i = 0; i < sequence.size(); ++i) {
    poses.push_back({sequence.stampNs(i), 0, sequence.worldFromCamera(i)});
  }
  return poses;
}

void compareTrajectoriesOf(const Run& self, const Run& fixed, const SimulatedSequence& sequence,
                           Row* row) {
  const std::int64_t end = sequence.stampNs(sequence.size() - 1) + 1;
  const std::int64_t handover = self.handover_ns.value_or(end);
  const auto late = between(self.poses, handover, end);
  const auto truth = truthOf(sequence);
  if (const auto d = compareTrajectories(between(self.poses, 0, handover), fixed.poses)) {
    row->startup_share = d->share();
  }
  if (const auto d = compareTrajectories(late, fixed.poses)) row->share = d->share();
  if (const auto d = compareTrajectories(late, truth)) row->ate_self = d->rms;
  if (const auto d = compareTrajectories(between(fixed.poses, handover, end), truth)) {
    row->ate_fixed = d->rms;
  }
}

Row runTrial(const SequenceOptions& options) {
  const SimulatedSequence sequence(options);
  Options self_options;
  self_options.model = options.lens.camera.model();
  Options fixed_options = self_options;
  fixed_options.initial_camera = options.lens.camera;
  fixed_options.fix_intrinsics = true;
  Run self(self_options);
  Run fixed(fixed_options);
  for (int i = 0; i < sequence.size(); ++i) {
    const ImageView image = sequence.frame(i).view();
    self.calibrator.process(image);
    fixed.calibrator.process(image);
  }
  Row row;
  const CalibrationReport report = self.calibrator.calibration();
  row.converged = report.state == CalibrationState::kConverged;
  if (report.covariance.size() > 0) {
    compareEstimates(report, self.batch.solve(report.camera), options.lens.camera, &row);
  }
  compareTrajectoriesOf(self, fixed, sequence, &row);
  return row;
}

void print(const std::string& name, const Row& row) {
  std::printf(
      "| %-44s | %-3s | %7.4f | %7.4f | %6.2f | %7.4f | %7.4f | %d/%d | %d/%d "
      "| %6.2f %% | %6.2f %% | %6.3f | %6.3f |\n",
      name.c_str(), row.converged ? "yes" : "no", row.queue_px, row.batch_px,
      row.queue_px / row.batch_px, row.queue_sigma_px, row.batch_sigma_px, row.inside,
      row.parameters, row.inside_loosely, row.parameters, 100.0 * row.startup_share,
      100.0 * row.share, row.ate_self, row.ate_fixed);
  std::fflush(stdout);
}

std::string spread(const std::vector<Row>& rows, double (*value)(const Row&), int decimals) {
  std::vector<double> values;
  for (const Row& row : rows) {
    if (!std::isnan(value(row))) values.push_back(value(row));
  }
  if (values.empty()) return "-";
  return formatted("%.*f (%.*f)", decimals, median(values, 0.0), decimals,
                   *std::max_element(values.begin(), values.end()));
}

void printSummary(const std::string& lens, const std::vector<Row>& rows) {
  int inside = 0, parameters = 0, converged = 0;
  for (const Row& row : rows) {
    inside += row.inside;
    parameters += row.parameters;
    converged += row.converged;
  }
  const auto column = [&](double (*value)(const Row&), int decimals) {
    return spread(rows, value, decimals);
  };
  std::printf("| %s | %d of %zu | %s | %s | %s | %d of %d | %s | %s | %s | %s |\n", lens.c_str(),
              converged, rows.size(), column([](const Row& r) { return r.queue_px; }, 3).c_str(),
              column([](const Row& r) { return r.batch_px; }, 3).c_str(),
              column([](const Row& r) { return r.queue_px / r.batch_px; }, 1).c_str(), inside,
              parameters, column([](const Row& r) { return 100.0 * r.startup_share; }, 1).c_str(),
              column([](const Row& r) { return 100.0 * r.share; }, 3).c_str(),
              column([](const Row& r) { return 1e3 * r.ate_self; }, 1).c_str(),
              column([](const Row& r) { return 1e3 * r.ate_fixed; }, 1).c_str());
}

int run(const Arguments& arguments) {
  std::printf(
      "| sequence | converged | queue [px] | batch [px] | ratio | queue sigma [px] "
      "| batch sigma [px] | inside C_q - C_b | inside C_q + C_b | apart, startup | apart, "
      "later | ATE self [m] | ATE true intrinsics [m] |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  std::vector<Row> rows;
  std::map<std::string, std::vector<Row>> by_lens;
  for (int i = 0; i < arguments.sequences; ++i) {
    const RandomSequence trial = sequenceOf(arguments, i);
    const std::string lens = toString(trial.options.lens.camera.model());
    rows.push_back(runTrial(trial.options));
    by_lens[lens].push_back(rows.back());
    print(lens + ", seed " + std::to_string(arguments.first_seed + static_cast<std::uint64_t>(i)) +
              ", " + trial.motion,
          rows.back());
  }
  std::printf(
      "\nMedians, and the worst in brackets:\n\n"
      "| lens | CONVERGED | queue from the truth [px rms] | batch from the truth [px rms] "
      "| queue / batch | parameters whose difference is inside 3 sigma "
      "| trajectories apart during startup [%%] | later [%%] | ATE [mm] "
      "| ATE with the true intrinsics [mm] |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [lens, its_rows] : by_lens) printSummary(lens, its_rows);
  printSummary("all", rows);
  return 0;
}

std::optional<Arguments> parse(int argc, char** argv) {
  const auto values = readArguments(
      argc, argv,
      {{"--sequences", "32"}, {"--first-seed", "1"}, {"--seconds", "60"}, {"--trajectories", ""}});
  if (!values) return std::nullopt;
  Arguments arguments;
  arguments.sequences = std::stoi(values->at("--sequences"));
  arguments.first_seed = std::stoull(values->at("--first-seed"));
  arguments.seconds = std::stod(values->at("--seconds"));
  arguments.trajectories = values->at("--trajectories");
  return arguments;
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  const auto arguments = camera_self_calibration::parse(argc, argv);
  if (!arguments) return 1;
  return camera_self_calibration::run(*arguments);
}
