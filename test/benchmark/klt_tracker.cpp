#include "benchmark/klt_tracker.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/video/tracking.hpp>

namespace camera_self_calibration {
namespace {

constexpr float kMaxReturn = 0.5f;     // [px]
constexpr double kMaxEpipolar = 1.0;   // [px]
constexpr std::size_t kMinPairs = 8;   // For a fundamental matrix.
constexpr int kBorder = 14;            // [px] As the tracker keeps it.
constexpr double kMinDistance = 0.4;   // Of a square grid's, as the tracker keeps it.
constexpr double kAssumedSigma = 0.2;  // [px] It states none.

}  // namespace

void KltTracker::follow(const cv::Mat& image) {
  std::vector<cv::Point2f> from, to, back;
  for (const Track& track : tracks_) {
    from.emplace_back(static_cast<float>(track.pixel.x()), static_cast<float>(track.pixel.y()));
  }
  if (from.empty()) return;
  std::vector<std::uint8_t> found, returned;
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(last_, image, from, to, found, errors);
  cv::calcOpticalFlowPyrLK(image, last_, to, back, returned, errors);
  const cv::Rect2f inside(0.0f, 0.0f, static_cast<float>(image.cols),
                          static_cast<float>(image.rows));
  std::vector<Track> kept;
  std::vector<cv::Point2f> kept_from, kept_to;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const bool good = found[i] != 0 && returned[i] != 0 && inside.contains(to[i]) &&
                      cv::norm(back[i] - from[i]) < kMaxReturn;
    if (!good) continue;
    kept.push_back(tracks_[i]);
    kept.back().pixel = {to[i].x, to[i].y};
    kept_from.push_back(from[i]);
    kept_to.push_back(to[i]);
  }
  std::vector<std::uint8_t> inliers;
  if (kept.size() >= kMinPairs) {
    cv::findFundamentalMat(kept_from, kept_to, cv::FM_RANSAC, kMaxEpipolar, 0.99, inliers);
  }
  tracks_.clear();
  for (std::size_t i = 0; i < kept.size(); ++i) {
    if (inliers.size() != kept.size() || inliers[i] != 0) tracks_.push_back(kept[i]);
  }
}

void KltTracker::detect(const ImageView& image) {
  const double spacing = std::sqrt(static_cast<double>(image.width) * image.height / max_features_);
  begun_.clear();
  pyramid_.build(image);
  for (const Corner& corner : harris_.detect(pyramid_, kBorder, static_cast<int>(spacing))) {
    if (static_cast<int>(tracks_.size()) >= max_features_) return;
    const Eigen::Vector2d pixel(corner.x, corner.y);
    const bool crowded = std::any_of(tracks_.begin(), tracks_.end(), [&](const Track& track) {
      return (track.pixel - pixel).norm() < kMinDistance * spacing;
    });
    if (crowded) continue;
    tracks_.push_back({next_id_++, pixel, pixel, kAssumedSigma});
    begun_.push_back(tracks_.back());
  }
}

std::vector<Track> KltTracker::track(const ImageView& image) {
  const cv::Mat present =
      cv::Mat(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
              static_cast<std::size_t>(image.stride))
          .clone();
  follow(present);
  std::vector<Track> followed = tracks_;
  detect(image);
  last_ = present;
  return followed;
}

}  // namespace camera_self_calibration
