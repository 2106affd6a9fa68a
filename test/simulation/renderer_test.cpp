#include "camera_self_calibration/simulation/renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <utility>

#include "camera_self_calibration/simulation/room.h"
#include "camera_self_calibration/simulation/synthetic_motion.h"
#include "test_cameras.h"

namespace camera_self_calibration {
namespace {

RendererOptions noiseless() {
  RendererOptions options;
  options.sensor.noise_sigma = 0.0;
  return options;
}

// A furnished room, each surface of one gray value.
World flatRoom() {
  World room = makeRoom(RoomOptions());
  for (std::size_t i = 0; i < room.surfaces.size(); ++i) {
    room.surfaces[i].texture.kind = TextureKind::kImage;
    room.surfaces[i].texture.image = cv::Mat(32, 32, CV_8UC1, cv::Scalar(20 + i));
  }
  return room;
}

const std::shared_ptr<const PaintedWorld>& paintedRoom() {
  static const auto room = std::make_shared<const PaintedWorld>(makeRoom(RoomOptions()));
  return room;
}

Trajectory handheld() {
  SyntheticMotionOptions options;
  options.box = paintedRoom()->world.free_space;
  return syntheticMotion(options);
}

// Gray of the surface that all rays through the pixel meet; nothing where an edge passes.
std::optional<float> grayByRayCasting(const World& world, const Camera& camera, const Rigid3& pose,
                                      const Eigen::Vector2d& pixel) {
  int surface = -1;
  const std::pair<double, double> offsets[] = {
      {0.0, 0.0}, {0.7, 0.7}, {-0.7, 0.7}, {0.7, -0.7}, {-0.7, -0.7}};
  for (const auto& [dx, dy] : offsets) {
    const auto ray = camera.unproject(pixel + Eigen::Vector2d(dx, dy));
    if (!ray) return std::nullopt;
    const auto hit = world.castRay(pose.translation, pose.rotation * *ray);
    if (!hit || (surface >= 0 && surface != hit->surface)) return std::nullopt;
    surface = hit->surface;
  }
  return 20.0f + static_cast<float>(surface);
}

TEST(Renderer, ShowsTheSurfaceThatRayCastingFinds) {
  const auto world = std::make_shared<const PaintedWorld>(flatRoom());
  SyntheticMotionOptions motion;
  motion.box = world->world.free_space;
  const Trajectory trajectory = syntheticMotion(motion);
  for (const Camera& camera : testCameras()) {
    const Renderer renderer(world, camera, noiseless());
    for (const double time : {3.0, 17.0, 31.0, 44.0}) {
      const Rigid3 pose = trajectory.worldFromCamera(time);
      const cv::Mat light = renderer.light(pose);
      int compared = 0;
      int wrong = 0;
      for (int y = 2; y < light.rows - 2; y += 5) {
        for (int x = 2; x < light.cols - 2; x += 5) {
          const auto gray = grayByRayCasting(world->world, camera, pose, {x, y});
          if (!gray) continue;
          ++compared;
          // A thin object may pass between the five rays: rare, but not wrong.
          wrong += std::abs(light.at<float>(y, x) - *gray) > 0.01f ? 1 : 0;
        }
      }
      EXPECT_GT(compared, 8000);
      EXPECT_LE(wrong, compared / 1000) << toString(camera.model()) << " at " << time << " s";
    }
  }
}

TEST(Renderer, PixelsWithoutARayAreBlack) {
  const Camera camera =
      cameraOf(CameraModel::kRadtan, 640, 480, {200.0, 200.0, 320.0, 240.0, -0.3, 0.0, 0.0, 0.0});
  ASSERT_FALSE(camera.unproject({0.0, 0.0}));
  ASSERT_TRUE(camera.unproject({320.0, 240.0}));
  RendererOptions options;
  options.sensor.noise_sigma = 5.0;
  const cv::Mat image = Renderer(paintedRoom(), camera, options).render(handheld(), 3.0, 1);
  int black = 0;
  for (int y = 0; y < 480; y += 7) {
    for (int x = 0; x < 640; x += 7) {
      if (camera.unproject({x, y})) continue;
      EXPECT_EQ(image.at<std::uint8_t>(y, x), 0);
      ++black;
    }
  }
  EXPECT_GT(black, 500);
  EXPECT_GT(image.at<std::uint8_t>(240, 320), 0);
}

TEST(Renderer, SizesNeedNotBeWholeTiles) {
  const Camera camera = Camera::defaultGuess(CameraModel::kFov, 101, 75);
  const cv::Mat image = Renderer(paintedRoom(), camera, noiseless()).render(handheld(), 3.0, 1);
  ASSERT_EQ(image.size(), cv::Size(101, 75));
  EXPECT_GT(cv::mean(image.row(74))[0], 20.0);
  EXPECT_GT(cv::mean(image.col(100))[0], 20.0);
}

TEST(Renderer, NoiseHasTheSigmaAskedForAndFollowsItsSeed) {
  RendererOptions options;
  options.sensor.noise_sigma = 3.0;
  const Renderer renderer(paintedRoom(), testCameras()[1], options);
  const Renderer clean(paintedRoom(), testCameras()[1], noiseless());
  const cv::Mat a = renderer.render(handheld(), 3.0, 7);
  EXPECT_EQ(cv::norm(a, renderer.render(handheld(), 3.0, 7), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(a, renderer.render(handheld(), 3.0, 8), cv::NORM_L1), 640 * 480.0);
  cv::Mat difference;
  cv::subtract(a, clean.render(handheld(), 3.0, 7), difference, cv::noArray(), CV_32F);
  cv::Scalar mean, deviation;
  cv::meanStdDev(difference, mean, deviation);
  EXPECT_NEAR(mean[0], 0.0, 0.05);
  EXPECT_NEAR(deviation[0], 3.0, 0.1);
}

TEST(Renderer, ThreadsDoNotChangeTheImage) {
  RendererOptions options;
  const cv::Mat one = Renderer(paintedRoom(), testCameras()[1], options).render(handheld(), 9.0, 1);
  options.threads = 3;
  const cv::Mat three =
      Renderer(paintedRoom(), testCameras()[1], options).render(handheld(), 9.0, 1);
  EXPECT_EQ(cv::norm(one, three, cv::NORM_INF), 0.0);
}

TEST(Renderer, RollingShutterShowsEachRowAtItsTime) {
  RendererOptions options = noiseless();
  options.line_delay_s = 6e-5;
  const Renderer rolling(paintedRoom(), testCameras()[1], options);
  const Renderer global(paintedRoom(), testCameras()[1], noiseless());
  const cv::Mat image = rolling.render(handheld(), 3.0, 1);
  EXPECT_GT(cv::norm(image.row(470), global.render(handheld(), 3.0, 1).row(470), cv::NORM_L1),
            640.0);
  for (const int row : {0, 100, 237, 479}) {
    const cv::Mat expected = global.render(handheld(), 3.0 + row * options.line_delay_s, 1);
    EXPECT_LE(cv::norm(image.row(row), expected.row(row), cv::NORM_INF), 1.0) << "row " << row;
  }
}

TEST(Renderer, ExposureAveragesOverItsTime) {
  RendererOptions options = noiseless();
  options.exposure_s = 0.03;
  options.blur_images = 2;
  const Renderer blurred(paintedRoom(), testCameras()[0], options);
  const Renderer sharp(paintedRoom(), testCameras()[0], noiseless());
  const cv::Mat image = blurred.render(handheld(), 3.0, 1);
  const cv::Mat early = sharp.light(handheld().worldFromCamera(2.9925));
  const cv::Mat late = sharp.light(handheld().worldFromCamera(3.0075));
  cv::Mat mean, expected;
  cv::addWeighted(early, 0.5, late, 0.5, 0.0, mean);
  mean.convertTo(expected, CV_8U);
  EXPECT_LE(cv::norm(image, expected, cv::NORM_INF), 1.0);
  EXPECT_GT(cv::norm(early, late, cv::NORM_L1), 2.0 * 640 * 480);
}

TEST(Renderer, GainAndVignettingScaleTheLight) {
  RendererOptions options = noiseless();
  const Camera camera = testCameras()[0];
  const Rigid3 pose = handheld().worldFromCamera(3.0);
  const cv::Mat light = Renderer(paintedRoom(), camera, options).light(pose);
  options.sensor.gain = 0.8;
  options.sensor.vignetting = 0.5;
  const cv::Mat image = Renderer(paintedRoom(), camera, options).render(pose, 1);
  EXPECT_NEAR(image.at<std::uint8_t>(238, 321), 0.8 * light.at<float>(238, 321), 1.0);
  EXPECT_NEAR(image.at<std::uint8_t>(479, 0), 0.4 * light.at<float>(479, 0), 1.5);
}

TEST(Renderer, RefusesImpossibleOptions) {
  RendererOptions options;
  options.sensor.noise_sigma = -1.0;
  options.threads = 0;
  EXPECT_EQ(options.problems().size(), 2u);
  EXPECT_THROW(Renderer(paintedRoom(), testCameras()[0], options), std::invalid_argument);
  EXPECT_THROW(Renderer(paintedRoom(), Camera(), RendererOptions()), std::invalid_argument);
  EXPECT_THROW(Renderer(nullptr, testCameras()[0], RendererOptions()), std::invalid_argument);
}

}  // namespace
}  // namespace camera_self_calibration
