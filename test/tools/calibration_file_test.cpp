#include "camera_self_calibration/tools/calibration_file.h"

#include <camera_calibration_parsers/parse.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <fstream>

#include "camera_self_calibration/camera/pixel_distance.h"
#include "tools/temporary_folder.h"

namespace camera_self_calibration {
namespace {

Camera makeCamera(CameraModel model, const std::vector<double>& values) {
  return Camera(
      model, 640, 480,
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())));
}

void writeRosCalibration(const std::string& path, const std::string& name, const Camera& camera) {
  CalibrationLabels labels;
  labels.camera_name = name;
  writeCalibration(path, camera, CalibrationFormat::kRos, labels);
}

void writeKalibrCalibration(const std::string& path, const std::string& topic,
                            const Camera& camera) {
  CalibrationLabels labels;
  labels.topic = topic;
  writeCalibration(path, camera, CalibrationFormat::kKalibr, labels);
}

void writeText(const std::string& path, const std::string& text) { std::ofstream(path) << text; }

std::string failureOf(const std::string& path) {
  try {
    readCalibrationFile(path);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return {};
}

TEST(CalibrationFile, RosYamlRoundTripIsExact) {
  const TemporaryFolder folder;
  for (const Camera& camera :
       {makeCamera(CameraModel::kPinhole, {500.123456789, 510, 320, 240}),
        makeCamera(CameraModel::kRadtan, {421, 422, 354, 252, -0.33, 0.16, 0.001, -0.002}),
        makeCamera(CameraModel::kEquidistant, {300, 301, 320, 240, 0.01, -0.002, 0.001, 1e-5})}) {
    writeRosCalibration(folder / "c.yaml", "camera", camera);
    const Camera read = readCalibrationFile(folder / "c.yaml");
    EXPECT_EQ(read.model(), camera.model());
    EXPECT_EQ(read.parameters(), camera.parameters());
    EXPECT_EQ(read.height(), 480);
  }
}

TEST(CalibrationFile, RosReadsFovAsEquidistant) {
  const TemporaryFolder folder;
  const Camera fov = makeCamera(CameraModel::kFov, {311.2, 309.8, 327.4, 233.1, 0.93});
  writeRosCalibration(folder / "c.yaml", "front", fov);
  std::string name;
  sensor_msgs::CameraInfo info;
  ASSERT_TRUE(camera_calibration_parsers::readCalibration(folder / "c.yaml", name, info));
  EXPECT_EQ(name, "front");
  EXPECT_EQ(info.distortion_model, "equidistant");
  EXPECT_LT(pixelDistance(fov, readCalibrationFile(folder / "c.yaml")).max, 0.05);
}

TEST(CalibrationFile, ReadsTheOwnFormat) {
  const TemporaryFolder folder;
  writeText(folder / "c.yaml",
            "model: fov\nwidth: 640\nheight: 480\nparams: [311.2, 309.8, 327.4, 233.1, 0.93]\n");
  const Camera camera = readCalibrationFile(folder / "c.yaml");
  EXPECT_EQ(camera.model(), CameraModel::kFov);
  EXPECT_EQ(camera.parameters()[4], 0.93);
}

TEST(CalibrationFile, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  EXPECT_NE(failureOf(folder / "none.yaml").find("opened"), std::string::npos);
  writeText(folder / "a.yaml", "model: spherical\nwidth: 6\nheight: 4\nparams: [1, 2, 3, 4]\n");
  EXPECT_NE(failureOf(folder / "a.yaml").find("spherical"), std::string::npos);
  writeText(folder / "b.yaml", "model: fov\nwidth: 640\nheight: 480\nparams: [1, 2]\n");
  EXPECT_FALSE(failureOf(folder / "b.yaml").empty());
  writeText(folder / "c.yaml", "model: fov\nwidth: 64\nheight: 48\nparams: [-1, 20, 3, 4, 1]\n");
  EXPECT_NE(failureOf(folder / "c.yaml").find("range"), std::string::npos);
  writeText(folder / "d.yaml", "just text");
  EXPECT_FALSE(failureOf(folder / "d.yaml").empty());
  writeText(folder / "e.yaml", "{ [ not yaml");
  EXPECT_FALSE(failureOf(folder / "e.yaml").empty());
}

TEST(CalibrationFile, KalibrHasItsOwnNames) {
  const TemporaryFolder folder;
  const std::vector<std::pair<Camera, std::string>> cases = {
      {makeCamera(CameraModel::kPinhole, {500, 510, 320, 240}), "none"},
      {makeCamera(CameraModel::kFov, {311, 310, 327, 233, 0.93}), "fov"},
      {makeCamera(CameraModel::kRadtan, {421, 422, 354, 252, -0.33, 0.16, 0.001, -0.002}),
       "radtan"},
      {makeCamera(CameraModel::kEquidistant, {300, 301, 320, 240, 0.01, 0, 0, 0}), "equidistant"}};
  for (const auto& [camera, distortion] : cases) {
    writeKalibrCalibration(folder / "k.yaml", "/camera/image_raw", camera);
    const YAML::Node cam0 = YAML::LoadFile(folder / "k.yaml")["cam0"];
    EXPECT_EQ(cam0["camera_model"].as<std::string>(), "pinhole");
    EXPECT_EQ(cam0["distortion_model"].as<std::string>(), distortion);
    EXPECT_EQ(cam0["rostopic"].as<std::string>(), "/camera/image_raw");
    const auto intrinsics = cam0["intrinsics"].as<std::vector<double>>();
    const auto coefficients = cam0["distortion_coeffs"].as<std::vector<double>>();
    EXPECT_EQ(cam0["resolution"].as<std::vector<int>>(), (std::vector<int>{640, 480}));
    ASSERT_EQ(intrinsics.size(), 4u);
    ASSERT_EQ(static_cast<int>(coefficients.size()), camera.parameterCount() - 4);
    EXPECT_EQ(intrinsics[1], camera.parameters()[1]);
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      EXPECT_EQ(coefficients[i], camera.parameters()[static_cast<Eigen::Index>(4 + i)]);
    }
  }
}

TEST(CalibrationFile, KalibrNamesAnyRecording) {
  const TemporaryFolder folder;
  const Camera camera = makeCamera(CameraModel::kPinhole, {500, 510, 320, 240});
  for (const std::string name : {"walk 12: 30.mp4", "[1]", "a \"b\" \\c", "12"}) {
    writeKalibrCalibration(folder / "k.yaml", name, camera);
    EXPECT_EQ(YAML::LoadFile(folder / "k.yaml")["cam0"]["rostopic"].as<std::string>(), name);
  }
}

TEST(CalibrationFile, KalibrGetsAFitOfRadtanWithK3) {
  const TemporaryFolder folder;
  const Camera with_k3 =
      makeCamera(CameraModel::kRadtan, {600, 600, 320, 240, -0.2, 0.05, 0.0, 0.0, -0.01});
  writeKalibrCalibration(folder / "k.yaml", "/camera/image_raw", with_k3);
  const YAML::Node cam0 = YAML::LoadFile(folder / "k.yaml")["cam0"];
  EXPECT_EQ(cam0["distortion_model"].as<std::string>(), "equidistant");
  std::vector<double> values = cam0["intrinsics"].as<std::vector<double>>();
  for (const double k : cam0["distortion_coeffs"].as<std::vector<double>>()) values.push_back(k);
  EXPECT_LT(pixelDistance(with_k3, makeCamera(CameraModel::kEquidistant, values)).rms, 0.1);
}

TEST(CalibrationFile, ACommentDoesNotKeepItFromBeingRead) {
  const TemporaryFolder folder;
  const Camera camera = Camera::defaultGuess(CameraModel::kEquidistant, 640, 480);
  CalibrationLabels labels;
  labels.comment = "PARTIAL: cut short";
  for (const CalibrationFormat format : {CalibrationFormat::kRos, CalibrationFormat::kKalibr}) {
    const std::string path = folder / toString(format);
    writeCalibration(path, camera, format, labels);
    std::string first;
    std::getline(std::ifstream(path) >> std::ws, first);
    EXPECT_EQ(first, "# PARTIAL: cut short");
    EXPECT_EQ(readCalibrationFile(path).parameters(), camera.parameters());
  }
}

}  // namespace
}  // namespace camera_self_calibration
