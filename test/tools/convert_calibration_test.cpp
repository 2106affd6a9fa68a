// The programs convert_calibration and compare_calibration as a user runs them.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/tools/calibration_file.h"
#include "tools/temporary_folder.h"

namespace camera_self_calibration {
namespace {

std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

struct Outcome {
  int exit_code = -1;
  std::string output;  ///< Standard output and error.
};

Outcome run(const std::string& command) {
  const TemporaryFolder folder;
  const int status = std::system((command + " > " + (folder / "log") + " 2>&1").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(folder / "log")};
}

Outcome convert(const std::string& arguments) {
  return run(std::string(CONVERT_CALIBRATION) + " " + arguments);
}

Outcome compare(const std::string& arguments) {
  return run(std::string(COMPARE_CALIBRATION) + " " + arguments);
}

bool mentions(const Outcome& outcome, const std::string& words) {
  return outcome.output.find(words) != std::string::npos;
}

void writeText(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

constexpr const char* kFov =
    "model: fov\nwidth: 640\nheight: 480\nparams: [311.2, 309.8, 327.4, 233.1, 0.93]\n";

class Conversion : public ::testing::Test {
 protected:
  Conversion() { writeText(fov, kFov); }

  /// Of a CameraInfo that holds this, ROS to ROS: what is lost is said, and "exact" is not all.
  void expectLossSaid(const std::string& held, const std::string& words) const {
    const std::string in = folder / "in.yaml";
    writeText(in,
              "height: 480\nwidth: 640\ndistortion_model: plumb_bob\nD: [0, 0, 0, 0, 0]\n"
              "K: [400, 0, 320, 0, 400, 240, 0, 0, 1]\n" +
                  held);
    const Outcome outcome = convert(in + " " + (folder / "out.yaml") + " --to ros");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_TRUE(mentions(outcome, words)) << outcome.output;
    EXPECT_FALSE(mentions(outcome, "\nexact")) << outcome.output;
  }

  const TemporaryFolder folder;
  const std::string fov = folder / "fov.yaml";
};

TEST_F(Conversion, RoundAboutThroughAllFormatsStaysWithinTheFit) {
  std::string from = fov;
  for (const char* format : {"colmap", "kalibr", "ros", "opencv", "orbslam3", "vins", "plain"}) {
    const std::string to = folder / (std::string(format) + ".txt");
    const Outcome outcome = convert(from + " " + to + " --to " + format);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.output;
    EXPECT_EQ(mentions(outcome, "fitted"), std::string(format) == "ros") << outcome.output;
    EXPECT_EQ(mentions(outcome, "exact"), std::string(format) != "ros") << outcome.output;
    from = to;
  }
  EXPECT_LT(pixelDistance(readCalibrationFile(fov), readCalibrationFile(from)).max, 0.05);
}

TEST_F(Conversion, TheFitIsNotedInTheFile) {
  const std::string out = folder / "cam0.yaml";
  ASSERT_EQ(convert(fov + " " + out + " --to vins --name front").exit_code, 0);
  EXPECT_NE(contents(out).find("# fitted to fov"), std::string::npos) << contents(out);
  EXPECT_NE(contents(out).find("camera_name: front"), std::string::npos);
  EXPECT_EQ(contents(out).rfind("%YAML:1.0\n---\n", 0), 0u) << "OpenCV insists on it";
}

TEST_F(Conversion, ALostRectificationIsSaid) {
  expectLossSaid(
      "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
      "P: [400, 0, 320, -50, 0, 400, 240, 0, 0, 0, 1, 0]\n",
      "rectification of IN");
}

TEST_F(Conversion, ALostBinningIsSaid) {
  expectLossSaid("binning_x: 2\nbinning_y: 2\n", "full resolution, 640 x 480");
}

TEST_F(Conversion, TheNameOfTheCameraIsKept) {
  const std::string named = folder / "named.yaml";
  ASSERT_EQ(convert(fov + " " + named + " --to ros --name front_left").exit_code, 0);
  for (const char* format : {"ros", "vins"}) {
    const std::string out = folder / format;
    ASSERT_EQ(convert(named + " " + out + " --to " + format).exit_code, 0);
    EXPECT_NE(contents(out).find("camera_name: front_left\n"), std::string::npos) << contents(out);
    ASSERT_EQ(convert(out + " " + (folder / "back") + " --to ros --name other").exit_code, 0);
    EXPECT_NE(contents(folder / "back").find("camera_name: other\n"), std::string::npos);
  }
  ASSERT_EQ(convert(fov + " " + (folder / "nameless") + " --to ros").exit_code, 0);
  EXPECT_NE(contents(folder / "nameless").find("camera_name: camera\n"), std::string::npos);
}

TEST_F(Conversion, WhatTheFormatDoesNotHoldIsRefused) {
  for (const char* option : {"--name left", "--topic /image", "--rate 20"}) {
    const Outcome outcome =
        convert(fov + " " + (folder / "out.txt") + " --to colmap " + std::string(option));
    EXPECT_EQ(outcome.exit_code, 1) << option;
    EXPECT_TRUE(mentions(outcome, "has no meaning for the format colmap")) << outcome.output;
  }
  EXPECT_EQ(convert(fov + " " + (folder / "k") + " --to kalibr --topic /image").exit_code, 0);
  EXPECT_EQ(convert(fov + " " + (folder / "o") + " --to orbslam3 --rate 20").exit_code, 0);
}

TEST_F(Conversion, ALimitIsANumberOfPixels) {
  for (const char* option : {"--limit nan", "--limit inf", "--limit 0", "--radius inf"}) {
    const Outcome outcome = compare(fov + " " + fov + " " + option);
    EXPECT_EQ(outcome.exit_code, 1) << option;
    EXPECT_TRUE(mentions(outcome, "must be a positive number of pixels")) << outcome.output;
  }
}

TEST_F(Conversion, ErrorsSayWhatToDo) {
  EXPECT_EQ(convert("--help").exit_code, 0);
  const Outcome nothing = convert("");
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_TRUE(mentions(nothing, "--help"));
  EXPECT_TRUE(mentions(convert(fov + " x.yaml --to matlab"), "orbslam3"));
  EXPECT_TRUE(mentions(convert((folder / "none.yaml") + " x.yaml --to ros"), "No such file"));
  EXPECT_TRUE(mentions(convert(folder.string() + " x.yaml --to ros"), "is a folder"));
  EXPECT_TRUE(mentions(convert(fov + " " + fov + " --to ros"), "same file"));
  EXPECT_EQ(contents(fov), kFov) << "the original is untouched";
  const Outcome unwritable = convert(fov + " " + (folder / "no/folder.yaml") + " --to ros");
  EXPECT_EQ(unwritable.exit_code, 1);
  EXPECT_TRUE(mentions(unwritable, "No such file")) << unwritable.output;
  writeText(folder / "bad.yaml", "just text");
  EXPECT_TRUE(mentions(convert((folder / "bad.yaml") + " x.yaml --to ros"), "none of the formats"));
}

TEST(Programs, HelpNeedsNoMaster) {
  const std::vector<std::pair<const char*, const char*>> programs = {
      {SIMULATED_CAMERA, "publish_clock"},
      {CHECK_AGAINST_TRUTH, "_limit"},
      {SELF_CALIBRATION_NODE, "config/parameters.yaml"},
      {RIG_CALIBRATION_NODE, "config/rig.yaml"}};
  for (const auto& [program, words] : programs) {
    for (const char* arguments : {"--help", "_model:=fov -h"}) {
      const Outcome help = run("ROS_MASTER_URI=http://localhost:1 timeout 30 " +
                               std::string(program) + " " + arguments);
      EXPECT_EQ(help.exit_code, 0) << help.output;
      EXPECT_TRUE(mentions(help, words)) << help.output;
    }
  }
}

TEST_F(Conversion, ARefusedConversionLeavesTheOldFile) {
  writeText(folder / "old.yaml", kFov);
  writeText(folder / "bad.yaml", "model: fov\nwidth: 640\nheight: 480\nparams: [1, 2]\n");
  EXPECT_EQ(convert((folder / "bad.yaml") + " " + (folder / "old.yaml") + " --to ros").exit_code,
            1);
  EXPECT_EQ(contents(folder / "old.yaml"), kFov);
}

TEST_F(Conversion, ComparesAcrossFormatsAndDraws) {
  ASSERT_EQ(convert(fov + " " + (folder / "cameras.txt") + " --to colmap").exit_code, 0);
  const std::string same = fov + " " + (folder / "cameras.txt");
  const Outcome equal = compare(same + " --limit 0.001");
  EXPECT_EQ(equal.exit_code, 0) << equal.output;
  EXPECT_TRUE(mentions(equal, "distance 0.000 px rms")) << equal.output;

  writeText(folder / "other.yaml",
            "model: fov\nwidth: 640\nheight: 480\nparams: [314.2, 312.8, 327.4, 233.1, 0.93]\n");
  const std::string picture = folder / "difference.png";
  const Outcome other =
      compare(fov + " " + (folder / "other.yaml") + " --limit 0.5 --out " + picture);
  EXPECT_EQ(other.exit_code, 2) << other.output;
  EXPECT_TRUE(mentions(other, "B - A"));
  EXPECT_EQ(cv::imread(picture).cols, 1000);
}

TEST_F(Conversion, DifferentSizesAreNotCompared) {
  writeText(folder / "small.yaml",
            "model: fov\nwidth: 320\nheight: 240\nparams: [155, 155, 163, 116, 0.93]\n");
  const Outcome outcome = compare(fov + " " + (folder / "small.yaml"));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(mentions(outcome, "640 x 480")) << outcome.output;
}

}  // namespace
}  // namespace camera_self_calibration
