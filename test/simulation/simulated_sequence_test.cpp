#include "camera_self_calibration/simulation/simulated_sequence.h"

#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <stdexcept>

#include "camera_self_calibration/simulation/sequence_writer.h"
#include "camera_self_calibration/simulation/tum_file.h"
#include "test_cameras.h"

namespace camera_self_calibration {
namespace {

SequenceOptions small() {
  SequenceOptions options;
  options.room.texture_detail = 0.3;
  options.lens.camera = cameraOf(CameraModel::kFov, 160, 120, {78.0, 77.0, 80.5, 59.5, 0.93});
  options.duration_s = 1.0;
  return options;
}

double difference(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_L1); }

TEST(SimulatedSequence, FramesCarryTheirTruth) {
  const SimulatedSequence sequence(small());
  ASSERT_EQ(sequence.size(), 21);
  const SimulatedFrame frame = sequence.frame(7);
  EXPECT_EQ(frame.stamp_ns, 1700000000350000000);
  EXPECT_EQ(frame.image.size(), cv::Size(160, 120));
  EXPECT_EQ(frame.camera.parameters(), small().lens.camera.parameters());
  EXPECT_EQ(frame.world_from_camera.translation,
            sequence.trajectory().worldFromCamera(0.35).translation);
  EXPECT_TRUE(sequence.world().free_space.contains(frame.world_from_camera.translation));
  const ImageView view = frame.view();
  EXPECT_EQ(view.data, frame.image.data);
  EXPECT_EQ(view.width, 160);
  EXPECT_EQ(view.height, 120);
  EXPECT_EQ(view.stride, 160);
  EXPECT_EQ(view.stamp_ns, frame.stamp_ns);
}

TEST(SimulatedSequence, ViewKeepsThePixelsAlive) {
  ImageView view;
  cv::Mat copy;
  {
    const SimulatedFrame frame = SimulatedSequence(small()).frame(3);
    copy = frame.image.clone();
    view = frame.view();
  }
  for (int x = 0; x < 160; ++x) EXPECT_EQ(view.data[60 * view.stride + x], copy.at<uchar>(60, x));
}

// White light that the gain multiplies, all over the image.
TEST(SimulatedSequence, AutomaticExposureFollowsTheBrightnessWithALag) {
  SequenceOptions options = small();
  options.auto_exposure = true;
  options.duration_s = 5.0;
  options.renderer.sensor.gain = 0.3;  // as if at dusk
  const SimulatedSequence sequence(options);
  const auto brightness = [&](int index) { return cv::mean(sequence.frame(index).image)[0]; };
  const double first = brightness(0);
  EXPECT_LT(first, 70.0);
  EXPECT_GT(brightness(1), 1.05 * first);
  EXPECT_LT(brightness(1), 1.5 * first);
  for (const int index : {40, 70, 100}) EXPECT_NEAR(brightness(index), 140.0, 25.0);
  cv::Mat saturated = sequence.frame(70).image == 255;
  EXPECT_GT(cv::countNonZero(saturated), 0);
}

TEST(SimulatedSequence, WithAutomaticExposureFramesMayBeAskedForInAnyOrder) {
  SequenceOptions options = small();
  options.auto_exposure = true;
  const SimulatedSequence a(options);
  const SimulatedSequence b(options);
  const cv::Mat late = a.frame(9).image;
  const cv::Mat early = a.frame(4).image;
  for (int i = 0; i < 4; ++i) b.frame(i);
  EXPECT_EQ(difference(b.frame(4).image, early), 0.0);
  EXPECT_EQ(difference(b.frame(9).image, late), 0.0);
}

TEST(SimulatedSequence, TextIsWrittenOverTheImagesBorderOnly) {
  SequenceOptions options = small();
  const cv::Mat plain = SimulatedSequence(options).frame(7).image;
  options.text_overlay = true;
  const SimulatedSequence sequence(options);
  const cv::Mat written = sequence.frame(7).image != plain;
  const int rows = written.rows / 10;
  EXPECT_GT(cv::countNonZero(written.rowRange(0, rows)), 100);
  EXPECT_GT(cv::countNonZero(written.rowRange(written.rows - rows, written.rows)), 50);
  EXPECT_EQ(cv::countNonZero(written.rowRange(rows, written.rows - rows)), 0);
  cv::Mat white = sequence.frame(7).image > 240;
  EXPECT_GT(cv::countNonZero(white & written), 20);
}

TEST(SimulatedSequence, FramesDependOnTheOptionsOnly) {
  const SimulatedSequence a(small());
  const SimulatedSequence b(small());
  b.frame(2);
  EXPECT_EQ(difference(a.frame(5).image, b.frame(5).image), 0.0);
  EXPECT_GT(difference(a.frame(5).image, a.frame(6).image), 160 * 120.0);
  SequenceOptions other = small();
  other.room.seed = 2;
  EXPECT_GT(difference(a.frame(5).image, SimulatedSequence(other).frame(5).image), 160 * 120.0);
}

TEST(SimulatedSequence, ZoomMagnifiesFromItsTimeOn) {
  SequenceOptions options = small();
  options.renderer.sensor.noise_sigma = 0.0;
  const SimulatedSequence plain(options);
  options.lens.zoom_at_s = 0.5;
  options.lens.zoom = 1.2;
  const SimulatedSequence zoomed(options);
  EXPECT_EQ(difference(plain.frame(9).image, zoomed.frame(9).image), 0.0);
  EXPECT_GT(difference(plain.frame(10).image, zoomed.frame(10).image), 160 * 120.0);
  EXPECT_NEAR(zoomed.frame(10).camera.parameters()[0], 1.2 * 78.0, 1e-9);
  EXPECT_NEAR(zoomed.frame(10).camera.parameters()[4], 0.93, 1e-9);
}

TEST(SimulatedSequence, EndsWithItsTrajectory) {
  SequenceOptions options = small();
  options.trajectory = Trajectory([](double) { return Rigid3({1, 0, 0, 0}, {0, 0, 1.5}); }, 0.5);
  EXPECT_EQ(SimulatedSequence(options).size(), 11);
}

TEST(SimulatedSequence, RefusesImpossibleOptions) {
  SequenceOptions options = small();
  options.rate_hz = 0.0;
  options.lens.zoom = 0.0;
  options.lens.camera = Camera();
  EXPECT_EQ(options.problems().size(), 3u);
  EXPECT_THROW(SimulatedSequence{options}, std::invalid_argument);
}

TEST(WriteSequence, FolderHoldsImagesAndTruth) {
  SequenceOptions options = small();
  options.duration_s = 0.2;
  options.lens.zoom_at_s = 0.1;
  options.lens.zoom = 1.15;
  const SimulatedSequence sequence(options);
  const std::string folder = testing::TempDir() + "written_sequence/inner";
  int calls = 0;
  writeSequence(sequence, folder, "png", [&](int index) { EXPECT_EQ(index, calls++); });
  EXPECT_EQ(calls, 5);
  for (int i = 0; i < 5; ++i) {
    const cv::Mat image =
        cv::imread(folder + "/00000" + std::to_string(i) + ".png", cv::IMREAD_UNCHANGED);
    ASSERT_EQ(image.type(), CV_8UC1);
    EXPECT_EQ(difference(image, sequence.frame(i).image), 0.0);
  }
  const std::vector<StampedPose> poses = readTum(folder + "/ground_truth.tum");
  ASSERT_EQ(poses.size(), 5u);
  EXPECT_NEAR(poses[4].time_s, 1700000000.2, 1e-6);
  EXPECT_TRUE(
      poses[4].world_from_body.translation.isApprox(sequence.worldFromCamera(4).translation, 1e-8));
  std::stringstream truth;
  truth << std::ifstream(folder + "/truth.yaml").rdbuf();
  EXPECT_NE(truth.str().find("model: fov\nwidth: 160\nheight: 120\nparams: [78, 77, 80.5, 59.5, "),
            std::string::npos);
  EXPECT_NE(truth.str().find("zoom_at: 0.1"), std::string::npos);
  EXPECT_NE(truth.str().find("\nzoom: 1.1"), std::string::npos);
}

TEST(WriteSequence, SaysWhatCannotBeWritten) {
  SequenceOptions options = small();
  options.duration_s = 0.05;
  const SimulatedSequence sequence(options);
  EXPECT_THROW(writeSequence(sequence, "/proc/no/such/folder"), std::runtime_error);
  EXPECT_THROW(writeSequence(sequence, testing::TempDir() + "odd", "notanimage"),
               std::runtime_error);
}

}  // namespace
}  // namespace camera_self_calibration
