#include "camera_self_calibration/pipeline/self_calibrator.h"

#include <stdexcept>
#include <utility>

#include "camera_self_calibration/camera/plausibility.h"
#include "self_calibrator_impl.h"

namespace camera_self_calibration {

SelfCalibrator::SelfCalibrator(const Options& options, Mode mode, Callbacks callbacks)
    : impl_(std::make_unique<Impl>(options, mode, std::move(callbacks))) {}

SelfCalibrator::~SelfCalibrator() = default;

bool SelfCalibrator::process(const ImageView& image) {
  impl_->checkSource(true);
  if (impl_->mode != Mode::kThreaded) {
    impl_->processImage(image);
    return true;
  }
  const bool kept_all = impl_->images.push(image);
  if (!kept_all) ++impl_->dropped;
  return kept_all;
}

void SelfCalibrator::processTracks(const TrackedFrame& frame,
                                   const std::function<std::vector<Track>()>& detect,
                                   const Describe& describe) {
  impl_->checkSource(false);
  if (!impl_->accept(frame)) return;
  impl_->processFrame(frame, ImageView(), detect, describe, std::chrono::steady_clock::now());
}

void SelfCalibrator::resetTracking() { impl_->requests.resetTracking(); }

void SelfCalibrator::reset() { impl_->requests.restart({}); }

void SelfCalibrator::reset(const Camera& start) {
  const std::optional<CameraModel>& model = impl_->options.model;
  if (!start.valid() || (model && start.model() != *model) || start.width() <= 0 ||
      start.height() <= 0) {
    throw std::invalid_argument("the start must be a valid camera" +
                                (model ? " of the model " + toString(*model) : ""));
  }
  const std::string problem = implausibility(start);
  if (!problem.empty()) throw std::invalid_argument("the start cannot be right: " + problem);
  impl_->requests.restart({start, nullptr});
}

void SelfCalibrator::restore(const std::shared_ptr<const LearntState>& state) {
  if (!state) throw std::invalid_argument("there is no state");
  for (const std::string& problem : state->problems()) throw std::invalid_argument(problem);
  const std::optional<CameraModel>& model = impl_->options.model;
  if (model && state->camera.model() != *model) {
    throw std::invalid_argument("it is of the model " + toString(state->camera.model()) + ", not " +
                                toString(*model));
  }
  impl_->requests.restart({std::nullopt, state});
}

std::shared_ptr<const LearntState> SelfCalibrator::state() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->learnt;
}

bool SelfCalibrator::freeze(bool frozen) {
  if (frozen && !calibration().handed_over) return false;
  impl_->frozen = frozen;
  return true;
}

bool SelfCalibrator::setScale(double factor) {
  if (!isScaleFactor(factor) || !impl_->tracking) return false;
  impl_->requests.scale(factor);
  return true;
}

bool SelfCalibrator::isScaleFactor(double factor) { return factor >= 1e-6 && factor <= 1e6; }

void SelfCalibrator::flush() {
  impl_->deliverPending();
  if (impl_->mode != Mode::kThreaded) return;
  impl_->images.waitUntilIdle();
  impl_->keyframes.waitUntilIdle();
}

CalibrationReport SelfCalibrator::calibration() const {
  std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->report;
}

std::int64_t SelfCalibrator::droppedImages() const { return impl_->dropped; }

}  // namespace camera_self_calibration
