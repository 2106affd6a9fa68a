#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/tools/image_source.h"

namespace camera_self_calibration {
namespace {

// cv::CAP_PROP_ORIENTATION_META and _AUTO, which OpenCV has from 4.5 on; it turned nothing before.
constexpr int kOrientationInFile = 48;
constexpr int kTurnByOrientation = 49;

// Older ones tell the number of an image divided by the mean rate for its time.
constexpr bool kKnowsTimes = 100 * CV_VERSION_MAJOR + CV_VERSION_MINOR >= 406;

constexpr double kDefaultRateHz = 30.0;
constexpr std::int64_t kSlackNs = 1000;  // Of times that are counted in milliseconds.

std::int64_t toNs(double seconds) { return std::llround(1e9 * seconds); }

bool openSensorView(const std::string& path, cv::VideoCapture* video) {
  if (!video->open(path)) return false;
  // Rows stay the rows of the sensor: they are read out one after the other, and the calibration is
  // to be that of the camera.
  video->set(kTurnByOrientation, 0);
  return true;
}

/// Whether the times of the first images grow, as they do unless the file has none.
bool hasTimes(const std::string& path) {
  constexpr int kImages = 3;
  cv::VideoCapture video;
  double last_ms = -1.0;
  if (!kKnowsTimes || !openSensorView(path, &video)) return false;
  for (int i = 0; i < kImages && video.grab(); ++i) {
    const double now_ms = video.get(cv::CAP_PROP_POS_MSEC);
    if (!(now_ms > last_ms)) return false;
    last_ms = now_ms;
  }
  return true;
}

/// The images of a video one by one, with times that begin at 0.
class VideoReader {
 public:
  /// A rate of 0: the file's own times.
  VideoReader(const SourceOptions& options, double rate)
      : rate_(rate),
        begin_ns_(toNs(options.start_seconds) - kSlackNs),
        end_ns_(options.duration_seconds > 0.0
                    ? toNs(options.start_seconds + options.duration_seconds) - kSlackNs
                    : INT64_MAX) {
    openSensorView(options.path, &video_);
  }

  std::optional<GrayImage> next() {
    cv::Mat frame;
    std::int64_t stamp_ns = 0;
    do {
      if (!video_.read(frame)) return std::nullopt;
      stamp_ns = stamp();
      ++index_;
      if (stamp_ns >= end_ns_) return std::nullopt;
    } while (stamp_ns < begin_ns_);
    auto gray = std::make_shared<cv::Mat>();
    if (frame.channels() == 1) {
      *gray = frame.clone();
    } else {
      cv::cvtColor(frame, *gray, cv::COLOR_BGR2GRAY);
    }
    return GrayImage{ImageView{gray, gray->data, gray->cols, gray->rows,
                               static_cast<int>(gray->step[0]), stamp_ns},
                     {}};
  }

 private:
  std::int64_t stamp() {
    if (rate_ > 0.0) return toNs(static_cast<double>(index_) / rate_);
    const std::int64_t now_ns = toNs(1e-3 * video_.get(cv::CAP_PROP_POS_MSEC));
    if (index_ == 0) first_ns_ = now_ns;
    return now_ns - first_ns_;
  }

  cv::VideoCapture video_;
  const double rate_;
  const std::int64_t begin_ns_;
  const std::int64_t end_ns_;
  std::int64_t index_ = 0;
  std::int64_t first_ns_ = 0;
};

std::string timesText(const SourceOptions& options, double rate) {
  if (rate <= 0.0) return "The images have the times that stand in the video, from 0 on.";
  return formatted(
      options.rate > 0.0
          ? "The images are taken as %g Hz, from 0 s on, as --rate says."
          : "The images are taken as %g Hz, from 0 s on: the video holds no times that this OpenCV "
            "can read.",
      rate);
}

std::string orientationText(const cv::VideoCapture& video) {
  const double degrees = video.get(kOrientationInFile);
  if (!(degrees > 0.0)) return {};
  return formatted(
      " The video asks to be shown turned by %.0f degrees; the images stay as the sensor has them.",
      degrees);
}

/// Of the images to come; the count of a video is an estimate that serves for progress only.
std::int64_t countOf(const SourceOptions& options, double total, double rate) {
  double count = std::max(0.0, total - options.start_seconds * rate);
  if (options.duration_seconds > 0.0) count = std::min(count, options.duration_seconds * rate);
  return std::isfinite(count) ? std::llround(count) : 0;
}

}  // namespace

ImageSource openVideo(const SourceOptions& options) {
  // Every backend that cannot open a file would say so at length.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  cv::VideoCapture video;
  if (!openSensorView(options.path, &video)) {
    throw std::runtime_error(options.path +
                             " is neither a bag, nor a folder of images, nor a video that "
                             "this OpenCV can read");
  }
  const double own_rate = video.get(cv::CAP_PROP_FPS);
  const double usual_rate = options.rate > 0.0 ? options.rate
                            : own_rate > 0.0   ? own_rate
                                               : kDefaultRateHz;
  const double rate = options.rate > 0.0 || !hasTimes(options.path) ? usual_rate : 0.0;
  ImageSource source;
  source.name = options.path;
  source.count = countOf(options, video.get(cv::CAP_PROP_FRAME_COUNT), usual_rate);
  source.description = timesText(options, rate) + orientationText(video);
  const auto reader = std::make_shared<VideoReader>(options, rate);
  source.next = [reader] { return reader->next(); };
  return source;
}

}  // namespace camera_self_calibration
