#include "camera_self_calibration/tracking/appearance.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "camera_self_calibration/simulation/random.h"
#include "camera_self_calibration/simulation/texture_paint.h"

namespace camera_self_calibration {
namespace {

cv::Mat poster(std::uint64_t seed) {
  TextureRecipe recipe;
  recipe.kind = TextureKind::kPoster;
  recipe.seed = seed;
  recipe.texels_per_metre = 240.0;
  cv::Mat image;
  cv::resize(paintTexture(recipe, 1.0, 1.0), image, cv::Size(240, 240));
  return image;
}

ImageView viewOf(const cv::Mat& image) {
  ImageView view;
  view.data = image.data;
  view.width = image.cols;
  view.height = image.rows;
  view.stride = static_cast<int>(image.step);
  return view;
}

// Corners on a grid, each moved to the strongest response near it.
std::vector<Track> corners(const cv::Mat& image) {
  std::vector<cv::Point2f> found;
  cv::goodFeaturesToTrack(image, found, 60, 0.01, 12.0);
  std::vector<Track> tracks;
  for (const cv::Point2f& at : found) {
    const Eigen::Vector2d pixel(at.x, at.y);
    tracks.push_back({static_cast<std::int64_t>(tracks.size()), pixel, pixel, 0.1});
  }
  return tracks;
}

std::vector<Descriptor> descriptors(const cv::Mat& image, const std::vector<Track>& tracks) {
  std::vector<Descriptor> list;
  for (const Appearance& appearance : describe(viewOf(image), tracks)) {
    list.push_back(appearance.descriptor);
  }
  return list;
}

TEST(Appearance, IsKnownAgainWhenTurnedDarkerAndNoisy) {
  const cv::Mat image = poster(1);
  const std::vector<Track> tracks = corners(image);
  ASSERT_GE(tracks.size(), 40u);
  cv::Mat turned;
  cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);
  turned.convertTo(turned, CV_8U, 0.6, 10.0);
  Random random(3);
  for (int p = 0; p < 240 * 240; ++p) {
    turned.data[p] = cv::saturate_cast<std::uint8_t>(turned.data[p] + 3.0 * random.normal());
  }
  std::vector<Track> there = tracks;
  for (Track& track : there) track.pixel = {239.0 - track.pixel.y(), track.pixel.x()};
  const auto pairs = matchAppearances(descriptors(image, tracks), descriptors(turned, there));
  EXPECT_GE(pairs.size(), tracks.size() / 2);
  int right = 0;
  for (const auto& [a, b] : pairs) right += a == b;
  EXPECT_GE(right, 0.95 * static_cast<double>(pairs.size()));
}

TEST(Appearance, OfOtherPicturesMatchesLittle) {
  const cv::Mat one = poster(1);
  const cv::Mat other = poster(2);
  const auto pairs =
      matchAppearances(descriptors(one, corners(one)), descriptors(other, corners(other)));
  EXPECT_LT(pairs.size(), corners(one).size() / 3);
}

TEST(Appearance, WhatRepeatsIsAmbiguous) {
  const cv::Mat image = poster(1);
  cv::Mat twice;
  cv::hconcat(image, image, twice);
  std::vector<Track> both = corners(image);
  const std::size_t once = both.size();
  for (std::size_t i = 0; i < once; ++i) {
    both.push_back(both[i]);
    both.back().pixel.x() += image.cols;
  }
  const auto pairs = matchAppearances(descriptors(image, corners(image)), descriptors(twice, both));
  EXPECT_LT(pairs.size(), once / 4);  // only at the seam it does not repeat
}

TEST(Appearance, CornersComeAfterTheTracksAndHaveNone) {
  const cv::Mat image = poster(1);
  std::vector<Track> tracks = corners(image);
  const std::vector<Descriptor> all = descriptors(image, tracks);
  const std::vector<Eigen::Vector2d> others = {tracks.back().pixel, {-5.0, 20.0}};
  tracks.pop_back();
  const std::vector<Appearance> looks = describe(viewOf(image), tracks, others);
  ASSERT_EQ(looks.size(), all.size()) << "but for the one outside";
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(looks[i].descriptor, all[i]);
  EXPECT_EQ(looks.front().track_id, 0);
  EXPECT_EQ(looks.back().track_id, kNoTrack);
  EXPECT_EQ(looks.back().pixel, others[0]);
}

TEST(Appearance, NeedsAnImage) {
  const cv::Mat image = poster(1);
  const Track outside{7, {-5.0, 20.0}, {-5.0, 20.0}, 0.1};
  EXPECT_TRUE(describe(ImageView(), {outside}).empty());
  EXPECT_TRUE(describe(viewOf(image), {}).empty());
  EXPECT_TRUE(describe(viewOf(image), {outside}).empty());
  EXPECT_TRUE(matchAppearances({}, {}).empty());
  const Track inside{8, {1.0, 238.0}, {1.0, 238.0}, 0.1};  // in the corner
  ASSERT_EQ(describe(viewOf(image), {outside, inside}).size(), 1u);
  EXPECT_EQ(describe(viewOf(image), {outside, inside})[0].track_id, 8);
}

}  // namespace
}  // namespace camera_self_calibration
