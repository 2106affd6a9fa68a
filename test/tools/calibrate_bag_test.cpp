// The program calibrate_bag as a user runs it: exit codes, messages and files.

#include <camera_calibration_parsers/parse.h>
#include <gtest/gtest.h>
#include <std_msgs/String.h>
#include <sys/wait.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <regex>
#include <sstream>
#include <vector>

#include "camera_self_calibration/base/stamp.h"
#include "camera_self_calibration/simulation/sequence_writer.h"
#include "camera_self_calibration/simulation/tum_file.h"
#include "camera_self_calibration/tools/calibration_file.h"
#include "camera_self_calibration/tracking/image_motion.h"
#include "tools/child_program.h"
#include "tools/small_sequence.h"
#include "tools/temporary_folder.h"

namespace camera_self_calibration {
namespace {

std::string contents(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::size_t linesOf(const std::string& path) {
  const std::string text = contents(path);
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

// Keyframes on the last images: how features move in them is not known yet.
std::size_t notHandedOn(const std::string& out) {
  const std::vector<StampedPose> images = readTum(out + "trajectory.tum");
  const double handed_on = images[images.size() - 1 - MotionHistory::kReach].time_s;
  const std::vector<StampedPose> keyframes = readTum(out + "keyframes.tum");
  return static_cast<std::size_t>(
      std::count_if(keyframes.begin(), keyframes.end(),
                    [=](const StampedPose& keyframe) { return keyframe.time_s > handed_on; }));
}

struct Outcome {
  int exit_code = -1;
  std::string output;  ///< Standard output and error.
};

Outcome calibrateBag(const std::string& arguments) {
  const TemporaryFolder folder;
  const std::string command =
      std::string(CALIBRATE_BAG) + " " + arguments + " > " + (folder / "log") + " 2>&1";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(folder / "log")};
}

bool mentions(const Outcome& outcome, const std::string& words) {
  return outcome.output.find(words) != std::string::npos;
}

/// One bag and its results, shared by the tests that look at them.
struct ConvergedRun {
  TemporaryFolder folder;
  SequenceOptions truth = smallSequence(MotionKind::kHandheld, 15.0);
  Outcome outcome;

  ConvergedRun() {
    writeBag(folder / "room.bag", "/camera/image_raw/compressed", truth);
    outcome =
        calibrateBag((folder / "room.bag") + " --model fov --report --out " + (folder / "out"));
  }
  std::string out(const std::string& name) const { return folder / ("out/" + name); }
};

const ConvergedRun& converged() {
  static const ConvergedRun run;
  return run;
}

TEST(CalibrateBag, ConvergesToTheTruth) {
  ASSERT_EQ(converged().outcome.exit_code, 0) << converged().outcome.output;
  const YAML::Node summary = YAML::LoadFile(converged().out("summary.json"));
  EXPECT_EQ(summary["state"].as<std::string>(), "CONVERGED");
  const YAML::Node camera = summary["camera"];
  EXPECT_EQ(camera["model"].as<std::string>(), "fov");
  EXPECT_EQ(camera["width"].as<int>(), 320);
  EXPECT_EQ(camera["height"].as<int>(), 240);
  const Camera& truth = converged().truth.lens.camera;
  const std::vector<std::string> names = truth.parameterNames();
  std::size_t i = 0;
  for (const auto& parameter : camera["params"]) {
    ASSERT_LT(i, names.size());
    EXPECT_EQ(parameter.first.as<std::string>(), names[i]) << "in the order of the model";
    const auto sigma = camera["sigma"][names[i]].as<double>();
    EXPECT_NEAR(parameter.second.as<double>(), truth.parameters()[static_cast<Eigen::Index>(i)],
                3.0 * sigma)
        << names[i];
    ++i;
  }
  EXPECT_EQ(i, names.size());
}

TEST(CalibrateBag, SummaryCountsTheRun) {
  const YAML::Node summary = YAML::LoadFile(converged().out("summary.json"));
  const auto frames = summary["frames"].as<std::size_t>();
  const auto keyframes = summary["keyframes"].as<std::size_t>();
  EXPECT_EQ(frames, 301u);
  EXPECT_GT(keyframes, 20u);
  EXPECT_NEAR(summary["frames_per_second"].as<double>(),
              static_cast<double>(frames) / summary["processing_seconds"].as<double>(), 1.0);
  EXPECT_GE(summary["queue"]["segments"].as<int>(), 2);
  EXPECT_GE(summary["queue"]["swaps"].as<int>(), 2);
  EXPECT_LE(summary["pixel_uncertainty"]["rms"].as<double>(), 0.5);
  ASSERT_GE(summary["events"].size(), 2u);
  EXPECT_GT(summary["events"][0]["stamp"].as<double>(), 1.6e9);
  const YAML::Node halves = summary["cross_validation"];
  EXPECT_TRUE(halves["compared"].as<bool>());
  EXPECT_GT(halves["expected_px"].as<double>(), 0.0);
  EXPECT_LE(halves["p_value"].as<double>(), 1.0);
  EXPECT_TRUE(summary["lens_fit"]["compared"].as<bool>());
  EXPECT_TRUE(summary["lens_fit"]["refuted"].IsScalar());
  EXPECT_LE(summary["lens_fit"]["misfit"]["rms"].as<double>(),
            summary["pixel_uncertainty"]["rms"].as<double>());
  // A header line, then one row a keyframe; comment lines begin the trajectories.
  EXPECT_EQ(linesOf(converged().out("convergence.csv")),
            keyframes - notHandedOn(converged().out("")) + 1);
  EXPECT_GT(linesOf(converged().out("trajectory.tum")), frames * 8 / 10);
  EXPECT_LE(linesOf(converged().out("keyframes.tum")), keyframes + 10);
}

TEST(CalibrateBag, WritesCalibrationsForOthers) {
  std::string name;
  sensor_msgs::CameraInfo info;
  ASSERT_TRUE(
      camera_calibration_parsers::readCalibration(converged().out("calibration.yaml"), name, info));
  EXPECT_EQ(info.distortion_model, "equidistant");
  EXPECT_EQ(info.width, 320u);
  const YAML::Node cam0 = YAML::LoadFile(converged().out("camchain.yaml"))["cam0"];
  EXPECT_EQ(cam0["distortion_model"].as<std::string>(), "fov");
}

TEST(CalibrateBag, TheTableOfParametersSaysWhatASigmaContains) {
  EXPECT_TRUE(mentions(converged().outcome, "(sigma: of noise and of segments that disagree"))
      << converged().outcome.output;
  EXPECT_NE(contents(converged().out("report.html")).find("The map does not contain what the lens"),
            std::string::npos);
}

TEST(CalibrateBag, AnApproximationThatNobodyNoticesIsNotSaidOnTheTerminal) {
  EXPECT_FALSE(mentions(converged().outcome, "approximation")) << converged().outcome.output;
  EXPECT_NE(contents(converged().out("calibration.yaml")).find("# fitted to fov: off by"),
            std::string::npos)
      << "the file says what it holds";
}

TEST(CalibrateBag, AnotherSizeIsOneSentence) {
  const TemporaryFolder folder;
  for (int i = 0; i < 20; ++i) {
    const cv::Mat picture(i < 10 ? 48 : 60, 64, CV_8UC1, cv::Scalar(i));
    cv::imwrite(folder / (std::to_string(i) + ".png"), picture);
  }
  const Outcome outcome = calibrateBag(folder.string());
  EXPECT_TRUE(mentions(outcome, "images of 64x60 are left out, since those before have 64x48"))
      << outcome.output;
  EXPECT_FALSE(mentions(outcome, "calibrated anew")) << outcome.output;
  EXPECT_FALSE(mentions(outcome, "size changed")) << outcome.output;
  EXPECT_TRUE(mentions(outcome, "10 images left out"));
}

TEST(CalibrateBag, AMaskOfAnotherShapeIsRefused) {
  const TemporaryFolder folder;
  cv::imwrite(folder / "mask.png", cv::Mat(64, 64, CV_8UC1, cv::Scalar(255)));
  const Outcome outcome =
      calibrateBag((converged().folder / "room.bag") + " --mask " + (folder / "mask.png"));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(mentions(outcome, "the mask is 64 x 64 and does not fit images of"))
      << outcome.output;
}

// Of the same bag: what it says of a calibration.
Outcome audit(const Camera& calibration, const std::string& options, const std::string& out) {
  const TemporaryFolder folder;
  writeCalibration(folder / "given.yaml", calibration, CalibrationFormat::kPlain);
  return calibrateBag((converged().folder / "room.bag") + " --model fov --report --audit " +
                      (folder / "given.yaml") + " --out " + out + options);
}

TEST(CalibrateBag, AuditsACalibration) {
  const TemporaryFolder folder;
  const Camera& truth = converged().truth.lens.camera;
  const Outcome good = audit(truth, "", folder / "good");
  EXPECT_EQ(good.exit_code, 0) << good.output;
  EXPECT_TRUE(mentions(good, "audit: GOOD: The calibration is right")) << good.output;
  Intrinsics p = truth.parameters();
  p.head<2>() *= 1.03;
  const Camera zoomed(truth.model(), truth.width(), truth.height(), p);
  const Outcome wrong = audit(zoomed, " --audit-tolerance 0.5", folder / "wrong");
  EXPECT_EQ(wrong.exit_code, 5) << wrong.output;
  EXPECT_TRUE(mentions(wrong, "audit: WRONG")) << wrong.output;
  const YAML::Node summary = YAML::LoadFile(folder / "wrong/summary.json")["audit"];
  EXPECT_EQ(summary["verdict"].as<std::string>(), "WRONG");
  EXPECT_EQ(summary["likely_cause"].as<std::string>(), "focal_length");
  EXPECT_EQ(summary["tolerance_px"].as<double>(), 0.5);
  EXPECT_GT(summary["distance_px"].as<double>(), 1.0);
  EXPECT_LT(summary["p_value"].as<double>(), 1e-3);
  const std::string page = contents(folder / "wrong/report.html");
  EXPECT_NE(page.find("Is the calibration in question still right?"), std::string::npos);
  EXPECT_EQ(contents(converged().out("report.html")).find("in question"), std::string::npos);
  const Outcome untold = audit(zoomed, " --duration 0.5", folder / "untold");
  EXPECT_EQ(untold.exit_code, 6) << untold.output;
  EXPECT_TRUE(mentions(untold, "audit: CANNOT_TELL")) << untold.output;
  EXPECT_TRUE(YAML::LoadFile(folder / "untold/summary.json")["audit"]["p_value"].IsNull());
}

TEST(CalibrateBag, AnAuditOfDarkImagesCannotTell) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "dark");
  for (const char* name : {"dark/1.png", "dark/2.png", "dark/3.png"}) {
    cv::imwrite(folder / name, cv::Mat::zeros(240, 320, CV_8U));
  }
  std::ofstream(folder / "used.yaml")
      << "model: pinhole\nwidth: 320\nheight: 240\nparams: [250.0, 250.0, 160.0, 120.0]\n";
  const Outcome outcome = calibrateBag((folder / "dark") + " --audit " + (folder / "used.yaml") +
                                       " --out " + (folder / "out"));
  EXPECT_EQ(outcome.exit_code, 6) << outcome.output;
  EXPECT_TRUE(mentions(outcome, "audit: CANNOT_TELL")) << outcome.output;
  const YAML::Node summary = YAML::LoadFile(folder / "out/summary.json");
  EXPECT_EQ(summary["audit"]["verdict"].as<std::string>(), "CANNOT_TELL");
}

// But for the two values of summary.json that may differ.
std::string withoutTimes(const std::string& text) {
  const std::regex times("\"(processing_seconds|frames_per_second)\": [^,]*|<p id=\"run\">.*");
  return std::regex_replace(text, times, "");
}

TEST(CalibrateBag, TheSameInputGivesTheSameFiles) {
  const TemporaryFolder folder;
  const Outcome again =
      calibrateBag((converged().folder / "room.bag") +
                   " --model fov --solver-threads 2 --report --out " + folder.string());
  EXPECT_EQ(again.exit_code, 0);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.string())) {
    const std::string name = entry.path().filename();
    ++files;
    EXPECT_EQ(withoutTimes(contents(entry.path())), withoutTimes(contents(converged().out(name))))
        << name;
  }
  EXPECT_EQ(files, 7u);
}

TEST(CalibrateBag, PlumbBobIsAModel) {
  const Outcome outcome =
      calibrateBag((converged().folder / "room.bag") + " --duration 0.15 --model plumb_bob");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(mentions(outcome, "radtan, 320x240")) << outcome.output;
}

TEST(CalibrateBag, StartValuesAreUsedAndTheirSizeChecked) {
  const std::string bag = converged().folder / "room.bag";
  const TemporaryFolder folder;
  writeTruth(folder / "truth.yaml", converged().truth.lens);
  const Outcome started =
      calibrateBag(bag + " --duration 0.15 --initial " + (folder / "truth.yaml"));
  EXPECT_EQ(started.exit_code, 2);
  EXPECT_TRUE(mentions(started, "158.0")) << started.output;
  Lens other = converged().truth.lens;
  other.camera = Camera::defaultGuess(CameraModel::kFov, 640, 480);
  writeTruth(folder / "other.yaml", other);
  const Outcome refused = calibrateBag(bag + " --initial " + (folder / "other.yaml"));
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_TRUE(mentions(refused, "640x480")) << refused.output;
}

TEST(CalibrateBag, OptionsOfTheMethodReachIt) {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& options, const std::string& file) {
    calibrateBag((converged().folder / "room.bag") + " --duration 4 --out " + folder.string() +
                 " " + options);
    return contents(folder / file);
  };
  const std::string reference = run("", "convergence.csv");
  EXPECT_GT(reference.size(), 1000u);
  EXPECT_NE(run("--exact-references", "convergence.csv"), reference);
  const TemporaryFolder masks;
  cv::Mat mask(30, 40, CV_8UC1, cv::Scalar(255));
  cv::imwrite(masks / "white.png", mask);
  mask.rowRange(15, 30).setTo(0);
  cv::imwrite(masks / "half.png", mask);
  const std::string white = std::filesystem::relative(masks / "white.png").string();
  EXPECT_EQ(run("--mask " + white, "convergence.csv"), reference);
  EXPECT_NE(run("--mask " + (masks / "half.png"), "convergence.csv"), reference);
  // No pixel uncertainty is small enough here, so that only the entropy can hand over.
  const std::string never = "--converged-pixel-rms 0.0001";
  EXPECT_EQ(run(never, "summary.json").find("HANDOVER"), std::string::npos);
  EXPECT_NE(run(never + " --handover-entropy 1000", "summary.json").find("HANDOVER"),
            std::string::npos);
}

/// The converged run once more, with all that it can be compared with.
struct ComparedRun {
  TemporaryFolder folder;
  Outcome outcome;

  ComparedRun() {
    const SimulatedSequence sequence(converged().truth);
    std::vector<StampedPose> poses;
    for (int i = 0; i < sequence.size(); ++i) {
      poses.push_back({toSeconds(sequence.stampNs(i)), sequence.worldFromCamera(i)});
    }
    writeTum(folder / "truth.tum", poses);
    writeTruth(folder / "truth.yaml", converged().truth.lens);
    outcome = calibrateBag((converged().folder / "room.bag") + " --out " + (folder / "out") +
                           " --batch --report --reference-calibration " + (folder / "truth.yaml") +
                           " --ground-truth " + (folder / "truth.tum"));
  }
  YAML::Node summary() const { return YAML::LoadFile(folder / "out/summary.json"); }
};

const ComparedRun& compared() {
  static const ComparedRun run;
  return run;
}

TEST(CalibrateBag, TheBatchOfTheWholeTrajectoryAgrees) {
  ASSERT_EQ(compared().outcome.exit_code, 0) << compared().outcome.output;
  EXPECT_TRUE(mentions(compared().outcome, "whole-trajectory batch"));
  const YAML::Node summary = compared().summary();
  const YAML::Node batch = summary["batch"];
  ASSERT_TRUE(batch.IsMap());
  EXPECT_EQ(batch["keyframes"].as<std::size_t>(),
            summary["keyframes"].as<std::size_t>() - notHandedOn(compared().folder / "out/"));
  EXPECT_LT(batch["distance_px_rms"].as<double>(),
            3.0 * summary["pixel_uncertainty"]["rms"].as<double>());
  const Camera& truth = converged().truth.lens.camera;
  Eigen::Index i = 0;
  for (const std::string& name : truth.parameterNames()) {
    const auto sigma = batch["sigma"][name].as<double>();
    EXPECT_LT(sigma, summary["camera"]["sigma"][name].as<double>()) << name;
    EXPECT_NEAR(batch["params"][name].as<double>(), truth.parameters()[i++], 4.0 * sigma) << name;
  }
  for (const char* figure :
       {"fig4_parameters.png", "fig5_focal_length.png", "fig7_queue_sizes.png"}) {
    const cv::Mat image = cv::imread(compared().folder / ("out/" + std::string(figure)));
    EXPECT_GT(image.cols, 1000) << figure;
  }
}

TEST(CalibrateBag, TheTrajectoryIsComparedWithTheReferenceAndTheTruth) {
  const YAML::Node trajectory = compared().summary()["trajectory"];
  EXPECT_LT(trajectory["reference_after_handover"]["share_of_way"].as<double>(), 0.01);
  EXPECT_GT(trajectory["reference_until_handover"]["poses"].as<int>(), 20);
  const YAML::Node truth = trajectory["ground_truth_after_handover"];
  EXPECT_GT(truth["travelled"].as<double>(), 2.0);
  EXPECT_LT(truth["ate_rms"].as<double>(), 0.01 * truth["travelled"].as<double>());
  EXPECT_LT(truth["rpe_rotation_deg_rms"].as<double>(), 0.5);
  EXPECT_TRUE(mentions(compared().outcome, "ATE"));
}

TEST(CalibrateBag, TheReportStandsByItself) {
  const std::string page = contents(compared().folder / "out/report.html");
  EXPECT_GT(page.size(), 200000u);
  for (const char* part :
       {"Camera calibration: room.bag", "CONVERGED", "Why this verdict", "Parameters",
        "Calibration to copy", "distortion_model: equidistant", "An example image",
        "Where the calibration can be trusted", "Convergence", "Which seconds informed the result",
        "Residuals", "Comparison of lens models", "Trajectory", "Against the reference calibration",
        "Events"}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(page.find("http"), std::string::npos) << "nothing is fetched";
  EXPECT_EQ(page.find("<script"), std::string::npos);
  const auto count = [&](const std::string& tag) {
    std::size_t found = 0;
    for (std::size_t at = page.find(tag); at != std::string::npos; at = page.find(tag, at + 1)) {
      ++found;
    }
    return found;
  };
  EXPECT_GE(count("<figure><svg"), 12u);
  EXPECT_EQ(count("<img alt"), 2u) << "an image with its tracks, and undistorted";
  EXPECT_EQ(count("<svg"), count("</svg>"));
}

TEST(CalibrateBag, TheReportNamesTheRun) {
  const std::string page = contents(compared().folder / "out/report.html");
  for (const std::string& part :
       {converged().folder / "room.bag", std::string("/camera/image_raw/compressed"),
        std::string("--batch --reference-calibration "), std::string("<p id=\"run\">Run on 20"),
        std::string("\u00b0 horizontal")}) {
    EXPECT_NE(page.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(page.find("--out"), std::string::npos) << "has no influence on the result";
  EXPECT_NE(contents(converged().out("report.html")).find("--model fov<"), std::string::npos);
}

TEST(CalibrateBag, AStillCameraDoesNotConverge) {
  const TemporaryFolder folder;
  writeSequence(SimulatedSequence(smallSequence(MotionKind::kStill, 2.0)), folder / "images",
                "png");
  std::filesystem::create_directory(folder / "out");
  std::ofstream(folder / "out/calibration.yaml") << "from an earlier run";
  std::ofstream(folder / "out/summary.json") << "{}";
  const Outcome outcome =
      calibrateBag((folder / "images") + " --rate 20 --batch --report --out " + (folder / "out"));
  EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
  const YAML::Node summary = YAML::LoadFile(folder / "out/summary.json");
  EXPECT_EQ(summary["state"].as<std::string>(), "WAITING_FOR_MOTION");
  EXPECT_TRUE(summary["camera"]["sigma"]["fx"].IsNull());
  EXPECT_TRUE(summary["pixel_uncertainty"]["rms"].IsNull());
  EXPECT_EQ(summary["frames"].as<int>(), 41);
  const YAML::Node halves = summary["cross_validation"];
  EXPECT_FALSE(halves["compared"].as<bool>());
  for (const char* figure : {"cross_difference_px", "expected_px", "p_value"}) {
    EXPECT_TRUE(halves[figure].IsNull()) << figure;
  }
  const YAML::Node fit = summary["lens_fit"];
  EXPECT_FALSE(fit["compared"].as<bool>());
  for (const YAML::Node& figure :
       {fit["refuted"], fit["misfit"]["rms"], fit["misfit"]["max"], fit["misfit_observed"]["rms"],
        fit["undescribed_share"], summary["observed"]["share"]}) {
    EXPECT_TRUE(figure.IsNull()) << figure;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out/calibration.yaml"))
      << "an older file must not pass for the result";
  EXPECT_TRUE(summary["batch"].IsNull());
  EXPECT_NE(contents(folder / "out/report.html").find("WAITING_FOR_MOTION"), std::string::npos);
}

TEST(CalibrateBag, InterruptedItWritesWhatIsKnownAndSaysSo) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const TemporaryFolder folder;
    ChildProgram program(
        {CALIBRATE_BAG, converged().folder / "room.bag", "--report", "--out", folder / "out"});
    ASSERT_TRUE(program.says("frame ")) << program.text();
    program.send(signal);
    EXPECT_TRUE(program.says("partial")) << program.text();
    EXPECT_EQ(program.wait(), 4);
    const YAML::Node summary = YAML::LoadFile(folder / "out/summary.json");
    EXPECT_FALSE(summary["complete"].as<bool>());
    EXPECT_GT(summary["frames"].as<int>(), 0);
    EXPECT_LT(summary["frames"].as<int>(), 301);
    EXPECT_EQ(contents(folder / "out/trajectory.tum").rfind("# PARTIAL", 0), 0u);
    EXPECT_NE(contents(folder / "out/report.html").find("PARTIAL"), std::string::npos);
  }
  EXPECT_TRUE(YAML::LoadFile(converged().out("summary.json"))["complete"].as<bool>());
  EXPECT_EQ(contents(converged().out("report.html")).find("PARTIAL"), std::string::npos);
}

TEST(CalibrateBag, NoImagesIsACodeOfItsOwn) {
  const TemporaryFolder folder;
  EXPECT_EQ(calibrateBag(folder.string()).exit_code, 3);
  { rosbag::Bag bag(folder / "empty.bag", rosbag::bagmode::Write); }
  EXPECT_EQ(calibrateBag(folder / "empty.bag").exit_code, 3);
  {
    rosbag::Bag bag(folder / "text.bag", rosbag::bagmode::Write);
    bag.write("chatter", ros::Time(1.0), std_msgs::String());
  }
  const Outcome outcome = calibrateBag(folder / "text.bag");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_TRUE(mentions(outcome, "no images"));
}

TEST(CalibrateBag, NoFolderIsLeftWhereNothingCameOfIt) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "images");
  EXPECT_EQ(calibrateBag((folder / "images") + " --out " + (folder / "new/out")).exit_code, 3);
  EXPECT_FALSE(std::filesystem::exists(folder / "new"));
  std::filesystem::create_directory(folder / "old");
  EXPECT_EQ(calibrateBag((folder / "images") + " --out " + (folder / "old")).exit_code, 3);
  EXPECT_TRUE(std::filesystem::exists(folder / "old")) << "it was there before";
}

TEST(CalibrateBag, FilesThatItHasNotWrittenStay) {
  const std::string bag = converged().folder / "room.bag";
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "mine");
  for (const char* name : {"calibration.yaml", "trajectory.tum"}) {
    const std::string file = folder / ("mine/" + std::string(name));
    std::ofstream(file) << "mine";
    const Outcome outcome = calibrateBag(bag + " --duration 1 --out " + (folder / "mine"));
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_TRUE(mentions(outcome, "not the result of an earlier run")) << outcome.output;
    EXPECT_EQ(contents(file), "mine");
    std::filesystem::remove(file);
  }
  std::filesystem::create_directory(folder / "mine/cam1");
  std::ofstream(folder / "mine/cam1/calibration.yaml") << "mine";
  EXPECT_TRUE(mentions(calibrateBag(bag + " --topics /a /b --out " + (folder / "mine")),
                       "cam1/calibration.yaml would be replaced"));
  // Nor does what it has written go where it is to be judged or started from.
  std::filesystem::copy(converged().folder / "out", folder / "out");
  const std::string calibration = folder / "out/calibration.yaml";
  const std::string bytes = contents(calibration);
  for (const char* option : {"--audit", "--initial", "--reference-calibration"}) {
    const Outcome outcome = calibrateBag(bag + " --duration 1 --out " + (folder / "out") + " " +
                                         option + " " + calibration);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_TRUE(mentions(outcome, "in the folder of --out")) << outcome.output;
    EXPECT_EQ(contents(calibration), bytes);
  }
  std::ofstream(folder / "notes.txt") << "mine";
  const Outcome outcome =
      calibrateBag(bag + " --duration 1 --overwrite --state-out " + (folder / "notes.txt"));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(mentions(outcome, "not a state file of this program")) << outcome.output;
  EXPECT_EQ(contents(folder / "notes.txt"), "mine");
}

TEST(CalibrateBag, ErrorsSayWhatToDo) {
  const TemporaryFolder folder;
  std::ofstream(folder / "noise.bag") << std::string(5000, 'x');
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "no bag"},
      {folder / "missing.bag", "no file"},
      {folder / "noise.bag", "cannot be read as a bag"},
      {folder.string() + " --model fisheye62", "fisheye62"},
      {folder.string() + " --alpha 2 --queue-segments 0", "alpha"},
      {folder.string() + " --alpha 2 --queue-segments 0", "- queue-segments is 0"},
      {folder.string() + " --initial " + (folder / "missing.yaml"), "cannot be opened"},
      {folder.string() + " --mask " + (folder / "missing.png"), "--mask: there is no file"},
      {folder.string() + " --mask ''", "--mask names no file"},
      {folder.string() + " --topics /a /b --mask mask.png", "--mask is for one camera"},
      {folder.string() + " --speed 3", "--speed"},
      {folder.string() + " --batch --out " + folder.string(), "in the folder of --out"},
      {folder.string() + " --rate=%value%", "holds %value%"},
      {folder.string() + " --%original_token%x=1", "holds %original_token%"},
      {folder.string() + " --rate -3", "--rate is -3"},
      {folder.string() + " --rate inf", "--rate is inf"},
      {folder.string() + " --rate 1e-300", "between 0.001 and"},
      {folder.string() + " --start 1e300", "--start is 1e+300"},
      {folder.string() + " --start nan", "--start is nan"},
      {folder.string() + " --duration inf", "--duration is inf"},
      {folder.string() + " --audit-tolerance inf", "--audit-tolerance"},
      {folder.string() + " --topic /image", "--topic chooses images of a bag"},
      {(folder / "noise.bag") + " --rate 30", "--rate is for folders and videos"},
      {folder.string() + " --camera front", "--camera is about the file of --state-out"},
      {folder.string() + " --overwrite", "--overwrite is about the file of --state-out"},
      {folder.string() + " --report", "--out"},
      {folder.string() + " --topics /a", "two to six"},
      {folder.string() + " --baseline 0.1", "--topics"},
      {folder.string() + " --topics /a /b --baseline -1", "--baseline"},
      {folder.string() + " --topics /a /b --baseline inf", "--baseline"},
      {folder.string() + " --topics /a /b --baseline 1e-320", "between 0.001 and 1000 m"},
      {folder.string() + " --topics /a /b --baseline 1e300", "between 0.001 and 1000 m"},
      {folder.string() + " --topics /a /b --topic /a", "--topic is for one camera"},
      {folder.string() + " --topics /a /b --audit " + (folder / "missing.yaml"),
       "cannot be opened"},
      {folder.string() + " --topics /a /b --report", "--out"},
      {folder.string() + " --ground-truth " + (folder / "missing.tum"), "missing.tum"},
      {folder.string() + " --reference-calibration " + (folder / "missing.yaml"),
       "cannot be opened"}};
  for (const auto& [arguments, words] : cases) {
    const Outcome outcome = calibrateBag(arguments);
    EXPECT_EQ(outcome.exit_code, 1) << arguments;
    EXPECT_TRUE(mentions(outcome, words)) << arguments << ": " << outcome.output;
  }
}

TEST(CalibrateBag, ImagesThatCannotBeUsedAreAnErrorIfThereIsNoOther) {
  const TemporaryFolder folder;
  {
    rosbag::Bag bag(folder / "bad.bag", rosbag::bagmode::Write);
    sensor_msgs::CompressedImage garbage;
    garbage.data.assign(100, 1);
    for (int i = 1; i < 8; ++i) bag.write("image/compressed", ros::Time(i), garbage);
  }
  const Outcome outcome = calibrateBag(folder / "bad.bag");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(mentions(outcome, "none of the 7 images can be used")) << outcome.output;
}

TEST(CalibrateBag, HelpIsHelp) {
  const Outcome outcome = calibrateBag("--help");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* option : {"--model", "--out", "--topic", "--initial", "--start",
                             "--exact-references", "--handover-entropy"}) {
    EXPECT_TRUE(mentions(outcome, option)) << option;
  }
}

TEST(CalibrateBag, AFinishedStateIsNotLearntTwiceNorWrittenOver) {
  const std::string bag = converged().folder / "room.bag";
  const TemporaryFolder folder;
  const std::string state = folder / "room.state";
  const std::string again = bag + " --model fov --camera front --state-out " + state;
  const Outcome first = calibrateBag(again);
  ASSERT_EQ(first.exit_code, 0) << first.output;
  const std::string bytes = contents(state);
  const Outcome second = calibrateBag(again);
  EXPECT_EQ(second.exit_code, 0);
  EXPECT_TRUE(mentions(second, "already holds the result of this bag")) << second.output;
  EXPECT_FALSE(mentions(second, "parameter")) << "nothing is computed";
  const Outcome other = calibrateBag(bag + " --camera rear --state-out " + state);
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_TRUE(mentions(other, "contributes for the camera 'front'")) << other.output;
  EXPECT_EQ(contents(state), bytes);
  EXPECT_EQ(calibrateBag(again + " --overwrite").exit_code, 0);
  EXPECT_EQ(contents(state), bytes) << "the same input, the same state";
}

}  // namespace
}  // namespace camera_self_calibration
