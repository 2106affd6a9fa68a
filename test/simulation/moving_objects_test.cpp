#include "camera_self_calibration/simulation/moving_objects.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <stdexcept>

#include "camera_self_calibration/simulation/simulated_sequence.h"
#include "test_cameras.h"

namespace camera_self_calibration {
namespace {

Camera smallCamera() {
  return cameraOf(CameraModel::kFov, 160, 120, {78.0, 77.0, 80.5, 59.5, 0.93});
}

Trajectory turning() {
  SyntheticMotionOptions options;
  options.duration_s = 10.0;
  return syntheticMotion(options);
}

MovingObjectsOptions covering(double share, bool carried) {
  MovingObjectsOptions options;
  options.share = share;
  options.carried = carried;
  return options;
}

double meanShare(const std::vector<MovingBody>& bodies, const Camera& camera) {
  double sum = 0.0;
  for (int i = 0; i < 40; ++i) {
    const double time = 0.25 * i;
    sum += coveredShare(bodies, camera, turning().worldFromCamera(time), time);
  }
  return sum / 40;
}

TEST(MovingObjects, CoverTheShareThatIsAskedFor) {
  for (const Camera& camera : testCameras()) {
    for (const double share : {0.05, 0.15, 0.3}) {
      for (const bool carried : {false, true}) {
        const auto bodies = movingObjects(covering(share, carried), camera, turning());
        EXPECT_NEAR(meanShare(bodies, camera), share, 0.2 * share)
            << toString(camera.model()) << (carried ? ", carried" : "");
      }
    }
  }
}

TEST(MovingObjects, StayInPlaceBeforeTheCameraOnlyIfCarried) {
  for (const bool carried : {false, true}) {
    for (const MovingBody& body : movingObjects(covering(0.1, carried), smallCamera(), turning())) {
      const auto inView = [&](double time) {
        return turning().worldFromCamera(time).inverse() * body.world_from_body(time);
      };
      const double moved = (inView(1.0).inverse() * inView(3.0)).translation.norm();
      const double turned = inView(1.0).rotation.angularDistance(inView(3.0).rotation);
      EXPECT_EQ(moved > 0.02 && turned > 0.02, !carried);
      EXPECT_LT(moved + turned, carried ? 1e-9 : 10.0);
    }
  }
}

TEST(MovingObjects, NoneWithoutAShareAndRefusedBeyondHalfOfTheImage) {
  EXPECT_TRUE(movingObjects({}, smallCamera(), turning()).empty());
  EXPECT_THROW(movingObjects(covering(0.51, false), smallCamera(), turning()),
               std::invalid_argument);
  EXPECT_THROW(movingObjects(covering(std::nan(""), false), smallCamera(), turning()),
               std::invalid_argument);
}

// The same pixels in all images, and those that coveredShare counts.
TEST(MovingObjects, ThatAreCarriedAreFixedInTheImage) {
  SequenceOptions options;
  options.room.texture_detail = 0.3;
  options.lens.camera = smallCamera();
  options.duration_s = 4.0;
  options.renderer.sensor.noise_sigma = 0.0;
  options.objects = covering(0.2, true);
  const SimulatedSequence sequence(options);
  cv::Mat steady(120, 160, CV_8UC1, cv::Scalar(255));
  const cv::Mat first = sequence.frame(0).image;
  for (const int index : {20, 40, 60, 80}) {
    cv::Mat difference;
    cv::absdiff(sequence.frame(index).image, first, difference);
    steady.setTo(0, difference > 2);
  }
  EXPECT_NEAR(cv::countNonZero(steady) / (120.0 * 160.0), 0.2, 0.04);
}

}  // namespace
}  // namespace camera_self_calibration
