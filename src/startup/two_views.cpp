#include "two_views.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "camera_self_calibration/map/inverse_depth.h"

namespace camera_self_calibration {
namespace {

constexpr double kConfidence = 0.999;
constexpr int kFewest = 8;
// In baselines: no limit. OpenCV's own, 50, leaves out most of what neighbouring keyframes see.
constexpr double kFarthest = 1e6;
// Of a unit ray: 78 degrees off the axis, beyond which noise on a plane grows without bound.
constexpr double kMinZ = 0.2;

cv::Point2d onPlane(const Eigen::Vector3d& ray) { return {ray.x() / ray.z(), ray.y() / ray.z()}; }

double inverseDepth(const RayPair& pair, const Rigid3& second_from_first) {
  RayIntersection rays;
  rays.add(pair.second, second_from_first.rotation * pair.first, second_from_first.translation);
  return rays.inverseDepth();
}

Rigid3 poseOf(const cv::Mat& rotation, const cv::Mat& translation) {
  Eigen::Matrix3d r;
  Eigen::Vector3d t;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) r(i, j) = rotation.at<double>(i, j);
    t(i) = translation.at<double>(i);
  }
  return {Eigen::Quaterniond(r).normalized(), t.normalized()};
}

}  // namespace

std::optional<TwoViews> relateViews(const std::vector<RayPair>& pairs, double tolerance) {
  std::vector<cv::Point2d> first, second;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].first.z() < kMinZ || pairs[i].second.z() < kMinZ) continue;
    first.push_back(onPlane(pairs[i].first));
    second.push_back(onPlane(pairs[i].second));
    index.push_back(i);
  }
  if (static_cast<int>(index.size()) < kFewest) return std::nullopt;
  const cv::Mat unit = cv::Mat::eye(3, 3, CV_64F);
  cv::Mat inliers, rotation, translation;
  const cv::Mat essential =
      cv::findEssentialMat(first, second, unit, cv::RANSAC, kConfidence, tolerance, inliers);
  if (essential.rows != 3 || essential.cols != 3) return std::nullopt;
  cv::Mat points;
  const int agreeing = cv::recoverPose(essential, first, second, unit, rotation, translation,
                                       kFarthest, inliers, points);
  if (agreeing < kFewest) return std::nullopt;
  TwoViews views{poseOf(rotation, translation), std::vector<double>(pairs.size(), 0.0)};
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (inliers.at<unsigned char>(static_cast<int>(i)) == 0) continue;
    views.inverse_depths[index[i]] =
        std::max(0.0, inverseDepth(pairs[index[i]], views.second_from_first));
  }
  return views;
}

}  // namespace camera_self_calibration
