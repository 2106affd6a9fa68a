#include "camera_self_calibration/tools/batch_comparison.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/map/rolling_shutter.h"

namespace camera_self_calibration {
namespace {

constexpr int kSizes[] = {5, 10, 15, 20};
// Solved again after so many keyframes, or after this share of those before.
constexpr int kInterval = 20;
constexpr double kGrowth = 0.25;

/// Difference over sqrt(C_queue - C_batch); not a number where the batch is said to be the worse
/// one.
double efficientDifference(const CalibrationReport& queue, const BatchEstimate& batch,
                           Eigen::Index i) {
  const double difference = queue.camera.parameters()(i) - batch.camera.parameters()(i);
  const double variance = queue.covariance(i, i) - batch.covariance(i, i);
  return variance > 0.0 ? difference / std::sqrt(variance)
                        : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

const BatchEstimate* comparable(const CalibrationReport& queue, const BatchComparison& comparison) {
  if (comparison.batch.size() <= comparison.present_lens || queue.covariance.size() == 0) {
    return nullptr;
  }
  const BatchEstimate& batch = comparison.batch.back();
  const bool same = batch.covariance.rows() == queue.covariance.rows() &&
                    batch.camera.model() == queue.camera.model();
  return same ? &batch : nullptr;
}

void BatchComparer::startOthers(const Camera& first) {
  for (const int size : kSizes) {
    OtherSize other;
    other.run.segments = size;
    if (size != options_.queue_segments) {
      Options options = options_;
      options.queue_segments = size;
      other.back_end = std::make_unique<BackEnd>(options, first);
    }
    others_.push_back(std::move(other));
  }
}

void BatchComparer::add(const KeyframeMessage& message, const Camera& first) {
  if (others_.empty()) startOthers(first);
  trajectory_.add(message.candidate);
  for (OtherSize& other : others_) {
    if (other.back_end) other.run.reports.push_back(other.back_end->process(message).report);
  }
}

void BatchComparer::add(const CalibrationReport& report) {
  // Another lens: what was seen through the old one does not belong to it.
  if (report.epoch != newest_.epoch) {
    trajectory_ = TrajectoryBatch();
    solved_ = 0;
    result_.present_lens = result_.batch.size();
    result_.changes = report.epoch;
  }
  newest_ = report;
  for (OtherSize& other : others_) {
    if (!other.back_end) other.run.reports.push_back(report);
  }
  const int interval = std::max(kInterval, static_cast<int>(kGrowth * solved_));
  if (report.covariance.size() > 0 && std::abs(trajectory_.keyframes() - solved_) >= interval) {
    solve();
  }
}

void BatchComparer::solve() {
  solved_ = trajectory_.keyframes();
  const int height = newest_.camera.height();
  const double readout_s = newest_.shutter.rolls ? newest_.shutter.readout_s : 0.0;
  trajectory_.setLineDelay(readout_s / rowSteps(height), height);
  BatchEstimate estimate = trajectory_.solve(newest_.camera, options_.solver_threads);
  estimate.keyframes = static_cast<int>(newest_.keyframes);  // on the run's own count
  result_.batch.push_back(estimate);
  result_.solved_keyframes = solved_;
}

BatchComparison BatchComparer::finish() {
  if (newest_.covariance.size() > 0 && trajectory_.keyframes() != solved_) solve();
  result_.sizes.clear();
  for (const OtherSize& other : others_) result_.sizes.push_back(other.run);
  return result_;
}

std::string batchText(const CalibrationReport& queue, const BatchComparison& comparison) {
  const BatchEstimate* batch = comparable(queue, comparison);
  if (batch == nullptr) return {};
  std::ostringstream text;
  text << "whole-trajectory batch: " << comparison.solved_keyframes << " keyframes, "
       << batch->observations << " observations" << (batch->converged ? "" : ", not converged")
       << '\n';
  if (comparison.changes > 0) {
    text << "  of the present lens alone: it changed " << comparison.changes
         << (comparison.changes == 1 ? " time" : " times") << " before\n";
  }
  text << std::fixed
       << "  parameter |        queue |      sigma |        batch |      sigma | difference\n";
  const std::vector<std::string> names = queue.camera.parameterNames();
  for (Eigen::Index i = 0; i < queue.covariance.rows(); ++i) {
    text << "  " << std::left << std::setw(9) << names[static_cast<std::size_t>(i)] << std::right
         << std::setprecision(5) << " | " << std::setw(12) << queue.camera.parameters()(i) << " | "
         << std::setw(10) << std::sqrt(queue.covariance(i, i)) << " | " << std::setw(12)
         << batch->camera.parameters()(i) << " | " << std::setw(10)
         << std::sqrt(batch->covariance(i, i)) << " | " << std::setprecision(2) << std::setw(5);
    const double difference = efficientDifference(queue, *batch, i);
    if (std::isfinite(difference)) {
      text << difference << " sigma\n";
    } else {
      text << "-\n";
    }
  }
  text << std::setprecision(3) << "  distance: " << pixelDistance(queue.camera, batch->camera).rms
       << " px rms\n";
  return text.str();
}

Json batchJson(const CalibrationReport& queue, const BatchComparison& comparison) {
  const BatchEstimate* batch = comparable(queue, comparison);
  if (batch == nullptr) return {};
  Json parameters = Json::object(), sigmas = Json::object(), differences = Json::object();
  const std::vector<std::string> names = queue.camera.parameterNames();
  for (Eigen::Index i = 0; i < queue.covariance.rows(); ++i) {
    const std::string& name = names[static_cast<std::size_t>(i)];
    parameters[name] = batch->camera.parameters()(i);
    sigmas[name] = std::sqrt(batch->covariance(i, i));
    differences[name] = efficientDifference(queue, *batch, i);
  }
  return {{"keyframes", comparison.solved_keyframes},
          {"epoch", comparison.changes},
          {"observations", batch->observations},
          {"params", parameters},
          {"sigma", sigmas},
          {"queue_minus_batch_sigmas", differences},
          {"pixel_uncertainty_rms", batch->uncertainty.rms},
          {"distance_px_rms", pixelDistance(queue.camera, batch->camera).rms}};
}

}  // namespace camera_self_calibration
