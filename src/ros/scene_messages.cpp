#include "camera_self_calibration/ros/scene_messages.h"

#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/plotting/palette.h"
#include "camera_self_calibration/ros/messages.h"

namespace camera_self_calibration {
namespace {

using visualization_msgs::Marker;

// Sizes as shares of the scene's unit.
constexpr double kFrustum = 0.45;
constexpr double kWindowCamera = 0.08;
constexpr double kThin = 0.006;
constexpr double kDot = 0.018;
constexpr double kThick = 0.03;
constexpr double kLetters = 0.07;
constexpr int kRaysPerSide = 12;

geometry_msgs::Point toPoint(const Eigen::Vector3d& p) {
  geometry_msgs::Point message;
  message.x = p.x();
  message.y = p.y();
  message.z = p.z();
  return message;
}

std_msgs::ColorRGBA toColour(const Colour& bgr, double alpha = 1.0) {
  std_msgs::ColorRGBA colour;
  colour.r = static_cast<float>(bgr[2] / 255.0);
  colour.g = static_cast<float>(bgr[1] / 255.0);
  colour.b = static_cast<float>(bgr[0] / 255.0);
  colour.a = static_cast<float>(alpha);
  return colour;
}

/// For people who have not read the manual, and short: it stands in the scene.
std::string labelOf(const Event& event) {
  switch (event.type) {
    case EventType::kCalibrationChange:
      return formatted("the lens changed by %.2g px", event.magnitude_px);
    case EventType::kHandover:
      return "startup has ended";
    case EventType::kConverged:
      return "calibrated";
    case EventType::kLost:
      return "tracking lost";
    case EventType::kRelocalized:
      return "place recognised";
    case EventType::kInput:
      return "input: see /diagnostics";
    case EventType::kMountChanged:
      return "the mount changed";
    case EventType::kNoLongerConverged:
      return "no longer well calibrated";
  }
  return "";
}

/// Makes the markers of one scene.
class Painter {
 public:
  Painter(const Scene& scene, const std::string& frame, const ros::Time& stamp)
      : scene_(scene), rays_(fieldOfView(scene.report().camera, kRaysPerSide)) {
    header_.frame_id = frame;
    header_.stamp = stamp;
  }

  visualization_msgs::MarkerArray paint() const {
    visualization_msgs::MarkerArray array;
    array.markers = {trajectory(), keyframes(), window(), queue(), frustum(), view()};
    // rviz complains of lists without points.
    for (Marker& marker : array.markers) {
      if (marker.points.empty()) marker.action = Marker::DELETE;
    }
    for (std::size_t i = 0; i < Scene::kMaxEvents; ++i) array.markers.push_back(event(i));
    return array;
  }

 private:
  Marker empty(const char* name, int type, double size, const Colour& colour,
               double alpha = 1.0) const {
    Marker marker;
    marker.header = header_;
    marker.ns = name;
    marker.type = type;
    marker.pose.orientation.w = 1.0;
    marker.scale.x = marker.scale.y = marker.scale.z = size * scene_.unit();
    marker.color = toColour(colour, alpha);
    return marker;
  }

  Marker trajectory() const {
    Marker marker = empty("trajectory", Marker::LINE_STRIP, kThin, Colour(150, 140, 130), 0.9);
    addKeyframes(&marker);
    if (marker.points.size() < 2) marker.points.clear();
    return marker;
  }

  Marker keyframes() const {
    Marker marker = empty("keyframes", Marker::POINTS, kDot, Colour(230, 220, 210));
    addKeyframes(&marker);
    return marker;
  }

  void addKeyframes(Marker* marker) const {
    for (const auto& [id, keyframe] : scene_.keyframes()) {
      marker->points.push_back(toPoint(keyframe.world_from_camera.translation));
    }
  }

  /// The last keyframes as small pyramids.
  Marker window() const {
    Marker marker = empty("window", Marker::LINE_LIST, 0.6 * kThin, Colour(235, 225, 215), 0.8);
    const auto& all = scene_.keyframes();
    int left = Scene::kWindow;
    for (auto i = all.rbegin(); i != all.rend() && left > 0; ++i, --left) {
      addPyramid(i->second.world_from_camera, &marker);
    }
    return marker;
  }

  void addPyramid(const Rigid3& world_from_camera, Marker* marker) const {
    const double size = kWindowCamera * scene_.unit();
    for (std::size_t i = 0; i < rays_.size(); i += kRaysPerSide) {
      const std::size_t next = (i + kRaysPerSide) % rays_.size();
      const geometry_msgs::Point corner = toPoint(world_from_camera * (size * rays_[i]));
      marker->points.push_back(toPoint(world_from_camera.translation));
      marker->points.push_back(corner);
      marker->points.push_back(corner);
      marker->points.push_back(toPoint(world_from_camera * (size * rays_[next])));
    }
  }

  Marker queue() const {
    Marker marker = empty("queue", Marker::LINE_LIST, kThick, Colour(255, 255, 255));
    for (const Scene::QueueSegment& segment : scene_.queue()) {
      const std_msgs::ColorRGBA colour = toColour(scoreColour(segment.score));
      for (std::size_t i = 0; i + 1 < segment.positions.size(); ++i) {
        marker.points.push_back(toPoint(segment.positions[i]));
        marker.points.push_back(toPoint(segment.positions[i + 1]));
        marker.colors.insert(marker.colors.end(), 2, colour);
      }
    }
    return marker;
  }

  Marker atCamera(const char* name, int type, double size, double alpha) const {
    Marker marker = empty(name, type, size, stateColour(scene_.report().state), alpha);
    marker.pose = toPose(scene_.worldFromCamera());
    return marker;
  }

  /// Where a ray of the field of view ends.
  geometry_msgs::Point end(std::size_t i) const {
    return toPoint(kFrustum * scene_.unit() * rays_[i % rays_.size()]);
  }

  Marker frustum() const {
    Marker marker = atCamera("frustum", Marker::LINE_LIST, 1.5 * kThin, 1.0);
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      marker.points.push_back(end(i));
      marker.points.push_back(end(i + 1));
      if (i % kRaysPerSide != 0) continue;
      marker.points.push_back(geometry_msgs::Point());
      marker.points.push_back(end(i));
    }
    return marker;
  }

  Marker view() const {
    Marker marker = atCamera("view", Marker::TRIANGLE_LIST, 1.0, 0.22);
    marker.scale.x = marker.scale.y = marker.scale.z = 1.0;
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      marker.points.push_back(geometry_msgs::Point());
      marker.points.push_back(end(i));
      marker.points.push_back(end(i + 1));
    }
    return marker;
  }

  /// One above the other where they happened at the same place.
  Marker event(std::size_t i) const {
    Marker marker = empty("events", Marker::TEXT_VIEW_FACING, kLetters, Colour());
    marker.id = static_cast<int>(i);
    const auto& events = scene_.events();
    if (i >= events.size()) {
      marker.action = Marker::DELETE;
      return marker;
    }
    const double line = 1.3 * kLetters * scene_.unit();
    int lines = 1;
    for (std::size_t earlier = 0; earlier < i; ++earlier) {
      lines += (events[earlier].position - events[i].position).norm() < 4.0 * line;
    }
    marker.color = toColour(eventColour(events[i].event.type));
    marker.text = labelOf(events[i].event);
    // The world's y points down.
    const Eigen::Vector3d above(0.0, -lines * line, 0.0);
    marker.pose.position = toPoint(events[i].position + above);
    return marker;
  }

  const Scene& scene_;
  const std::vector<Eigen::Vector3d> rays_;
  std_msgs::Header header_;
};

/// The colour of a landmark in the cloud: its brightness in the image, never too dark to be seen.
std::uint8_t shade(int brightness, double tint) {
  const double value = brightness < 0 ? 160.0 : 70.0 + 185.0 * brightness / 255.0;
  return static_cast<std::uint8_t>(std::min(255.0, tint * value));
}

}  // namespace

visualization_msgs::MarkerArray toMarkers(const Scene& scene, const std::string& world_frame,
                                          const ros::Time& stamp) {
  return Painter(scene, world_frame, stamp).paint();
}

sensor_msgs::PointCloud2 toCloud(const Scene& scene, const std::string& world_frame,
                                 const ros::Time& stamp) {
  sensor_msgs::PointCloud2 cloud;
  cloud.header.frame_id = world_frame;
  cloud.header.stamp = stamp;
  sensor_msgs::PointCloud2Modifier modifier(cloud);
  modifier.setPointCloud2FieldsByString(2, "xyz", "rgb");
  modifier.resize(scene.landmarks().size());
  sensor_msgs::PointCloud2Iterator<float> x(cloud, "x");
  sensor_msgs::PointCloud2Iterator<std::uint8_t> b(cloud, "b");
  for (const auto& [id, point] : scene.landmarks()) {
    for (int i = 0; i < 3; ++i) x[i] = static_cast<float>(point.position[i]);
    b[0] = shade(point.brightness, 0.78);
    b[1] = shade(point.brightness, 0.9);
    b[2] = shade(point.brightness, 1.0);
    ++x;
    ++b;
  }
  return cloud;
}

}  // namespace camera_self_calibration
