#include "camera_self_calibration/ros/visualizer.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/PointCloud2.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/plotting/convergence_chart.h"
#include "camera_self_calibration/ros/scene_messages.h"
#include "camera_self_calibration/ros/stamps.h"

namespace camera_self_calibration {
namespace {

constexpr std::chrono::milliseconds kPeriod(100);
// The chart is drawn in every fifth period.
constexpr int kChartPeriods = 5;
// Images between the camera and the pipeline's result.
constexpr std::size_t kMaxImages = 8;
// How long an event stands on the image [s].
constexpr double kNewsS = 15.0;

sensor_msgs::ImagePtr toImage(const cv::Mat& bgr, const std::string& frame, std::int64_t stamp_ns) {
  std_msgs::Header header;
  header.frame_id = frame;
  header.stamp = toRosTime(stamp_ns);
  return cv_bridge::CvImage(header, "bgr8", bgr).toImageMsg();
}

Colour trackingColour(TrackingState state) {
  return stateColour(state == TrackingState::kTracking ? CalibrationState::kConverged
                     : state == TrackingState::kLost   ? CalibrationState::kDegenerate
                                                       : CalibrationState::kInitializing);
}

}  // namespace

Visualizer::Visualizer(const ros::NodeHandle& private_node, const NodeOptions& options)
    : world_frame_(options.world_frame), pipeline_(options.pipeline) {
  ros::NodeHandle node(private_node);
  constexpr std::uint32_t kQueue = 2;
  markers_.publisher = node.advertise<visualization_msgs::MarkerArray>("markers", kQueue);
  cloud_.publisher = node.advertise<sensor_msgs::PointCloud2>("landmarks", kQueue);
  tracks_.publisher = node.advertise<sensor_msgs::Image>("track_image", kQueue);
  chart_.publisher = node.advertise<sensor_msgs::Image>("convergence", kQueue);
  thread_ = std::thread([this] { run(); });
}

Visualizer::~Visualizer() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void Visualizer::add(const ImageView& image, const std::string& frame_id) {
  if (!tracks_.heard && !cloud_.heard) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  image_frame_ = frame_id;
  images_.push_back(image);
  if (images_.size() > kMaxImages) images_.pop_front();
}

void Visualizer::add(const FrameResult& frame) {
  const std::lock_guard<std::mutex> lock(mutex_);
  stamp_ns_ = frame.stamp_ns;
  scene_.add(frame);
  markers_.changed = true;
  if (!tracks_.heard) {
    trails_.clear();
    return;
  }
  trails_.add(frame.tracks);
  const ImageView* image = imageOf(frame.stamp_ns);
  if (image == nullptr) return;
  picture_ = Picture{*image, frame};
  tracks_.changed = true;
}

void Visualizer::add(std::uint64_t map_id, const Camera& camera, const Segment& newest) {
  const std::lock_guard<std::mutex> lock(mutex_);
  scene_.add(map_id, newest);
  if (!cloud_.heard) return;
  scene_.addLandmarks(camera, newest, imageOf(newest.endNs()));
  cloud_.changed = true;
}

void Visualizer::add(const CalibrationReport& report) {
  const std::lock_guard<std::mutex> lock(mutex_);
  scene_.add(report);
  history_.add(report);
  chart_.changed = true;
}

void Visualizer::add(const Event& event) {
  const std::lock_guard<std::mutex> lock(mutex_);
  scene_.add(event);
  newest_event_ = event;
  markers_.changed = true;
}

Visualizer::Counts Visualizer::counts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return counts_;
}

const ImageView* Visualizer::imageOf(std::int64_t stamp_ns) const {
  for (const ImageView& image : images_) {
    if (image.stamp_ns == stamp_ns) return &image;
  }
  return nullptr;
}

void Visualizer::run() {
  for (int period = 0;; ++period) {
    {
      std::unique_lock<std::mutex> lock(mutex_);
      if (wake_.wait_for(lock, kPeriod, [this] { return stop_; })) return;
      if (!tracks_.heard && !cloud_.heard) images_.clear();
    }
    if (isDue(&markers_)) publishMarkers();
    if (isDue(&cloud_)) publishCloud();
    if (isDue(&tracks_)) publishTracks();
    if (period % kChartPeriods == 0 && isDue(&chart_)) publishChart();
  }
}

/// Somebody hears the topic, and either there is news or that somebody is new.
bool Visualizer::isDue(Topic* topic) {
  const std::uint32_t subscribers = topic->publisher.getNumSubscribers();
  const bool newcomer = subscribers > topic->subscribers;
  topic->subscribers = subscribers;
  topic->heard = subscribers > 0;
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool due = topic->heard && (topic->changed || newcomer);
  if (due) topic->changed = false;
  return due;
}

void Visualizer::publishMarkers() {
  visualization_msgs::MarkerArray message;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    message = toMarkers(scene_, world_frame_, toRosTime(stamp_ns_));
    ++counts_.markers;
  }
  markers_.publisher.publish(message);
}

void Visualizer::publishCloud() {
  sensor_msgs::PointCloud2 message;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    message = toCloud(scene_, world_frame_, toRosTime(stamp_ns_));
    ++counts_.clouds;
  }
  cloud_.publisher.publish(message);
}

void Visualizer::publishTracks() {
  std::optional<Picture> picture;
  TrackTrails trails;
  std::vector<Caption> words;
  std::string frame;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!picture_) return;
    picture.swap(picture_);
    trails = trails_;
    words = captions(picture->frame);
    frame = image_frame_;
    ++counts_.track_images;
  }
  const ImageView& image = picture->image;
  // OpenCV takes no pointer to constant data; drawTracks() does not write to it.
  const cv::Mat gray(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                     static_cast<std::size_t>(image.stride));
  tracks_.publisher.publish(toImage(drawTracks(gray, trails, words), frame, image.stamp_ns));
}

std::vector<Caption> Visualizer::captions(const FrameResult& frame) const {
  const CalibrationReport& report = scene_.report();
  std::string calibration = toString(report.state);
  if (report.covariance.size() > 0 && std::isfinite(report.uncertainty.rms)) {
    calibration += formatted(", expected error %.2g px", report.uncertainty.rms);
    const std::string checks = checksInWords(report);
    if (!checks.empty()) calibration += "; " + checks;
  }
  std::vector<Caption> all = {
      {trackingColour(frame.state), toString(frame.state) + ", " + frame.sentence},
      {stateColour(report.state), calibration}};
  if (const auto news = newsAt(frame.stamp_ns)) all.push_back(*news);
  return all;
}

/// The newest event, unless it is long ago.
std::optional<Caption> Visualizer::newsAt(std::int64_t stamp_ns) const {
  if (!newest_event_) return std::nullopt;
  const double ago = toSeconds(stamp_ns - newest_event_->stamp_ns);
  if (!(std::abs(ago) < kNewsS)) return std::nullopt;
  const std::string when = formatted(", %.0f s ago: ", std::max(0.0, ago));
  return Caption{eventColour(newest_event_->type),
                 toString(newest_event_->type) + when + newest_event_->sentence};
}

void Visualizer::publishChart() {
  ConvergenceHistory history;
  ConvergenceStyle style;
  std::string frame;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    history = history_;
    frame = image_frame_;
    ++counts_.charts;
  }
  style.theme = Theme::kDark;
  style.width = 640;
  style.height = 500;
  std::int64_t stamp_ns = 0;
  if (!history.empty()) {
    stamp_ns = history.latest().stamp_ns;
    style.threshold_px = pipeline_.convergedRms(history.latest().camera);
  }
  chart_.publisher.publish(toImage(drawConvergence(history, style), frame, stamp_ns));
}

}  // namespace camera_self_calibration
