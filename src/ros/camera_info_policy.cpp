#include "camera_self_calibration/ros/camera_info_policy.h"

#include <cmath>
#include <utility>

#include "camera_self_calibration/base/formatted.h"

namespace camera_self_calibration {
namespace {

// A difference counts from so many standard deviations on.
constexpr double kSignificant = 3.0;

std::string joined(const std::string& a, const std::string& b) {
  return a + (a.empty() || b.empty() ? "" : " ") + b;
}

bool isSame(const Camera& a, const Camera& b) {
  return a.model() == b.model() && a.width() == b.width() && a.height() == b.height() &&
         a.parameters() == b.parameters();
}

}  // namespace

Event withCameraInfo(Event event, const CameraInfoState& info) {
  if (event.type == EventType::kNoLongerConverged && info.last_good) {
    event.sentence += "; camera_info goes on with the last good calibration";
  }
  return event;
}

bool CameraInfoPolicy::usable(const CalibrationReport& report) const {
  if (report.state == CalibrationState::kConverged) return true;
  const bool estimated = report.covariance.rows() > 0 && std::isfinite(report.uncertainty.rms);
  return options_.publish_uncalibrated && estimated &&
         report.state != CalibrationState::kDegenerate;
}

// Until there is an estimate of this image size, what is known from another one stays.
bool CameraInfoPolicy::keeps(const CalibrationReport& report) {
  if (!inherited_) return false;
  // A reset begins with a smaller one.
  if (!inherited_epoch_known_ || report.epoch < inherited_epoch_) inherited_epoch_ = report.epoch;
  inherited_epoch_known_ = true;
  return report.epoch == inherited_epoch_;
}

// A reset without a saved state starts before hand-over, a change of the lens begins an epoch.
bool CameraInfoPolicy::lastGoodHolds(const CalibrationReport& report) const {
  return published_ && good_epoch_ == report.epoch && report.handed_over &&
         camera_->width() == report.camera.width() && camera_->height() == report.camera.height();
}

std::string CameraInfoPolicy::update(const CalibrationReport& report) {
  const std::string refuted = forgetRefuted(report);
  return joined(refuted, follow(report));
}

// What goes out may have been given anew since the report was made: a start that was given up
// refutes itself, and no other.
std::string CameraInfoPolicy::forgetRefuted(const CalibrationReport& report) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool news =
      report.starts_given_up != std::exchange(starts_given_up_, report.starts_given_up);
  if (!news || !inherited_ || !report.start_given_up || !isSame(*report.start_given_up, *camera_)) {
    return {};
  }
  const std::string which = given_ ? "that set_camera_info brought" : "known from earlier images";
  if (fixed_ && fixed_->K == published_->info.K) fixed_.reset();
  withdraw();
  return "The calibration " + which +
         " is no longer published as camera_info: it cannot be right, since map after map was lost "
         "with it. camera_info is zero until the images have given one.";
}

void CameraInfoPolicy::withdraw() {
  good_epoch_.reset();
  camera_.reset();
  published_.reset();
  inherited_ = given_ = false;
  warning_.clear();
}

std::string CameraInfoPolicy::follow(const CalibrationReport& report) {
  const bool converged = report.state == CalibrationState::kConverged;
  std::string judged;
  std::uint64_t orders = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (awaits_beginning_ && converged) return {};
    awaits_beginning_ = false;
    const bool kept = keeps(report);
    if (kept && !converged) return {};
    last_good_ = !converged && lastGoodHolds(report);
    if (last_good_) return {};
    if (!usable(report)) {
      withdraw();
      return {};
    }
    good_epoch_ = converged ? std::optional<std::uint64_t>(report.epoch) : std::nullopt;
    const bool same = camera_ && camera_->width() == report.camera.width() &&
                      camera_->height() == report.camera.height();
    if (same && !(pixelDistance(*camera_, report.camera).rms > min_change_px_)) {
      inherited_ = given_ = false;
      return {};
    }
    judged = judgement(report);
    orders = orders_;
  }
  const std::optional<std::string> warning = publish(report.camera, converged, orders);
  return warning ? joined(judged, *warning) : "";
}

// Of a calibration that was given, by the first estimate that the images gave.
std::string CameraInfoPolicy::judgement(const CalibrationReport& report) const {
  if (!given_) return {};
  const double distance = pixelDistance(*camera_, report.camera).rms;
  if (distance <= kSignificant * report.uncertainty.rms) return {};
  return formatted(
      "The calibration that set_camera_info brought is off by %.2f px rms, as the images show "
      "(they know the lens to %.2f px); their own estimate takes its place.",
      distance, report.uncertainty.rms);
}

void CameraInfoPolicy::accept(const Camera& camera, const sensor_msgs::CameraInfo& info) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++orders_;
  camera_ = camera;
  forgetLastGood();
  published_ = CameraInfoConversion{info, {}};
  warning_.clear();
  if (options_.fixed_projection) fixed_ = info;
  inherited_ = given_ = awaits_beginning_ = true;
  inherited_epoch_known_ = false;
}

void CameraInfoPolicy::forgetLastGood() {
  good_epoch_.reset();
  last_good_ = false;
}

void CameraInfoPolicy::forget() {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++orders_;
  inherited_ = given_ = awaits_beginning_ = false;
}

void CameraInfoPolicy::inherit(const Camera& camera) {
  if (!publish(camera, true, orders_)) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  inherited_ = published_.has_value();
  forgetLastGood();
  awaits_beginning_ = false;
  inherited_epoch_known_ = false;
}

// Unlocked while it fits, since images must not wait. What was ordered meanwhile, after `orders`,
// stays: then there is no warning, not even an empty one.
std::optional<std::string> CameraInfoPolicy::publish(const Camera& camera, bool converged,
                                                     std::uint64_t orders) {
  std::optional<CameraInfoConversion> conversion = toCameraInfo(camera, options_.model);
  std::string warning;
  if (!conversion || !std::isfinite(conversion->error.max)) {
    warning = "The " + toString(camera.model()) +
              " lens cannot be expressed in the distortion model of camera_info over the whole "
              "image, so that camera_info stays zero: " +
              remedy(camera) + ".";
    conversion.reset();
  } else if (conversion->error.max > kConversionWarning) {
    warning = formatted(
        "The published camera_info (%s) deviates from the estimated lens by up to %.2f px. To have "
        "it closer, %s.",
        conversion->info.distortion_model.c_str(), conversion->error.max, remedy(camera).c_str());
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (orders != orders_) return std::nullopt;
  if (conversion) setProjection(converged, &conversion->info);
  camera_ = camera;
  warning_ = warning;
  published_ = std::move(conversion);
  inherited_ = given_ = false;
  return warning;
}

// auto writes what is closest: equidistant for a fov lens, and all others exactly.
std::string CameraInfoPolicy::remedy(const Camera& camera) const {
  const bool closest =
      options_.model == OutputModel::kAuto ||
      (options_.model == OutputModel::kEquidistant && camera.model() == CameraModel::kFov);
  return closest ? "set the parameter model to equidistant"
                 : "set the parameter output_distortion_model to auto";
}

void CameraInfoPolicy::setProjection(bool converged, sensor_msgs::CameraInfo* info) {
  if (!options_.fixed_projection) return;
  if (fixed_ && fixed_->width == info->width && fixed_->height == info->height) {
    info->P = fixed_->P;
  } else if (converged) {
    fixed_ = *info;
  }
}

std::optional<Camera> CameraInfoPolicy::published() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return published_ ? camera_ : std::nullopt;
}

sensor_msgs::CameraInfo CameraInfoPolicy::infoFor(const std_msgs::Header& header, int width,
                                                  int height) const {
  sensor_msgs::CameraInfo info = uncalibratedCameraInfo(width, height);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (published_ && camera_->width() == width && camera_->height() == height) {
      info = published_->info;
    }
  }
  info.header = header;
  return info;
}

CameraInfoState CameraInfoPolicy::state() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  CameraInfoState state;
  if (!published_) {
    state.obstacle = warning_;
    return state;
  }
  state.deviation = warning_;
  state.distortion_model = published_->info.distortion_model;
  state.error = published_->error;
  state.inherited = inherited_ && !given_;
  state.given = given_;
  state.last_good = last_good_;
  return state;
}

}  // namespace camera_self_calibration
