#include "camera_self_calibration/tracking/appearance.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <opencv2/features2d.hpp>

#include "camera_self_calibration/tracking/pyramid.h"

namespace camera_self_calibration {
namespace {

constexpr int kPatchSize = 31;          // [px]
constexpr float kClearlyNearer = 0.8F;  // than the second nearest

// Direction from a corner to the centroid of the gray values around it: it turns with the camera.
float orientation(const cv::Mat& image, int x, int y) {
  constexpr int kRadius = kPatchSize / 2;
  double mx = 0.0;
  double my = 0.0;
  for (int row = std::max(0, y - kRadius); row <= std::min(image.rows - 1, y + kRadius); ++row) {
    const int dy = row - y;
    const int reach = static_cast<int>(std::sqrt(static_cast<double>(kRadius * kRadius - dy * dy)));
    const std::uint8_t* pixels = image.ptr<std::uint8_t>(row);
    for (int column = std::max(0, x - reach); column <= std::min(image.cols - 1, x + reach);
         ++column) {
      mx += (column - x) * pixels[column];
      my += dy * pixels[column];
    }
  }
  return cv::fastAtan2(static_cast<float>(my), static_cast<float>(mx));
}

cv::Mat rows(const std::vector<Descriptor>& descriptors) {
  // Read only, though a cv::Mat cannot say so.
  return cv::Mat(static_cast<int>(descriptors.size()), static_cast<int>(sizeof(Descriptor)), CV_8U,
                 const_cast<Descriptor*>(descriptors.data()));
}

}  // namespace

std::vector<Appearance> describe(const ImageView& image, const std::vector<Track>& tracks,
                                 const std::vector<Eigen::Vector2d>& corners) {
  std::vector<Appearance> result;
  std::vector<Appearance> features;
  features.reserve(tracks.size() + corners.size());
  for (const Track& track : tracks) features.push_back({track.id, track.pixel, {}});
  for (const Eigen::Vector2d& pixel : corners) features.push_back({kNoTrack, pixel, {}});
  if (!ImagePyramid::usable(image)) return result;
  const cv::Mat gray(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data),
                     static_cast<std::size_t>(image.stride));
  std::vector<cv::KeyPoint> points;
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Eigen::Vector2f at = features[i].pixel.cast<float>();
    const Eigen::Vector2i pixel = at.array().round().cast<int>();
    if (!cv::Rect(0, 0, gray.cols, gray.rows).contains({pixel.x(), pixel.y()})) continue;
    points.emplace_back(at.x(), at.y(), static_cast<float>(kPatchSize),
                        orientation(gray, pixel.x(), pixel.y()), 0.0F, 0, static_cast<int>(i));
  }
  cv::Mat descriptors;
  constexpr int kNoBorder = 1;
  cv::ORB::create(static_cast<int>(features.size()), 1.2F, 1, kNoBorder, 0, 2,
                  cv::ORB::HARRIS_SCORE, kPatchSize)
      ->compute(gray, points, descriptors);
  for (std::size_t i = 0; i < points.size(); ++i) {
    result.push_back(features[static_cast<std::size_t>(points[i].class_id)]);
    std::copy_n(descriptors.ptr<std::uint8_t>(static_cast<int>(i)), sizeof(Descriptor),
                result.back().descriptor.begin());
  }
  return result;
}

int differingBits(const Descriptor& a, const Descriptor& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    count += std::bitset<8>(static_cast<unsigned>(a[i] ^ b[i])).count();
  }
  return static_cast<int>(count);
}

std::vector<std::pair<int, int>> matchAppearances(const std::vector<Descriptor>& a,
                                                  const std::vector<Descriptor>& b) {
  std::vector<std::pair<int, int>> pairs;
  if (a.empty() || b.size() < 2) return pairs;
  const cv::BFMatcher matcher(cv::NORM_HAMMING);
  std::vector<std::vector<cv::DMatch>> nearest;
  matcher.knnMatch(rows(a), rows(b), nearest, 2);
  std::vector<const cv::DMatch*> nearest_to_b(b.size(), nullptr);
  for (const std::vector<cv::DMatch>& two : nearest) {
    if (two.size() < 2 || two[0].distance > kMaxDifferingBits) continue;
    const cv::DMatch*& rival = nearest_to_b[static_cast<std::size_t>(two[0].trainIdx)];
    if (rival == nullptr || two[0].distance < rival->distance) rival = &two[0];
  }
  for (const std::vector<cv::DMatch>& two : nearest) {
    if (two.size() < 2 || two[0].distance >= kClearlyNearer * two[1].distance) continue;
    if (nearest_to_b[static_cast<std::size_t>(two[0].trainIdx)] != &two[0]) continue;
    pairs.emplace_back(two[0].queryIdx, two[0].trainIdx);
  }
  return pairs;
}

}  // namespace camera_self_calibration
