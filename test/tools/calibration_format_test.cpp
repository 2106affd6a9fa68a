// Every format: round trips, files as their own programs write them, and what is refused.

#include "camera_self_calibration/tools/calibration_format.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "tools/format_samples.h"

namespace camera_self_calibration {
namespace {

TEST(CalibrationFormat, NamesReadBack) {
  for (const CalibrationFormat format : kFormats) {
    EXPECT_EQ(calibrationFormatFromString(toString(format)), format);
  }
  EXPECT_FALSE(calibrationFormatFromString("matlab"));
}

TEST(CalibrationFormat, EveryFormatReturnsWhatItStores) {
  for (const CalibrationFormat format : kFormats) {
    for (const Camera& source : kCameras) {
      const Camera stored = storable(source, format).camera;
      const std::string text = calibrationText(stored, format);
      EXPECT_EQ(detectCalibrationFormat(text), format) << text;
      const Camera read = parseCalibration(text, format).camera;
      EXPECT_EQ(read.model(), stored.model()) << text;
      EXPECT_EQ(read.width(), 752);
      EXPECT_EQ(read.height(), 480);
      ASSERT_EQ(read.parameterCount(), stored.parameterCount()) << text;
      // COLMAP's half pixel costs the last digit.
      const double tolerance = format == CalibrationFormat::kColmap ? 1e-12 : 0.0;
      for (int i = 0; i < read.parameterCount(); ++i) {
        EXPECT_NEAR(read.parameters()[i], stored.parameters()[i], tolerance) << text;
      }
    }
  }
}

TEST(CalibrationFormat, IsExactWhereTheFormatHasTheModel) {
  const auto exact = [](const Camera& source, CalibrationFormat format) {
    const CameraFit fit = storable(source, format);
    return fit.camera.model() == source.model() && fit.error.max == 0.0;
  };
  for (const CalibrationFormat format : kFormats) {
    EXPECT_TRUE(exact(kPinhole, format));
    EXPECT_TRUE(exact(kRadtan, format));
    EXPECT_TRUE(exact(kEquidistant, format));
  }
  EXPECT_TRUE(exact(kFov, CalibrationFormat::kKalibr));
  EXPECT_TRUE(exact(kFov, CalibrationFormat::kColmap));
  EXPECT_TRUE(exact(kRadtanK3, CalibrationFormat::kColmap));
  EXPECT_TRUE(exact(kRadtanK3, CalibrationFormat::kOrbSlam3));
  EXPECT_TRUE(exact(kRadtanK3, CalibrationFormat::kOpenCv));
  EXPECT_FALSE(exact(kFov, CalibrationFormat::kVins));
  EXPECT_FALSE(exact(kRadtanK3, CalibrationFormat::kKalibr));
}

TEST(CalibrationFormat, OtherwiseItTellsTheErrorOfTheFit) {
  const std::vector<std::pair<Camera, CalibrationFormat>> cases = {
      {kFov, CalibrationFormat::kRos},         {kFov, CalibrationFormat::kOpenCv},
      {kFov, CalibrationFormat::kOrbSlam3},    {kFov, CalibrationFormat::kVins},
      {kRadtanK3, CalibrationFormat::kKalibr}, {kRadtanK3, CalibrationFormat::kVins}};
  for (const auto& [source, format] : cases) {
    const CameraFit fit = storable(source, format);
    EXPECT_GT(fit.error.max, 0.0) << toString(format);
    EXPECT_LT(fit.error.rms, source.model() == CameraModel::kFov ? 0.02 : 0.7) << toString(format);
    EXPECT_LE(pixelDistance(source, fit.camera).rms, fit.error.rms + 1e-9);
  }
}

TEST(CalibrationFormat, WithoutK3TheBetterOfTwoModelsIsTaken) {
  const Camera tangential =
      camera(CameraModel::kRadtan, {600, 600, 376, 240, -0.2, 0.05, 0.004, -0.004, 0.002});
  const CameraFit fit = storable(tangential, CalibrationFormat::kVins);
  EXPECT_EQ(fit.camera.model(), CameraModel::kRadtan) << "equidistant has no tangential terms";
  EXPECT_LT(fit.error.max, 0.05);
  EXPECT_EQ(storable(kRadtanK3, CalibrationFormat::kVins).camera.model(),
            CameraModel::kEquidistant);
}

TEST(CalibrationFormat, K3OfZeroIsNoReasonToFit) {
  Intrinsics values = kRadtanK3.parameters();
  values[8] = 0.0;
  const Camera source(CameraModel::kRadtan, 752, 480, values);
  EXPECT_EQ(storable(source, CalibrationFormat::kKalibr).camera.model(), CameraModel::kRadtan);
}

TEST(RosFormat, ATextOnWhichYamlCppDoesNotEndIsRefused) {
  EXPECT_THROW(parseCalibration(",\x12\x12", CalibrationFormat::kRos), std::runtime_error);
  // In Debian 11, in the list that a calibration ends with too.
  const std::string good = calibrationText(kRadtan, CalibrationFormat::kRos);
  for (const char* end : {" :]\n", ":\n]\n", " 0:\n"}) {
    const std::string bad = good.substr(0, good.rfind(',') + 1) + end;
    EXPECT_TRUE(says(failureOf(bad, CalibrationFormat::kRos), "ends in a colon")) << bad;
  }
}

TEST(RosFormat, SaysWhatIsWrong) {
  const auto ros = CalibrationFormat::kRos;
  const std::string good = calibrationText(kRadtan, ros);
  EXPECT_TRUE(says(failureOf(replaced(good, "image_width", "width"), ros), "'image_width'"));
  EXPECT_TRUE(
      says(failureOf(replaced(good, "image_height: 480", "image_height: 0"), ros), "not positive"));
  EXPECT_TRUE(says(failureOf(replaced(good, "plumb_bob", "thin_prism"), ros), "thin_prism"));
  EXPECT_TRUE(says(failureOf(replaced(good, "421.5,", ""), ros), "has 8 values"));
  EXPECT_TRUE(says(failureOf(replaced(good, "rows: 3", "rows: 1"), ros), "1 x 3 has 9 values"));
  EXPECT_NE(failureOf(replaced(good, "421.5", "wide"), ros), "no failure");
  EXPECT_NE(failureOf(good.substr(0, good.size() / 2), ros), "no failure");
}

TEST(KalibrFormat, ReadsOneCameraOfAChain) {
  const auto kalibr = CalibrationFormat::kKalibr;
  EXPECT_EQ(detectCalibrationFormat(kCamchain), kalibr);
  const StoredCalibration read = parseCalibration(kCamchain, kalibr, "cam0");
  EXPECT_EQ(read.name, "cam0");
  EXPECT_EQ(read.camera.model(), CameraModel::kRadtan);
  EXPECT_EQ(read.camera.parameters()[3], 248.1);
  EXPECT_EQ(read.camera.parameters()[7], 1.7e-05);
  EXPECT_TRUE(says(failureOf(kCamchain, kalibr), "cam0, cam1"));
  EXPECT_TRUE(says(failureOf(kCamchain, kalibr, "cam7"), "no camera 'cam7'"));
  EXPECT_TRUE(says(failureOf(kCamchain, kalibr, "cam1"), "'omni'"));
}

TEST(KalibrFormat, SaysWhatIsWrong) {
  const auto kalibr = CalibrationFormat::kKalibr;
  const std::string good = calibrationText(kRadtan, kalibr);
  EXPECT_TRUE(says(failureOf(replaced(good, "resolution", "size"), kalibr), "'resolution'"));
  EXPECT_TRUE(says(failureOf(replaced(good, "[421.5, ", "["), kalibr), "fx, fy, cx, cy"));
  EXPECT_TRUE(says(failureOf(replaced(good, ": radtan", ": spline"), kalibr), "'spline'"));
  EXPECT_TRUE(says(failureOf(replaced(good, "[752, ", "["), kalibr), "width and height"));
  EXPECT_TRUE(says(failureOf(replaced(good, "421.5", "-421.5"), kalibr), "out of range"));
  EXPECT_TRUE(says(failureOf(replaced(good, "421.5", ".nan"), kalibr), "out of range"));
  EXPECT_TRUE(says(failureOf(replaced(good, ": radtan", ": equidistant"), kalibr), ""));
  EXPECT_TRUE(says(failureOf(replaced(good, ": radtan", ": fov"), kalibr), "fov has 5"));
}

TEST(OpenCvFormat, OpenCvReadsIt) {
  const std::string text = calibrationText(kRadtanK3, CalibrationFormat::kOpenCv);
  cv::FileStorage storage(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
  cv::Mat k, d;
  storage["camera_matrix"] >> k;
  storage["distortion_coefficients"] >> d;
  ASSERT_EQ(k.size(), cv::Size(3, 3));
  EXPECT_EQ(k.at<double>(0, 2), 353.9);
  ASSERT_EQ(d.total(), 5u);
  EXPECT_EQ(d.at<double>(4), -0.0545);
}

TEST(OpenCvFormat, ReadsWhatItsSampleWritesAsYamlAndXml) {
  for (const char* name : {".yml", ".xml"}) {
    cv::FileStorage storage(name, cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
    storage << "calibration_time"
            << "today"
            << "nr_of_frames" << 25;
    storage << "image_width" << 752 << "image_height" << 480 << "board_width" << 9;
    storage << "fisheye_model" << 0;
    storage << "camera_matrix"
            << cv::Mat(cv::Matx33d(421.5, 0.0, 353.9, 0.0, 421.6, 251.8, 0.0, 0.0, 1.0));
    storage << "distortion_coefficients"
            << cv::Mat((cv::Mat_<double>(5, 1) << -0.33, 0.16, 0.0, 0.0, 0.0));
    const std::string text = storage.releaseAndGetString();
    ASSERT_EQ(detectCalibrationFormat(text), CalibrationFormat::kOpenCv) << text;
    const Camera read = parseCalibration(text, CalibrationFormat::kOpenCv).camera;
    EXPECT_EQ(read.model(), CameraModel::kRadtan);
    EXPECT_EQ(read.parameterCount(), 8) << "k3 is 0";
    EXPECT_EQ(read.parameters()[1], 421.6);
    EXPECT_EQ(read.width(), 752);
  }
}

TEST(OpenCvFormat, SaysWhatIsWrong) {
  const auto opencv = CalibrationFormat::kOpenCv;
  const std::string good = calibrationText(kRadtan, opencv);
  EXPECT_TRUE(says(failureOf(replaced(good, "image_width: 752", ""), opencv), "'image_width'"));
  EXPECT_TRUE(
      says(failureOf(replaced(good, "image_width: 752", "image_width: x"), opencv), "whole"));
  EXPECT_TRUE(says(failureOf(replaced(good, "camera_matrix", "matrix"), opencv), "camera_matrix"));
  EXPECT_TRUE(says(failureOf(replaced(good, "fisheye_model: 0", "fisheye_model: 1"), opencv),
                   "four coefficients"));
  EXPECT_NE(failureOf(good.substr(0, good.size() * 2 / 3), opencv), "no failure");
  EXPECT_NE(failureOf("%YAML:1.0\n---\n{[", opencv), "no failure");
  cv::FileStorage storage(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  storage << "image_width" << 752 << "image_height" << 480;
  storage << "camera_matrix" << cv::Mat(cv::Mat::eye(3, 3, CV_64F));
  storage << "distortion_coefficients" << cv::Mat(cv::Mat::ones(8, 1, CV_64F));
  EXPECT_TRUE(says(failureOf(storage.releaseAndGetString(), opencv), "k4, k5, k6"));
}

TEST(ColmapFormat, CountsPixelsFromTheCorner) {
  const std::string text = calibrationText(camera(CameraModel::kPinhole, {500, 510, 320, 240}),
                                           CalibrationFormat::kColmap);
  EXPECT_NE(text.find("1 PINHOLE 752 480 500 510 320.5 240.5\n"), std::string::npos) << text;
}

TEST(ColmapFormat, KnowsItsModels) {
  const auto colmap = CalibrationFormat::kColmap;
  const auto read = [&](const std::string& line) {
    return parseCalibration("# comment\n" + line + "\n", colmap).camera;
  };
  const std::vector<std::tuple<std::string, CameraModel, std::vector<double>>> cases = {
      {"1 SIMPLE_PINHOLE 752 480 500 320 240", CameraModel::kPinhole, {500, 500, 319.5, 239.5}},
      {"1 SIMPLE_RADIAL 752 480 500 320 240 0.1",
       CameraModel::kRadtan,
       {500, 500, 319.5, 239.5, 0.1, 0, 0, 0}},
      {"1 RADIAL 752 480 500 320 240 0.1 -0.02",
       CameraModel::kRadtan,
       {500, 500, 319.5, 239.5, 0.1, -0.02, 0, 0}},
      {"7 OPENCV 752 480 500 501 320 240 0.1 -0.02 1e-3 2e-3",
       CameraModel::kRadtan,
       {500, 501, 319.5, 239.5, 0.1, -0.02, 1e-3, 2e-3}},
      {"1 FULL_OPENCV 752 480 500 501 320 240 0.1 0.2 0.3 0.4 0.5 0 0 0",
       CameraModel::kRadtan,
       {500, 501, 319.5, 239.5, 0.1, 0.2, 0.3, 0.4, 0.5}},
      {"1 FOV 752 480 500 501 320 240 0.9", CameraModel::kFov, {500, 501, 319.5, 239.5, 0.9}},
      {"1 RADIAL_FISHEYE 752 480 500 320 240 0.1 0.2",
       CameraModel::kEquidistant,
       {500, 500, 319.5, 239.5, 0.1, 0.2, 0, 0}}};
  for (const auto& [line, model, values] : cases) {
    EXPECT_EQ(read(line).model(), model) << line;
    EXPECT_EQ(read(line).parameters(), camera(model, values).parameters()) << line;
  }
}

TEST(ColmapFormat, SaysWhatIsWrong) {
  const auto colmap = CalibrationFormat::kColmap;
  EXPECT_TRUE(says(failureOf("1 FOV 752 480 500 501 320 240", colmap), "has 5 parameters"));
  EXPECT_TRUE(says(failureOf("1 THIN_PRISM_FISHEYE 752 480 1 2 3", colmap), "OPENCV_FISHEYE"));
  EXPECT_TRUE(says(failureOf("1 PINHOLE 752", colmap), "CAMERA_ID MODEL WIDTH HEIGHT"));
  EXPECT_TRUE(says(failureOf("1 PINHOLE 752 480 500 x 320 240", colmap), "no number"));
  EXPECT_TRUE(says(failureOf("# nothing\n", colmap), "no camera"));
  EXPECT_TRUE(says(failureOf("1 FULL_OPENCV 752 480 500 501 320 240 0 0 0 0 0 0.1 0 0", colmap),
                   "k4, k5, k6"));
  const std::string two = "1 FOV 752 480 500 501 320 240 0.9\n2 PINHOLE 64 48 50 50 32 24\r\n";
  EXPECT_TRUE(says(failureOf(two, colmap), "(1, 2)"));
  EXPECT_EQ(parseCalibration(two, colmap, "2").camera.width(), 64);
  EXPECT_TRUE(says(failureOf(two + two, colmap, "1"), "twice"));
}

constexpr const char* kOldOrbSlam = R"(%YAML:1.0

# Camera calibration and distortion parameters (OpenCV)
Camera.type: "PinHole"
Camera.fx: 458.654
Camera.fy: 457.296
Camera.cx: 367
Camera.cy: 248.375
Camera.k1: -0.28340811
Camera.k2: 0.07395907
Camera.p1: 0.00019359
Camera.p2: 1.76187114e-05
Camera.width: 752
Camera.height: 480
Camera.fps: 20.0
)";

TEST(OrbSlam3Format, ReadsOldAndNewSettings) {
  const auto orb = CalibrationFormat::kOrbSlam3;
  EXPECT_EQ(detectCalibrationFormat(kOldOrbSlam), orb);
  const Camera old = parseCalibration(kOldOrbSlam, orb).camera;
  EXPECT_EQ(old.model(), CameraModel::kRadtan);
  EXPECT_EQ(old.parameters()[2], 367.0) << "whole numbers are numbers too";
  EXPECT_EQ(old.parameters()[7], 1.76187114e-05);
  const std::string text = calibrationText(kRadtanK3, orb);
  for (const char* line : {"File.version: \"1.0\"", "Camera.type: \"PinHole\"", "Camera1.fx: 421.5",
                           "Camera1.k3: ", "Camera.fps: 30", "ORBextractor.nFeatures: "}) {
    EXPECT_NE(text.find(line), std::string::npos) << line;
  }
  const Camera round(CameraModel::kRadtan, 640, 480,
                     intrinsics({615, 615, 320, 240, 0.01, 0, 0, 0}));
  const std::string real = calibrationText(round, orb);
  for (const char* line : {"Camera1.fx: 615.0\n", "Camera1.p1: 0.0\n"}) {
    EXPECT_NE(real.find(line), std::string::npos) << "ORB-SLAM3 takes no integer: " << line;
  }
  const std::string rectified = replaced(text, "PinHole", "Rectified");
  EXPECT_EQ(parseCalibration(rectified, orb).camera.model(), CameraModel::kPinhole);
}

TEST(OrbSlam3Format, SaysWhatIsWrong) {
  const auto orb = CalibrationFormat::kOrbSlam3;
  const std::string good = calibrationText(kEquidistant, orb);
  EXPECT_TRUE(says(failureOf(replaced(good, "Camera1.k4", "Camera1.k9"), orb), "'Camera1.k4'"));
  EXPECT_TRUE(says(failureOf(replaced(good, "KannalaBrandt8", "Fisheye"), orb), "'Fisheye'"));
  EXPECT_TRUE(says(failureOf(replaced(good, "300.5", "big"), orb), "no number"));
  EXPECT_TRUE(says(failureOf(replaced(good, "Camera.width: 752", ""), orb), "'Camera.width'"));
  EXPECT_TRUE(says(failureOf(replaced(good, ": 752", ": -752"), orb), "not positive"));
}

constexpr const char* kVinsFusion = R"(%YAML:1.0
---
model_type: KANNALA_BRANDT
camera_name: cam0
image_width: 512
image_height: 512
projection_parameters:
   k2: 0.0034823894022493434
   k3: 0.0007150348452162257
   k4: -0.0020532361418706202
   k5: 0.00020293673591811182
   mu: 190.97847715128717
   mv: 190.9733070521226
   u0: 254.93170605935475
   v0: 256.8974428996504
)";

TEST(VinsFormat, ReadsCamodocal) {
  const auto vins = CalibrationFormat::kVins;
  EXPECT_EQ(detectCalibrationFormat(kVinsFusion), vins);
  const StoredCalibration read = parseCalibration(kVinsFusion, vins);
  EXPECT_EQ(read.name, "cam0");
  EXPECT_EQ(read.camera.model(), CameraModel::kEquidistant);
  EXPECT_EQ(read.camera.parameters()[0], 190.97847715128717);
  EXPECT_EQ(read.camera.parameters()[4], 0.0034823894022493434);
  EXPECT_EQ(read.camera.parameters()[7], 0.00020293673591811182);
}

TEST(VinsFormat, SaysWhatIsWrong) {
  const auto vins = CalibrationFormat::kVins;
  const std::string good = calibrationText(kRadtan, vins);
  EXPECT_TRUE(says(failureOf(replaced(good, "PINHOLE", "MEI"), vins), "'MEI'"));
  EXPECT_TRUE(says(failureOf(replaced(good, "   p2", "   q2"), vins), "distortion_parameters: p2"));
  EXPECT_TRUE(
      says(failureOf(replaced(good, "projection_parameters", "other"), vins), "projection_par"));
  EXPECT_TRUE(says(failureOf("%YAML:1.0\n---\nmodel_type: 3\n", vins), "no text"));
}

TEST(CalibrationFormat, DetectsNothingInOtherTexts) {
  EXPECT_FALSE(detectCalibrationFormat("just text"));
  EXPECT_FALSE(detectCalibrationFormat("a: 1\nb: [2, 3]\n"));
  EXPECT_FALSE(detectCalibrationFormat("%YAML:1.0\n---\na: 1\n"));
  EXPECT_THROW(detectCalibrationFormat("{ [ not yaml"), std::runtime_error);
}

/// Any byte of any file may be damaged: a message or a camera, never a crash.
TEST(CalibrationFormat, SurvivesDamage) {
  for (const CalibrationFormat format : kFormats) {
    const std::string good = calibrationText(storable(kRadtan, format).camera, format);
    for (std::size_t i = 0; i < good.size(); i += 3) {
      for (const char damage : {'\n', '{', '9', ':'}) {
        std::string text = good;
        text[i] = damage;
        try {
          EXPECT_TRUE(parseCalibration(text, format).camera.valid());
        } catch (const std::exception& e) {
          EXPECT_FALSE(std::string(e.what()).empty());
        }
      }
    }
  }
}

TEST(CalibrationFormat, AnApproximationIsSaidWhereItIsNoticed) {
  const Camera camera = camera640(CameraModel::kFov, {320, 322, 316, 243, 0.95});
  const Camera close = camera640(CameraModel::kEquidistant, {320, 322, 316, 243, 0, 0, 0, 0});
  CameraFit fit{close, {0.2, 0.9}};
  const std::string note = approximationNote("a.yaml", camera, CalibrationFormat::kRos, fit);
  EXPECT_EQ(note.find("a.yaml holds an approximation, since ros has no "), 0u) << note;
  fit.error = {1e-6, 2e-5};
  EXPECT_EQ(approximationNote("a.yaml", camera, CalibrationFormat::kRos, fit), "");
  EXPECT_NE(fitNote(camera, fit.error), "") << "in the file it is said";
}

}  // namespace
}  // namespace camera_self_calibration
