#include "camera_self_calibration/tools/example_image.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/camera/field_of_view.h"

namespace camera_self_calibration {
namespace {

constexpr double kWidest = 120.0;  // of an undistorted image [deg]

// Turns the optical axis to what the middle of the image shows.
Eigen::Quaterniond towardsMiddle(const Camera& camera) {
  const auto middle = camera.unproject({0.5 * (camera.width() - 1), 0.5 * (camera.height() - 1)});
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(),
                                            middle.value_or(Eigen::Vector3d::UnitZ()));
}

}  // namespace

void ExampleFinder::add(const ImageView& image, const FrameResult& frame, std::uint64_t epoch) {
  trails_.add(frame.tracks);
  const bool better = epoch != epoch_ || trails_.trails().size() > found_.trails.trails().size();
  if (!better || frame.tracks.tracks.empty()) return;
  epoch_ = epoch;
  const cv::Mat view(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                     static_cast<std::size_t>(image.stride));
  view.copyTo(found_.gray);
  found_.stamp_ns = image.stamp_ns;
  found_.trails = trails_;
}

cv::Mat undistorted(const cv::Mat& gray, const Camera& camera) {
  if (!camera.valid() || gray.empty()) return {};
  const double horizontal = fieldOfView(camera).horizontal;
  const double width = std::isfinite(horizontal) ? std::min(horizontal, kWidest) : kWidest;
  const double focal = 0.5 * (gray.cols - 1) / std::tan(0.5 * width * kDegree);
  const Eigen::Quaterniond camera_from_view = towardsMiddle(camera);
  cv::Mat x(gray.size(), CV_32FC1), y(gray.size(), CV_32FC1);
  for (int row = 0; row < gray.rows; ++row) {
    for (int column = 0; column < gray.cols; ++column) {
      const Eigen::Vector3d ray((column - 0.5 * (gray.cols - 1)) / focal,
                                (row - 0.5 * (gray.rows - 1)) / focal, 1.0);
      Eigen::Vector2d pixel;
      const bool seen = camera.project(camera_from_view * ray, &pixel);
      x.at<float>(row, column) = seen ? static_cast<float>(pixel.x()) : -1e4f;
      y.at<float>(row, column) = seen ? static_cast<float>(pixel.y()) : -1e4f;
    }
  }
  cv::Mat result;
  cv::remap(gray, result, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return result;
}

}  // namespace camera_self_calibration
