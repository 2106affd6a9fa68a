#include "camera_self_calibration/tools/rig_files.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <fstream>
#include <set>

#include "camera_self_calibration/geometry/so3.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/tools/calibration_file.h"
#include "camera_self_calibration/tools/calibration_format.h"
#include "camera_self_calibration/tools/rig_results.h"
#include "camera_self_calibration/tools/trajectory_results.h"
#include "tools/temporary_folder.h"

namespace camera_self_calibration {
namespace {

Camera radtan(double focal) {
  Intrinsics p(8);
  p << focal, 1.003 * focal, 360.0, 245.0, -0.3, 0.1, 0.0002, -0.0001;
  return Camera(CameraModel::kRadtan, 752, 480, p);
}

Camera radtanWithK3() {
  Intrinsics p(9);
  p << 600.0, 600.0, 376.0, 240.0, -0.2, 0.05, 0.0, 0.0, -0.01;
  return Camera(CameraModel::kRadtan, 752, 480, p);
}

Camera equidistant(double focal) {
  Intrinsics p(8);
  p << focal, focal, 370.0, 250.0, -0.01, 0.02, -0.01, 0.001;
  return Camera(CameraModel::kEquidistant, 752, 480, p);
}

Rig pair(const Camera& a, const Camera& b, const Eigen::Vector3d& position) {
  return {{a, b}, {Rigid3(), Rigid3(expSo3({0.015, -0.01, 0.02}), position)}};
}

// Where a point is in a rectified image.
Eigen::Vector2d rectified(const sensor_msgs::CameraInfo& info, const Eigen::Vector3d& in_camera) {
  using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  const RowMajor3 r(info.R.data());
  const RowMajor34 p(info.P.data());
  // P maps from the rectified frame of the left camera: Tx is in its last column.
  return (p.leftCols<3>() * (r * in_camera)).hnormalized();
}

void expectRectified(const Rig& rig) {
  std::string problem;
  const auto stereo = stereoPair(rig, &problem);
  ASSERT_TRUE(stereo) << problem;
  const double focal = stereo->left_info.P[0];
  const double baseline = rig.rig_from_camera[1].translation.norm();
  EXPECT_NEAR(stereo->right_info.P[3], -focal * baseline, 1e-6 * focal);
  EXPECT_EQ(stereo->left_info.P[3], 0.0);
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0.3, -0.2, 1.0), Eigen::Vector3d(-1.0, 0.8, 3.0)}) {
    const auto seen = [&](int camera, const sensor_msgs::CameraInfo& info) {
      return rectified(info, rig.rig_from_camera[camera].inverse() * point);
    };
    const Eigen::Vector2d left = seen(stereo->left, stereo->left_info);
    const Eigen::Vector2d right = seen(stereo->right, stereo->right_info);
    EXPECT_NEAR(left.y(), right.y(), 1e-6);
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> r(stereo->left_info.R.data());
    const double depth = (r * (rig.rig_from_camera[stereo->left].inverse() * point)).z();
    EXPECT_NEAR(left.x() - right.x(), focal * baseline / depth, 1e-6);
  }
}

TEST(StereoPair, RowsAgreeAndDisparityIsDepth) {
  expectRectified(pair(radtan(460.0), radtan(458.0), {0.11, 0.001, -0.002}));
  expectRectified(pair(equidistant(400.0), equidistant(410.0), {0.11, 0.001, -0.002}));
}

TEST(StereoPair, DifferentLensesAreBothEquidistant) {
  const Rig rig = pair(radtan(460.0), equidistant(458.0), {0.11, 0.0, 0.0});
  expectRectified(rig);
  std::string problem;
  EXPECT_EQ(stereoPair(rig, &problem)->left_info.distortion_model, "equidistant");
}

TEST(StereoPair, TheLeftCameraMayBeTheSecond) {
  const Rig rig = pair(radtan(460.0), radtan(458.0), {-0.11, 0.001, 0.0});
  std::string problem;
  EXPECT_EQ(stereoPair(rig, &problem)->left, 1);
  expectRectified(rig);
}

TEST(StereoPair, NoneInWords) {
  std::string problem;
  EXPECT_FALSE(stereoPair(pair(radtan(460.0), radtan(460.0), {0.0, 0.2, 0.0}), &problem));
  EXPECT_NE(problem.find("side by side"), std::string::npos);
  Rig turned = pair(radtan(460.0), radtan(460.0), {0.2, 0.0, 0.0});
  turned.rig_from_camera[1].rotation = expSo3({0.0, 1.5, 0.0});
  EXPECT_FALSE(stereoPair(turned, &problem));
  EXPECT_NE(problem.find("less than half of their views"), std::string::npos);
}

TEST(RigCamchain, ReadsBack) {
  Rig rig = pair(equidistant(400.0), equidistant(410.0), {0.11, 0.001, -0.002});
  rig.cameras.push_back(equidistant(390.0));
  rig.rig_from_camera.emplace_back(expSo3({0.1, 0.2, 0.0}), Eigen::Vector3d(0.0, 0.2, 0.0));
  const std::string text = rigCamchain(rig, {"/a", "/b", "/c"}, "Lengths in metres.");
  const StoredCalibration second = parseCalibration(text, CalibrationFormat::kKalibr, "cam1");
  EXPECT_EQ(second.camera.parameters(), rig.cameras[1].parameters());
  const YAML::Node chain = YAML::Load(text);
  EXPECT_EQ(chain["cam2"]["rostopic"].as<std::string>(), "/c");
  EXPECT_FALSE(chain["cam0"]["T_cn_cnm1"]);
  // cam1 stands at x = 0.11 in cam0, and so cam0 at about -0.11 in cam1.
  const YAML::Node motion = chain["cam2"]["T_cn_cnm1"];
  const Rigid3 expected = rig.rig_from_camera[2].inverse() * rig.rig_from_camera[1];
  for (int r = 0; r < 3; ++r) {
    EXPECT_NEAR(motion[r][3].as<double>(), expected.translation(r), 1e-15);
    EXPECT_NEAR(motion[r][0].as<double>(), expected.rotation.toRotationMatrix()(r, 0), 1e-15);
  }
  EXPECT_LT(chain["cam1"]["T_cn_cnm1"][0][3].as<double>(), -0.1);
  const Rig read = parseRigCalibration(text);
  ASSERT_EQ(read.size(), 3);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(read.cameras[c].parameters(), rig.cameras[c].parameters());
    EXPECT_TRUE(read.rig_from_camera[c].translation.isApprox(rig.rig_from_camera[c].translation));
    EXPECT_TRUE(read.rig_from_camera[c].rotation.isApprox(rig.rig_from_camera[c].rotation, 1e-9));
  }
}

// Kalibr has no k3.
TEST(RigCamchain, AFitIsNotedInTheFileAndInWords) {
  Rig rig = pair(radtan(460.0), radtanWithK3(), {0.11, 0.0, 0.0});
  const std::string text = rigCamchain(rig, {"/a", "/b"}, "Lengths in metres.");
  EXPECT_EQ(text.rfind("# Lengths in metres.\ncam0:", 0), 0u) << text;
  const std::size_t note = text.find("# fitted to radtan with k3: off by ");
  ASSERT_NE(note, std::string::npos) << text;
  EXPECT_EQ(text.find('\n', note) + 1, text.find("cam1:"));
  EXPECT_EQ(parseRigCalibration(text).size(), 2) << "a comment does not keep it from being read";
  const std::vector<std::string> notes = camchainNotes(rig, "camchain.yaml");
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_EQ(notes[0].find("cam1 in camchain.yaml holds an approximation, since kalibr has no "
                          "radtan lens like this: "),
            0u)
      << notes[0];
  rig.cameras[1] = radtan(458.0);
  EXPECT_TRUE(camchainNotes(rig, "camchain.yaml").empty());
}

RigRecording convergedPair() {
  RigRecording recording;
  recording.topics = {"/left", "/right"};
  recording.estimate.rig = pair(equidistant(600.0), radtanWithK3(), {0.11, 0.0, 0.0});
  recording.estimate.usable = recording.estimate.converged = true;
  recording.estimate.places.resize(2);
  recording.cameras.resize(2);
  for (int c = 0; c < 2; ++c) {
    CalibrationReport& report = recording.cameras[c].final_report;
    report.state = CalibrationState::kConverged;
    report.camera = recording.estimate.rig.cameras[c];
  }
  return recording;
}

// The files that calibrate_bag writes, and what it says of them.
TEST(RigResults, ApproximationsAreSaidInFilesAndInWords) {
  const TemporaryFolder folder;
  std::string all;
  for (const std::string& note : writeRig(folder.string(), convergedPair())) all += note + "\n";
  EXPECT_NE(all.find("cam1 in camchain.yaml holds an approximation"), std::string::npos) << all;
  EXPECT_NE(
      all.find("\nright.yaml holds an approximation, since both of a pair have one distortion "
               "model: equidistant, off by "),
      std::string::npos)
      << all;
  EXPECT_EQ(all.find("left.yaml holds"), std::string::npos) << all;
  const std::string right = readFile(folder / "right.yaml").bytes;
  EXPECT_EQ(right.rfind("# fitted to radtan with k3: off by ", 0), 0u) << right;
  EXPECT_EQ(readCalibrationFile(folder / "right.yaml").model(), CameraModel::kEquidistant);
}

/// Names of all files below a folder, in their order.
std::string filesIn(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) names.insert(entry.path().lexically_relative(folder).string());
  }
  std::string all;
  for (const std::string& name : names) all += name + ' ';
  return all;
}

TEST(RigResults, NoneOfAnEarlierRunOfAnotherKindStays) {
  const TemporaryFolder folder;
  const RigRecording rig = convergedPair();
  Recording vague;
  vague.final_report.camera = radtan(460.0);
  const std::string of_one = "convergence.csv keyframes.tum summary.json trajectory.tum ";
  writeRig(folder.string(), rig);
  std::ofstream(folder / "cam1/notes.txt") << "mine";
  writeRecording(folder.string(), "/left", vague);
  EXPECT_EQ(filesIn(folder.string()), "cam1/notes.txt " + of_one);
  EXPECT_FALSE(std::filesystem::exists(folder / "cam0"));
  writeRecording(folder.string(), "/left", rig.cameras[0]);
  for (const char* name : {"report.html", "fig4_parameters.png"}) std::ofstream(folder / name);
  RigRecording vague_rig;
  vague_rig.topics = {"/left"};
  vague_rig.cameras = {vague};
  writeRig(folder.string(), vague_rig);
  EXPECT_EQ(filesIn(folder.string()),
            "cam0/convergence.csv cam0/keyframes.tum cam0/summary.json cam0/trajectory.tum "
            "cam1/notes.txt summary.json trajectory.tum ");
}

// As --out DIR/cam0 beside --out DIR.
TEST(RigResults, ARunOfOneCameraLeavesThoseOfOthersBelowIt) {
  const TemporaryFolder folder;
  const Recording recording = convergedPair().cameras[0];
  std::filesystem::create_directory(folder / "cam0");
  writeRecording(folder / "cam0", "/left", recording);
  for (int i = 0; i < 2; ++i) writeRecording(folder.string(), "/left", recording);
  EXPECT_TRUE(std::filesystem::exists(folder / "cam0/calibration.yaml"));
}

TEST(TrajectoryResults, ARelativeErrorThatIsNotKnownIsNotZero) {
  TrajectoryResults results;
  results.truth = TrajectoryDifference();
  EXPECT_NE(trajectoryText(results).find("RPE unknown (no poses 1 s apart)"), std::string::npos);
  EXPECT_NE(toText(trajectoryJson(results)).find("\"rpe_translation_rms\": null"),
            std::string::npos);
}

TEST(RigCamchain, WhatIsNoRigIsRefusedWithAReason) {
  const Rig rig = pair(equidistant(400.0), equidistant(410.0), {0.11, 0.0, 0.0});
  const std::string text = rigCamchain(rig, {"/a", "/b"}, "");
  const auto problem = [](const std::string& calibration) -> std::string {
    try {
      parseRigCalibration(calibration);
    } catch (const std::exception& e) {
      return e.what();
    }
    return "none";
  };
  EXPECT_EQ(problem(text), "none");
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    return changed.replace(changed.find(from), from.size(), to);
  };
  EXPECT_NE(problem(replaced("T_cn_cnm1", "T_other")).find("no T_cn_cnm1"), std::string::npos);
  EXPECT_NE(problem(replaced("T_cn_cnm1:\n  - [", "T_cn_cnm1:\n  - [1")).find("no motion"),
            std::string::npos);
  EXPECT_NE(problem(replaced("cam1", "left")).find("cam0 and cam1"), std::string::npos);
  EXPECT_NE(problem("model: fov\nwidth: 640\nheight: 480\nparams: [300, 300, 320, 240, 0.9]\n")
                .find("no camchain"),
            std::string::npos);
}

TEST(RigResults, ACameraThatWasMovedIsTold) {
  RigRecording recording;
  recording.topics = {"/left", "/right"};
  recording.estimate.sentence = "Not yet.";
  MountChange change;
  change.onset_ns = 12'300'000'000;
  change.rotation = {0.0, 0.0, 0.01};
  change.rotation_covariance = 1e-6 * Eigen::Matrix3d::Identity();
  change.sentence = "Camera 1 was turned by 0.57 +- 0.06 degrees against camera 0 at 12.3 s.";
  recording.mount_changes = {change};
  EXPECT_NE(rigText(recording).find("MOUNT_CHANGED: " + change.sentence), std::string::npos);
  const Json found = rigJson(recording)["mount_changes"][0];
  EXPECT_EQ(found["type"], "MOUNT_CHANGED");
  EXPECT_EQ(found["topic"], "/right");
  EXPECT_NEAR(found["onset_stamp"].get<double>(), 12.3, 1e-9);
  EXPECT_TRUE(found["shift"].is_null());
}

}  // namespace
}  // namespace camera_self_calibration
