// Images as cameras make them, rendered; the long series is test/benchmark/rough_images_benchmark.

#include <gtest/gtest.h>

#include "benchmark/rough_sequence.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/pipeline/self_calibrator.h"

namespace camera_self_calibration {
namespace {

struct Outcome {
  CalibrationReport report;
  double error_px = 0.0;
  double worst_z = 0.0;  // of the intrinsics
  int lost = 0;
};

RoughVideo smallVideo() {
  RoughVideo video;
  video.duration_s = 9.0;
  video.scale = 0.5;
  video.seed = 4;
  return video;
}

Outcome calibrate(const RoughVideo& video, const Roughness& roughness) {
  Options options;
  options.model = video.model;
  Outcome outcome;
  Callbacks callbacks;
  callbacks.event = [&outcome](const Event& event) {
    outcome.lost += event.type == EventType::kLost;
  };
  SelfCalibrator calibrator(options, SelfCalibrator::Mode::kInline, callbacks);
  const Camera truth =
      renderRough(video, roughness, [&](const ImageView& image) { calibrator.process(image); });
  outcome.report = calibrator.calibration();
  outcome.error_px = pixelDistance(truth, outcome.report.camera).rms;
  for (Eigen::Index i = 0; i < outcome.report.covariance.rows(); ++i) {
    const double off = outcome.report.camera.parameters()(i) - truth.parameters()(i);
    outcome.worst_z =
        std::max(outcome.worst_z, std::abs(off) / std::sqrt(outcome.report.covariance(i, i)));
  }
  std::cout << roughness.name << ": " << outcome.error_px << " px, sigma "
            << outcome.report.uncertainty.rms << " px, worst z " << outcome.worst_z << ", shutter "
            << describe(outcome.report.shutter) << '\n';
  return outcome;
}

void expectHonest(const Outcome& outcome) {
  EXPECT_EQ(outcome.report.state, CalibrationState::kConverged) << outcome.report.sentence;
  EXPECT_LT(outcome.error_px, 3.0 * outcome.report.uncertainty.rms);
  EXPECT_LT(outcome.worst_z, 4.0);
  EXPECT_EQ(outcome.lost, 0);
}

TEST(RoughImages, RollingShutter) {
  Roughness rolling;
  rolling.name = "rolling";
  rolling.readout_s = 0.015;
  const Outcome outcome = calibrate(smallVideo(), rolling);
  expectHonest(outcome);
  EXPECT_TRUE(outcome.report.shutter.rolls);
  EXPECT_NEAR(outcome.report.shutter.readout_s, 0.015, 3.0 * outcome.report.shutter.sigma_s);
}

TEST(RoughImages, ExposureJumpsNoiseAndCompression) {
  Roughness rough;
  rough.name = "exposure jumps, noise, JPEG, vignetting, drops";
  rough.exposure_jumps_s = 0.7;
  rough.noise_sigma = 6.0;
  rough.jpeg_quality = 40;
  rough.vignetting = 0.5;
  rough.dropped_share = 0.1;
  expectHonest(calibrate(smallVideo(), rough));
}

TEST(RoughImages, MovingObjectsTextAndAutomaticExposure) {
  Roughness rough;
  rough.name = "moving objects, text, automatic exposure";
  rough.moving_share = 0.1;
  rough.text_overlay = true;
  rough.auto_exposure = true;
  RoughVideo video = smallVideo();
  video.duration_s = 15.0;  // after 9 and 11 s segments of this seed disagree
  expectHonest(calibrate(video, rough));
}

// As a robot's arm does, over a third of the image.
TEST(RoughImages, WhatTheCameraCarries) {
  Roughness rough;
  rough.name = "carried along";
  rough.carried_share = 0.3;
  RoughVideo video = smallVideo();
  video.duration_s = 12.0;
  expectHonest(calibrate(video, rough));
}

}  // namespace
}  // namespace camera_self_calibration
