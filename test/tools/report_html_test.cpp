#include "camera_self_calibration/tools/report_html.h"

#include <gtest/gtest.h>

#include <string>

#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/pixel_distance.h"

namespace camera_self_calibration {
namespace {

// Two seconds in which nothing was learnt.
Recording shortRecording() {
  Recording recording;
  recording.frames = 40;
  recording.keyframes = 8;
  recording.begin_ns = 1000000000;
  recording.end_ns = 3000000000;
  recording.processing_seconds = 0.5;
  recording.final_report.stamp_ns = recording.end_ns;
  recording.final_report.camera = Camera::defaultGuess(CameraModel::kFov, 640, 480);
  recording.final_report.sentence = "the camera has not moved enough yet";
  recording.final_report.hint = "turn it about two axes";
  return recording;
}

RunDescription run() {
  RunDescription description;
  description.input = "/videos/a & b.bag";
  description.topic = "/cam0/image_raw";
  description.converged_pixel_rms = 1.0;
  description.date = "2026-01-02";
  return description;
}

std::string page(const RunDescription& description, const Recording& recording) {
  return reportHtml(description, recording, {}, {});
}

// With an estimate: sigmas of 0.5 px in the focal lengths and the principal point.
Recording estimatedRecording() {
  Recording recording = shortRecording();
  CalibrationReport& report = recording.final_report;
  report.covariance = IntrinsicsMatrix::Zero(5, 5);
  report.covariance.diagonal() << 0.25, 0.25, 0.25, 0.25, 1e-6;
  report.uncertainty = {0.6, 2.0};
  return recording;
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(ReportHtml, NamesTheInputAndSaysTheVerdictInSentences) {
  const std::string text = page(run(), shortRecording());
  EXPECT_TRUE(has(text, "<title>Camera calibration: a &amp; b.bag</title>"));
  EXPECT_TRUE(has(text, "/cam0/image_raw"));
  EXPECT_TRUE(has(text, "The camera has not moved enough yet. Turn it about two axes."));
  EXPECT_TRUE(has(text, "WAITING_FOR_MOTION"));
  EXPECT_TRUE(has(text, "the limit is 1.00 px."));
  EXPECT_TRUE(has(text, "the defaults"));
}

// Names of topics, files and options come from elsewhere: none of them becomes a part of the page.
TEST(ReportHtml, TextFromElsewhereStaysText) {
  const std::string hostile = "<script>alert('x')</script>\"&";
  RunDescription description = run();
  description.input = description.topic = description.options = description.date = hostile;
  Recording recording = shortRecording();
  recording.final_report.sentence = recording.final_report.hint = hostile;
  recording.events.push_back({EventType::kInput, recording.begin_ns, recording.begin_ns, hostile});
  const std::string text = page(description, recording);
  EXPECT_FALSE(has(text, "<script>alert"));
  EXPECT_TRUE(has(text, "&lt;script&gt;alert"));
}

// One file, no network.
TEST(ReportHtml, FetchesNothing) {
  const std::string text = page(run(), shortRecording());
  for (const char* word : {"src=\"http", "href=\"http", "@import", "url(http"}) {
    EXPECT_FALSE(has(text, word)) << word;
  }
}

TEST(ReportHtml, WhatWasNotComputedHasNoSection) {
  const std::string text = page(run(), shortRecording());
  for (const char* title : {"Residuals", "Trajectory", "Against the reference calibration",
                            "Events", "Comparison of lens models"}) {
    EXPECT_FALSE(has(text, std::string(">") + title + "<")) << title;
  }
  Recording recording = shortRecording();
  recording.events.push_back({EventType::kLost, 2500000000, 2500000000, "tracking was lost"});
  EXPECT_TRUE(has(page(run(), recording), ">Events<"));
  EXPECT_TRUE(has(page(run(), recording), "Tracking was lost."));
  recording.reference = recording.final_report.camera;
  EXPECT_TRUE(has(page(run(), recording), ">Against the reference calibration<"));
}

TEST(ReportHtml, SaysWhatSigmasAndTheMapOfTheErrorLeaveOut) {
  Recording recording = estimatedRecording();
  EXPECT_TRUE(has(page(run(), recording), "It contains no misfit of the lens model"));
  EXPECT_TRUE(has(page(run(), recording), "which is not known yet."));
  LensFitReport& fit = recording.final_report.lens_fit;
  fit.compared = true;
  EXPECT_TRUE(has(page(run(), recording), "compared with richer lenses, that is nothing."));
  fit.misfit = {0.42, 1.3};
  EXPECT_TRUE(has(page(run(), recording),
                  "compared with richer lenses 0.420 px rms over the image, 1.300 px at the worst "
                  "place. Squares add: with it, the expected error is 0.600 px rms."));
}

// Its scale ends with the largest error.
TEST(ReportHtml, TheMapOfTheErrorContainsWhatHalvesDisagree) {
  Recording recording = estimatedRecording();
  CalibrationReport& report = recording.final_report;
  const double largest = pixelUncertainty(report.camera, report.covariance).max;
  EXPECT_TRUE(has(page(run(), recording), formatted(">%.3g px<", largest)));
  report.cross_validation = {true, 7.0, 1.0, 1e-6};
  EXPECT_FALSE(has(page(run(), recording), formatted(">%.3g px<", largest)));
  EXPECT_TRUE(has(page(run(), recording), formatted(">%.3g px<", 7.0 * largest)));
}

TEST(ReportHtml, SaysHowLikelyOtherLensModelsAre) {
  Recording recording = shortRecording();
  recording.final_report.models = {
      {"fov", true, 0.0}, {"pinhole", false, 38.0}, {"radtan", false, INFINITY}};
  const std::string text = page(run(), recording);
  EXPECT_TRUE(has(text, ">Comparison of lens models<"));
  EXPECT_TRUE(has(text, "10^17"));
  EXPECT_TRUE(has(text, "cannot fit the video"));
  EXPECT_FALSE(has(text, "nats"));
}

TEST(ReportHtml, ARunThatWasStoppedSaysSo) {
  Recording recording = shortRecording();
  EXPECT_FALSE(has(page(run(), recording), kPartial));
  recording.complete = false;
  EXPECT_TRUE(has(page(run(), recording), kPartial));
}

// Line by line the same but for the one that says when and how fast the program ran.
TEST(ReportHtml, OnlyOneLineDependsOnTheRun) {
  RunDescription later = run();
  later.date = "2026-11-11";
  Recording slower = shortRecording();
  slower.processing_seconds = 7.0;
  const std::string a = page(run(), shortRecording()), b = page(later, slower);
  const auto withoutRun = [](std::string text) {
    const std::size_t begin = text.find("<p id=\"run\">");
    EXPECT_NE(begin, std::string::npos);
    return text.erase(begin, text.find('\n', begin) - begin);
  };
  EXPECT_NE(a, b);
  EXPECT_EQ(withoutRun(a), withoutRun(b));
}

}  // namespace
}  // namespace camera_self_calibration
