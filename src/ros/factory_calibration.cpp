#include "camera_self_calibration/ros/factory_calibration.h"

#include <cmath>
#include <utility>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/fit.h"
#include "camera_self_calibration/camera/plausibility.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "camera_self_calibration/ros/model_conversion.h"

namespace camera_self_calibration {
namespace {

bool sameCalibration(const sensor_msgs::CameraInfo& a, const sensor_msgs::CameraInfo& b) {
  return a.width == b.width && a.height == b.height && a.K == b.K && a.D == b.D &&
         a.distortion_model == b.distortion_model && a.binning_x == b.binning_x &&
         a.binning_y == b.binning_y && a.roi.x_offset == b.roi.x_offset &&
         a.roi.y_offset == b.roi.y_offset && a.roi.width == b.roi.width &&
         a.roi.height == b.roi.height;
}

AuditOptions withTolerance(double tolerance_px) {
  AuditOptions options;
  options.tolerance_px = tolerance_px;
  return options;
}

std::string sentenceOf(const AuditReport& audit) {
  std::string sentence = toString(audit.verdict) + ": " + asSentence(audit.sentence());
  if (audit.verdict == AuditVerdict::kWrong) {
    sentence += " Commit the live calibration to the driver, or calibrate again.";
  }
  if (!audit.hint.empty()) sentence += " " + asSentence(audit.hint);
  return sentence;
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

FactoryCalibration::FactoryCalibration(std::string topic, double tolerance_px)
    : topic_(std::move(topic)), options_(withTolerance(tolerance_px)) {
  judge();
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
  history_ = AuditHistory();
  judge();
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
  if (news) judge();
}

FactoryAudit FactoryCalibration::audit() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return audit_;
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
  const std::optional<Camera> factory = read(model, problem);
  if (!factory) return std::nullopt;
  if (factory->width() != width || factory->height() != height) {
    *problem = "The factory calibration on " + topic_ + " is for images of " +
               sizeText(factory->width(), factory->height()) + ", but they are " +
               sizeText(width, height) + ".";
    return std::nullopt;
  }
  const std::string implausible = implausibility(*factory);
  if (!implausible.empty()) {
    *problem = "The factory calibration on " + topic_ + " cannot be right: " + implausible + ".";
    return std::nullopt;
  }
  const CameraModel wanted = model.value_or(factory->model());
  const std::optional<Camera> start = asStart(*factory, wanted);
  *problem = start ? ""
                   : "The factory calibration on " + topic_ + " cannot be expressed in the model " +
                         toString(wanted) + " over the whole image.";
  return start;
}

// Says in `problem` why there is none.
std::optional<Camera> FactoryCalibration::read(std::optional<CameraModel> model,
                                               std::string* problem) const {
  if (!newest_) {
    *problem = "No factory calibration has come on " + topic_ +
               ": does the camera's driver publish a CameraInfo, and is the name right?";
    return std::nullopt;
  }
  const std::optional<Camera> camera = toWindowedCamera(*newest_, model);
  if (!camera) {
    *problem = "The factory calibration on " + topic_ + " is not used: " +
               (toCamera(*newest_, model) ? "its region of interest does not lie on the sensor"
                                          : whyNoStart(*newest_, model)) +
               ".";
  }
  return camera;
}

void FactoryCalibration::judge() {
  audit_ = FactoryAudit();
  const Camera& live = report_.camera;
  const auto model = live.width() > 0 ? std::optional(live.model()) : std::nullopt;
  const std::optional<Camera> factory = read(model, &audit_.sentence);
  if (!factory) return;
  audit_.usable = true;
  audit_.audit = camera_self_calibration::audit(*factory, report_, options_);
  history_.date(report_, &audit_.audit);
  audit_.sentence = sentenceOf(audit_.audit);
}

}  // namespace camera_self_calibration
