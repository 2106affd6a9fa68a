#include "camera_self_calibration/camera/field_of_view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sample_cameras.h"

namespace camera_self_calibration {
namespace {

TEST(FieldOfView, OfAPinholeIsThatOfItsFocalLength) {
  const FieldOfView field =
      fieldOfView(camera640(CameraModel::kPinhole, {320.0, 320.0, 319.5, 239.5}));
  const double degrees = 360.0 / M_PI;
  EXPECT_NEAR(field.horizontal, degrees * std::atan(319.5 / 320.0), 1e-9);
  EXPECT_NEAR(field.vertical, degrees * std::atan(239.5 / 320.0), 1e-9);
  EXPECT_NEAR(field.diagonal, degrees * std::atan(std::hypot(319.5, 239.5) / 320.0), 1e-9);
}

TEST(FieldOfView, MayBeWiderThanAHalfSpace) {
  const Camera fisheye = camera640(CameraModel::kEquidistant, {180, 180, 319.5, 239.5, 0, 0, 0, 0});
  EXPECT_NEAR(fieldOfView(fisheye).horizontal, 360.0 / M_PI * 319.5 / 180.0, 1e-6);
}

// As of a region of interest at the border of a sensor.
TEST(FieldOfView, MayLieOnOneSideOfTheAxis) {
  const FieldOfView field =
      fieldOfView(camera640(CameraModel::kPinhole, {320.0, 320.0, -320.0, 239.5}));
  EXPECT_NEAR(field.horizontal, 180.0 / M_PI * std::atan(959.0 / 320.0) - 45.0, 1e-9);
  EXPECT_GT(field.diagonal, field.horizontal);
  EXPECT_LT(field.diagonal, 60.0);
}

TEST(FieldOfView, IsUnknownWhereTheBorderHasNoRay) {
  const Camera folded = camera640(CameraModel::kRadtan, {300, 300, 320, 240, -0.5, 0, 0, 0});
  EXPECT_TRUE(std::isnan(fieldOfView(folded).diagonal));
}

}  // namespace
}  // namespace camera_self_calibration
