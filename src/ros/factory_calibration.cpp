#include "camera_self_calibration/ros/factory_calibration.h"

#include <cmath>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/camera/plausibility.h"
#include "camera_self_calibration/ros/camera_info.h"

namespace camera_self_calibration {
namespace {

// A difference counts from so many standard deviations of the live calibration on.
constexpr double kSignificant = 3.0;

bool sameCalibration(const sensor_msgs::CameraInfo& a, const sensor_msgs::CameraInfo& b) {
  return a.width == b.width && a.height == b.height && a.K == b.K && a.D == b.D &&
         a.distortion_model == b.distortion_model && a.binning_x == b.binning_x &&
         a.binning_y == b.binning_y && a.roi.x_offset == b.roi.x_offset &&
         a.roi.y_offset == b.roi.y_offset && a.roi.width == b.roi.width &&
         a.roi.height == b.roi.height;
}

std::string describe(const PixelError& distance, const PixelError& uncertainty) {
  return formatted("%.2f px rms (max %.2f px), with the live one good to %.2f px rms", distance.rms,
                   distance.max, uncertainty.rms);
}

/// In the model to estimate, where an estimate can start.
std::optional<Camera> asStart(const Camera& factory, CameraModel model) {
  const std::optional<CameraFit> fit = fitCamera(factory, model);
  // A start that cannot project the whole image would later pass for a change of the lens.
  if (!fit || !std::isfinite(fit->error.max) || !implausibility(fit->camera).empty()) {
    return std::nullopt;
  }
  return withLeastFovW(fit->camera);
}

}  // namespace

FactoryCalibration::FactoryCalibration(std::string topic, double warn_px)
    : topic_(std::move(topic)), warn_px_(warn_px) {
  compare();
}

void FactoryCalibration::subscribe(ros::NodeHandle node) {
  constexpr std::uint32_t kQueue = 2;
  subscriber_ = node.subscribe<sensor_msgs::CameraInfo>(
      topic_, kQueue, [this](const sensor_msgs::CameraInfo::ConstPtr& info) { take(*info); });
}

void FactoryCalibration::shutdown() { subscriber_.shutdown(); }

void FactoryCalibration::take(const sensor_msgs::CameraInfo& info) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (newest_ && sameCalibration(*newest_, info)) return;
  newest_ = info;
  compare();
}

bool FactoryCalibration::heard() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return newest_.has_value();
}

void FactoryCalibration::update(const CalibrationReport& report) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool news = report.revision != report_.revision || report.state != report_.state ||
                    report.camera.width() != report_.camera.width();
  report_ = report;
  if (news) compare();
}

FactoryComparison FactoryCalibration::comparison() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return comparison_;
}

std::optional<SensorWindow> FactoryCalibration::windowFor(int width, int height) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto window = newest_ ? sensorWindow(*newest_) : std::nullopt;
  const bool fits = window && window->imageWidth() == width && window->imageHeight() == height;
  return fits ? window : std::nullopt;
}

std::optional<Camera> FactoryCalibration::startFor(std::optional<CameraModel> model, int width,
                                                   int height, std::string* problem) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  FactoryComparison result;
  const std::optional<Camera> factory = cameraFor(model, width, height, &result);
  const std::string implausible = factory ? implausibility(*factory) : "";
  if (!implausible.empty()) {
    *problem = "The factory calibration on " + topic_ + " cannot be right: " + implausible + ".";
    return std::nullopt;
  }
  const std::optional<Camera> start =
      factory ? asStart(*factory, model.value_or(factory->model())) : std::nullopt;
  *problem = factory && !start
                 ? "the factory calibration on " + topic_ + " cannot be expressed as " +
                       toString(model.value_or(factory->model()))
                 : result.sentence;
  return start;
}

// Says in `result` why there is none.
std::optional<Camera> FactoryCalibration::cameraFor(std::optional<CameraModel> model, int width,
                                                    int height, FactoryComparison* result) const {
  if (!newest_) {
    *result = {FactoryVerdict::kNoMessage,
               "No factory calibration has come on " + topic_ +
                   ": does the camera's driver publish a CameraInfo, and is the name right?",
               {}};
    return std::nullopt;
  }
  if (!(newest_->K[0] > 0.0)) {
    *result = {FactoryVerdict::kUncalibrated,
               "The factory calibration on " + topic_ + " is empty: its K is zero.",
               {}};
    return std::nullopt;
  }
  const std::optional<Camera> camera = toWindowedCamera(*newest_, model);
  if (!camera) {
    *result = {FactoryVerdict::kUnusable,
               "The factory calibration on " + topic_ +
                   " cannot be read: its distortion model is '" + newest_->distortion_model +
                   "' with " + std::to_string(newest_->D.size()) + " coefficients.",
               {}};
    return std::nullopt;
  }
  if (camera->width() == width && camera->height() == height) return camera;
  *result = {FactoryVerdict::kUnusable,
             "The factory calibration on " + topic_ + " is for images of " +
                 sizeText(camera->width(), camera->height()) + ", but they are " +
                 sizeText(width, height) + ".",
             {}};
  return std::nullopt;
}

void FactoryCalibration::compare() {
  FactoryComparison result;
  const Camera& live = report_.camera;
  if (newest_ && live.width() == 0) {
    comparison_ = {FactoryVerdict::kWaiting, "A factory calibration has come; no image yet.", {}};
    return;
  }
  const std::optional<Camera> factory =
      cameraFor(live.model(), live.width(), live.height(), &result);
  if (factory && report_.state != CalibrationState::kConverged) {
    result = {FactoryVerdict::kWaiting,
              "The factory calibration will be compared when the live one has CONVERGED.",
              {}};
  } else if (factory) {
    result.distance = pixelDistance(live, *factory);
    const double significant = kSignificant * report_.uncertainty.rms;
    const bool differs = result.distance.rms > warn_px_ && !(result.distance.rms <= significant);
    result.verdict = differs ? FactoryVerdict::kDiffers : FactoryVerdict::kAgrees;
    const std::string figures = describe(result.distance, report_.uncertainty);
    result.sentence =
        differs
            ? "The factory calibration is off by " + figures +
                  ": the lens was changed or moved, or it never fitted. Commit the live "
                  "calibration to the driver, or calibrate again."
            : "The factory calibration agrees with the live one: they differ by " + figures + ".";
  }
  comparison_ = result;
}

}  // namespace camera_self_calibration
