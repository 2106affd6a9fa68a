// Where the tracker looks for features: not at the dark rim of a fisheye lens, not where the user's
// mask forbids it.

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "camera_self_calibration/tracking/tracker.h"

namespace camera_self_calibration {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
constexpr int kPatch = 8;  // Half width of what a feature looks at, at least [px].
const cv::Point kCentre(165, 118);
constexpr int kRadius = 100;
constexpr int kRimMargin =
    5;  // What the field's mask, of a quarter of the resolution, grants [px].

/// A scene that moves by 2 px an image.
cv::Mat scene(int index) {
  static const cv::Mat canvas = [] {
    cv::Mat noise(kHeight, 3 * kWidth, CV_8UC1);
    cv::theRNG().state = 7;
    cv::randu(noise, 60, 250);
    cv::Mat smooth;
    cv::GaussianBlur(noise, smooth, {0, 0}, 2.0);
    cv::normalize(smooth, smooth, 60, 250, cv::NORM_MINMAX);
    return smooth;
  }();
  return canvas(cv::Rect(2 * index, 0, kWidth, kHeight)).clone();
}

/// The scene through a lens whose image circle is smaller than the sensor: a rim that stands still,
/// and darkness with noise around it.
cv::Mat fisheye(int index) {
  cv::Mat circle(kHeight, kWidth, CV_8UC1, cv::Scalar(0));
  cv::circle(circle, kCentre, kRadius, 255, cv::FILLED);
  cv::Mat image(kHeight, kWidth, CV_8UC1);
  cv::randu(image, 0, 14);
  scene(index).copyTo(image, circle);
  return image;
}

ImageView viewOf(const cv::Mat& image, int index) {
  const auto owner = std::make_shared<cv::Mat>(image);
  return {owner,
          owner->data,
          owner->cols,
          owner->rows,
          static_cast<int>(owner->step[0]),
          1000000000 + 50000000ll * index};
}

/// Calls check(track) for every track of every image; returns how many there were in the last one.
template <typename Image, typename Check>
std::size_t follow(Tracker* tracker, int begin, int end, const Image& image, const Check& check) {
  std::size_t count = 0;
  for (int i = begin; i < end; ++i) {
    TrackedFrame frame = tracker->track(viewOf(image(i), i));
    for (const Track& track : tracker->detect()) frame.tracks.push_back(track);
    for (const Track& track : frame.tracks) check(track);
    count = frame.tracks.size();
  }
  return count;
}

TEST(TrackerField, ACircularFieldIsFoundByItself) {
  Tracker tracker{TrackerOptions()};
  const auto inside = [](const Track& track) {
    const double radius = (track.pixel - Eigen::Vector2d(kCentre.x, kCentre.y)).norm();
    // A feature that was born inside may move towards the rim until its patch no longer fits.
    EXPECT_LT(radius, kRadius - 2) << track.pixel.transpose();
    const double born = (track.reference_pixel - Eigen::Vector2d(kCentre.x, kCentre.y)).norm();
    EXPECT_LT(born, kRadius - kRimMargin) << track.reference_pixel.transpose();
  };
  EXPECT_GT(follow(&tracker, 0, 10, fisheye, inside), 30u);
  // After a loss too, although the first image then is dark for a moment.
  tracker.reset();
  const auto dim = [](int i) { return cv::Mat(fisheye(i) * 0.8); };
  EXPECT_GT(follow(&tracker, 10, 20, dim, inside), 30u);
}

TEST(TrackerField, TellsWhichPartOfTheImageSees) {
  Tracker tracker{TrackerOptions()};
  EXPECT_EQ(tracker.track(viewOf(fisheye(0), 0)).field.share(), 1.0);  // nobody looked yet
  tracker.detect();
  const ImageField field = tracker.track(viewOf(fisheye(1), 1)).field;
  for (int row = 0; row < ImageField::kRows; ++row) {
    for (int column = 0; column < ImageField::kColumns; ++column) {
      const Eigen::Vector2d pixel = ImageField::pixel(column, row, kWidth, kHeight);
      const double radius = (pixel - Eigen::Vector2d(kCentre.x, kCentre.y)).norm();
      if (std::abs(radius - kRadius) < kRimMargin) continue;
      EXPECT_EQ(field.sees(column, row), radius < kRadius) << pixel.transpose();
    }
  }
  EXPECT_NEAR(field.share(), M_PI * kRadius * kRadius / (kWidth * kHeight), 0.03);
}

// As of a thermal camera, whose images are too small for a quarter of the resolution.
TEST(TrackerField, OfSmallImagesToo) {
  constexpr int kSmallWidth = 80, kSmallHeight = 60, kRim = 20;
  const auto image = [](int index) {
    cv::Mat small = scene(index)(cv::Rect(0, 0, kSmallWidth, kSmallHeight)).clone();
    small.colRange(kSmallWidth - kRim, kSmallWidth).setTo(3);
    return small;
  };
  Tracker tracker{TrackerOptions()};
  for (int i = 0; i < 3; ++i) {
    tracker.track(viewOf(image(i), i));
    tracker.detect();
  }
  const ImageField field = tracker.track(viewOf(image(3), 3)).field;
  for (int column = 0; column < ImageField::kColumns; ++column) {
    const double x = ImageField::pixel(column, 0, kSmallWidth, kSmallHeight).x();
    if (std::abs(x - (kSmallWidth - kRim)) < kRimMargin) continue;
    EXPECT_EQ(field.sees(column, ImageField::kRows / 2), x < kSmallWidth - kRim) << x;
  }
}

TEST(TrackerField, ACoveredLensTellsNothingOfTheField) {
  Tracker tracker{TrackerOptions()};
  const cv::Mat black(kHeight, kWidth, CV_8UC1, cv::Scalar(5));
  tracker.track(viewOf(black, 0));
  tracker.detect();
  EXPECT_EQ(tracker.track(viewOf(black, 1)).field.share(), 1.0);
}

TEST(TrackerField, TheMaskKeepsFeaturesOffTheRobot) {
  // Of half the resolution: it is scaled. The lower left shows a gripper.
  cv::Mat mask(kHeight / 2, kWidth / 2, CV_8UC1, cv::Scalar(255));
  mask(cv::Rect(0, 60, 80, 60)).setTo(0);
  TrackerOptions options;
  options.mask = viewOf(mask, 0);
  const auto still = [](int i) {
    cv::Mat image = scene(i);
    const cv::Rect gripper(0, 120, 160, 120);
    scene(0)(gripper).copyTo(image(gripper));
    return image;
  };
  int on_the_robot = 0;
  const auto count = [&](const Track& track) {
    on_the_robot += track.pixel.x() < 160 + kPatch && track.pixel.y() > 120 - kPatch;
  };
  Tracker tracker(options);
  EXPECT_GT(follow(&tracker, 0, 10, still, count), 30u);
  EXPECT_EQ(on_the_robot, 0);
  Tracker without{TrackerOptions()};
  follow(&without, 0, 10, still, count);
  EXPECT_GT(on_the_robot, 50) << "without the mask the test would see features there";
}

}  // namespace
}  // namespace camera_self_calibration
