#include "camera_self_calibration/tools/report_html.h"

#include <gtest/gtest.h>

#include <string>

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
