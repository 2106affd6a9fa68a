#include "camera_self_calibration/queue/observed_area.h"

#include <gtest/gtest.h>

#include "camera/sample_cameras.h"

namespace camera_self_calibration {
namespace {

const Camera kCamera = camera640(CameraModel::kPinhole, {420, 415, 325, 236});

Candidate seenAt(const std::vector<Eigen::Vector2d>& pixels) {
  Candidate candidate;
  for (const Eigen::Vector2d& pixel : pixels) {
    Observation observation;
    observation.pixel = pixel;
    candidate.segment.observations.push_back(observation);
  }
  return candidate;
}

std::vector<Eigen::Vector2d> everywhereFrom(double left) {
  std::vector<Eigen::Vector2d> pixels;
  for (double y = 5.0; y < 480.0; y += 20.0) {
    for (double x = left + 5.0; x < 640.0; x += 20.0) pixels.emplace_back(x, y);
  }
  return pixels;
}

TEST(ObservedArea, IsNothingWithoutObservations) {
  const ImageField observed = observedArea({}, kCamera, {});
  EXPECT_EQ(observed.share(), 0.0);
  EXPECT_EQ(unseenCorners(observed, {}),
            "no feature of the images that the calibration rests on reached the corners");
}

TEST(ObservedArea, AFeatureCoversItsNeighbourhood) {
  const ImageField observed = observedArea({seenAt({{320.0, 240.0}})}, kCamera, {});
  EXPECT_NEAR(observed.share(), 9.0 / 1200.0, 1e-12);
  // At the border, and one that lies outside or nowhere.
  const ImageField border =
      observedArea({seenAt({{0.0, 0.0}, {-300.0, 10.0}, {std::nan(""), 1.0}})}, kCamera, {});
  EXPECT_NEAR(border.share(), 4.0 / 1200.0, 1e-12);
  EXPECT_TRUE(border.sees(0, 0));
}

TEST(ObservedArea, NamesTheCornersThatNoFeatureReached) {
  const ImageField all = observedArea({seenAt(everywhereFrom(0.0))}, kCamera, {});
  EXPECT_EQ(all.share(), 1.0);
  EXPECT_EQ(unseenCorners(all, {}), "");
  const ImageField right = observedArea({seenAt(everywhereFrom(200.0))}, kCamera, {});
  EXPECT_EQ(unseenCorners(right, {}),
            "no feature of the images that the calibration rests on reached the upper left and the "
            "lower left corners");
  ImageField all_but_one = all;
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column) all_but_one.setDark(column, row);
  }
  EXPECT_EQ(unseenCorners(all_but_one, {}),
            "no feature of the images that the calibration rests on reached the upper left corner");
  ImageField seeing;  // the left is dark: there is nothing to see
  for (int row = 0; row < ImageField::kRows; ++row) {
    for (int column = 0; column < 12; ++column) seeing.setDark(column, row);
  }
  EXPECT_EQ(unseenCorners(observedArea({seenAt(everywhereFrom(200.0))}, kCamera, seeing), seeing),
            "");
}

}  // namespace
}  // namespace camera_self_calibration
