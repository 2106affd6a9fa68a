#include "camera_self_calibration/plotting/track_overlay.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

namespace camera_self_calibration {
namespace {

TrackedFrame frameWith(const std::vector<std::int64_t>& ids, double x) {
  TrackedFrame frame;
  for (const std::int64_t id : ids) {
    Track track;
    track.id = id;
    track.pixel = {x, 10.0 * static_cast<double>(id)};
    frame.tracks.push_back(track);
  }
  return frame;
}

TEST(TrackTrails, FollowLiveTracksInBoundedMemory) {
  TrackTrails trails(5);
  for (int i = 0; i < 20; ++i) trails.add(frameWith({1, 2}, i));
  ASSERT_EQ(trails.trails().size(), 2u);
  EXPECT_EQ(trails.trails().at(1).pixels.size(), 5u);
  EXPECT_EQ(trails.trails().at(1).pixels.back().x(), 19.0);
  EXPECT_EQ(trails.trails().at(1).images, 20);
  trails.add(frameWith({2, 3}, 20));
  EXPECT_EQ(trails.trails().count(1), 0u) << "it has ended";
  EXPECT_EQ(trails.trails().at(3).images, 1);
}

TEST(TrackOverlay, DrawsDotsAndTails) {
  const cv::Mat gray(200, 320, CV_8UC1, cv::Scalar(100));
  TrackTrails trails;
  for (int i = 0; i < 10; ++i) trails.add(frameWith({5}, 50.0 + 10.0 * i));
  const cv::Mat picture = drawTracks(gray, trails, {});
  ASSERT_EQ(picture.size(), gray.size());
  ASSERT_EQ(picture.type(), CV_8UC3);
  const cv::Vec3b plain(100, 100, 100);
  EXPECT_NE(picture.at<cv::Vec3b>(50, 140), plain) << "the dot";
  EXPECT_NE(picture.at<cv::Vec3b>(50, 85), plain) << "the tail";
  EXPECT_EQ(picture.at<cv::Vec3b>(60, 85), plain);
  EXPECT_EQ(picture.at<cv::Vec3b>(50, 160), plain);
  EXPECT_EQ(gray.at<std::uint8_t>(50, 140), 100) << "the image itself is left alone";
}

TEST(TrackOverlay, CaptionsStandAtTheLowerBorder) {
  const cv::Mat gray(200, 320, CV_8UC1, cv::Scalar(100));
  const Colour green(0, 255, 0);
  const cv::Mat picture = drawTracks(gray, TrackTrails(), {{green, "TRACKING"}});
  EXPECT_EQ(picture.at<cv::Vec3b>(100, 100), cv::Vec3b(100, 100, 100));
  EXPECT_LT(picture.at<cv::Vec3b>(198, 318)[0], 60) << "darkened";
  cv::Mat mask;
  cv::inRange(picture, green - Colour(1, 1, 1), green + Colour(1, 1, 1), mask);
  EXPECT_GT(cv::countNonZero(mask), 20);
}

TEST(TrackOverlay, ALongCaptionGoesOnInTheNextLine) {
  const cv::Mat gray(200, 320, CV_8UC1, cv::Scalar(100));
  const std::string words = "LOST, only 3 features could be followed; 12 are needed: slow down";
  const auto darkRows = [&](const std::string& text) {
    const cv::Mat picture = drawTracks(gray, TrackTrails(), {{Colour(0, 255, 0), text}});
    int rows = 0;
    for (int y = 0; y < picture.rows; ++y) rows += picture.at<cv::Vec3b>(y, 319)[0] < 60;
    return rows;
  };
  EXPECT_EQ(darkRows("LOST"), 26);
  EXPECT_EQ(darkRows(words), 46);
}

TEST(TrackOverlay, AnImageLowerThanItsCaptionsIsDrawnToo) {
  const cv::Mat gray(8, 30, CV_8UC1, cv::Scalar(100));
  EXPECT_EQ(drawTracks(gray, TrackTrails(), {{Colour(), "a"}, {Colour(), "b"}}).rows, 8);
}

}  // namespace
}  // namespace camera_self_calibration
