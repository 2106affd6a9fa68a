// Files as other programs and people write them, with their own names for the same things.

#include <gtest/gtest.h>

#include "tools/format_samples.h"

namespace camera_self_calibration {
namespace {

TEST(KalibrFormat, ReadsTheCamchainsOfOpenVinsAndTheSensorsOfEuroc) {
  const auto kalibr = CalibrationFormat::kKalibr;
  const std::string open_vins = "%YAML:1.0\n" + std::string(kCamchain);
  ASSERT_EQ(detectCalibrationFormat(open_vins), kalibr);
  EXPECT_EQ(parseCalibration(open_vins, kalibr, "cam0").camera.parameters(),
            parseCalibration(kCamchain, kalibr, "cam0").camera.parameters());
  const std::string euroc =
      "# General sensor definitions.\nsensor_type: camera\ncomment: VI-Sensor cam0\n"
      "T_BS:\n  cols: 4\n  rows: 1\n  data: [0.1, -0.9, 0.1, 0.0]\nrate_hz: 20\n"
      "resolution: [752, 480]\ncamera_model: pinhole\n"
      "intrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv\n"
      "distortion_model: radial-tangential\n"
      "distortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]\n";
  ASSERT_EQ(detectCalibrationFormat(euroc), kalibr);
  const Camera read = parseCalibration(euroc, kalibr).camera;
  EXPECT_EQ(read.model(), CameraModel::kRadtan);
  EXPECT_EQ(read.parameters()[0], 458.654);
  EXPECT_EQ(read.parameters()[7], 1.76187114e-05);
  const std::string plumb_bob = replaced(euroc, "radial-tangential", "plumb_bob");
  EXPECT_EQ(parseCalibration(plumb_bob, kalibr).camera.model(), CameraModel::kRadtan);
}

TEST(RosFormat, ReadsADumpedMessageAndIdleCoefficients) {
  const auto ros = CalibrationFormat::kRos;
  const std::string message =
      "header: \n  seq: 1\n  stamp: \n    secs: 5\n    nsecs: 0\n  frame_id: \"eye\"\n"
      "height: 480\nwidth: 752\ndistortion_model: \"plumb_bob\"\n"
      "D: [-0.28, 0.07, 0.0002, 1.7e-05, 0.0, 0.0, 0.0, 0.0]\n"
      "K: [458.6, 0.0, 367.2, 0.0, 457.2, 248.3, 0.0, 0.0, 1.0]\n"
      "R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n"
      "P: [458.6, 0.0, 367.2, 0.0, 0.0, 457.2, 248.3, 0.0, 0.0, 0.0, 1.0, 0.0]\n"
      "binning_x: 0\nbinning_y: 0\nroi: \n  x_offset: 0\n  y_offset: 0\n---\n";
  ASSERT_EQ(detectCalibrationFormat(message), ros);
  const StoredCalibration read = parseCalibration(message, ros);
  EXPECT_EQ(read.camera.parameters(),
            camera(CameraModel::kRadtan, {458.6, 457.2, 367.2, 248.3, -0.28, 0.07, 0.0002, 1.7e-05})
                .parameters());
  EXPECT_FALSE(read.rectified);
  const std::string right =
      replaced(message, "248.3, 0.0, 0.0, 0.0, 1.0, 0.0]", "248.3, -50.0, 0.0, 0.0, 1.0, 0.0]");
  EXPECT_TRUE(parseCalibration(right, ros).rectified) << "a camera of a stereo pair";
  EXPECT_TRUE(
      says(failureOf(replaced(message, "0.0, 0.0, 0.0]\nK", "0.0, 0.0, 0.3]\nK"), ros), "5"));
}

TEST(OpenCvFormat, KnowsOtherKeysAndBothCamerasOfAPair) {
  const auto opencv = CalibrationFormat::kOpenCv;
  const std::string k = ": !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ ";
  const std::string d = ": !!opencv-matrix\n   rows: 1\n   cols: 4\n   dt: d\n   data: [ ";
  const std::string head = "%YAML:1.0\n---\nimage_width: 752\nimage_height: 480\n";
  const std::string first = "400., 0., 370., 0., 401., 240., 0., 0., 1. ]\n";
  const std::string second = "410., 0., 371., 0., 411., 241., 0., 0., 1. ]\n";
  const std::string bent = "-0.3, 0.1, 0., 0. ]\n";
  for (const auto& [k_key, d_key] :
       {std::pair{"K", "D"}, std::pair{"M", "D"}, std::pair{"cameraMatrix", "distCoeffs"}}) {
    const std::string text = head + k_key + k + first + d_key + d + bent;
    ASSERT_EQ(detectCalibrationFormat(text), opencv) << text;
    EXPECT_EQ(parseCalibration(text, opencv).camera.parameters()[1], 401.0) << k_key;
    EXPECT_TRUE(says(failureOf(text, opencv, "2"), "--camera")) << k_key;
  }
  const std::string pair =
      head + "M1" + k + first + "D1" + d + bent + "M2" + k + second + "D2" + d + bent;
  ASSERT_EQ(detectCalibrationFormat(pair), opencv);
  EXPECT_TRUE(says(failureOf(pair, opencv), "1, 2"));
  EXPECT_EQ(parseCalibration(pair, opencv, "2").camera.parameters()[0], 410.0);
}

TEST(OrbSlam3Format, ReadsTheCameraThatIsAskedFor) {
  const auto orb = CalibrationFormat::kOrbSlam3;
  std::string text = calibrationText(kRadtan, orb);
  EXPECT_TRUE(says(failureOf(text, orb, "Camera2"), "no camera 'Camera2'"));
  text += "Camera2.fx: 500.0\nCamera2.fy: 501.0\nCamera2.cx: 370.0\nCamera2.cy: 240.0\n";
  EXPECT_EQ(parseCalibration(text, orb, "Camera2").camera.parameters()[0], 500.0);
  EXPECT_EQ(parseCalibration(text, orb).camera.parameters()[0], kRadtan.parameters()[0]);
}

TEST(CalibrationFormat, ACameraIsAskedForOnlyWhereThereAreNames) {
  for (const auto format :
       {CalibrationFormat::kRos, CalibrationFormat::kPlain, CalibrationFormat::kVins}) {
    EXPECT_TRUE(says(failureOf(calibrationText(kRadtan, format), format, "cam1"), "--camera"))
        << toString(format);
  }
}

TEST(CalibrationFormat, NumbersThatAreNoLensAreRefused) {
  const std::string plain =
      "model: pinhole\nwidth: 640\nheight: 480\nparams: [1e-30, 300, 320, 240]\n";
  EXPECT_TRUE(says(failureOf(plain, CalibrationFormat::kPlain), "focal length of 1e-30 px"));
  EXPECT_TRUE(says(
      failureOf(replaced(plain, "1e-30, 300, 320", "300, 300, 1e25"), CalibrationFormat::kPlain),
      "principal point"));
  for (const auto format : {CalibrationFormat::kPlain, CalibrationFormat::kKalibr,
                            CalibrationFormat::kColmap, CalibrationFormat::kOrbSlam3}) {
    const std::string text = replaced(calibrationText(kRadtan, format), "0.166", "1e30");
    EXPECT_TRUE(says(failureOf(text, format), "no lens has a distortion of k2"))
        << toString(format);
  }
}

// OpenCV takes the lowest 32 bits of a long integer, and one that begins with 0 as octal.
TEST(OpenCvFormat, IntegersThatItMisreadsAreRefused) {
  const auto opencv = CalibrationFormat::kOpenCv;
  const std::string good = calibrationText(kRadtan, opencv);
  const auto failure = [&](const std::string& width) {
    return failureOf(replaced(good, "image_width: 752", "image_width:" + width), opencv);
  };
  for (const char* width : {" 12884902640", " 0x3000002F0", " 12884902640#c", "12884902640 # c",
                            " !!int 12884902640", " -12884902640"}) {
    EXPECT_TRUE(says(failure(width), "is too large")) << width;
  }
  for (const char* width : {" 00752", " +0752", " 0800"}) {
    EXPECT_TRUE(says(failure(width), "leave the zeros out")) << width;
  }
  EXPECT_EQ(parseCalibration(replaced(good, "image_width: 752", "image_width: 0x2F0"), opencv)
                .camera.width(),
            752);
  const std::string remarks =
      "# made 09 of 12884902640\ntitle: \"09 12884902640\"\nlens: no 007010\nimage_width";
  EXPECT_EQ(failureOf(replaced(good, "image_width", remarks), opencv), "no failure");
  const std::string vins =
      "%YAML:1.0\n---\nmodel_type: PINHOLE\nimage_width: 752\nimage_height: 480\n"
      "distortion_parameters: { k1: 0., k2: 0., p1: 0., p2: 0. }\n"
      "projection_parameters: { fx: 400., fy: 400., cx: 370., cy: 12884902128}\n";
  EXPECT_TRUE(says(failureOf(vins, CalibrationFormat::kVins), "12884902128 is too large"));
  EXPECT_TRUE(says(failureOf("<?xml version=\"1.0\"?>\n<opencv_storage>\n<!-- 0900 -->"
                             "<image_width>12884902640</image_width></opencv_storage>\n",
                             opencv),
                   "too large"));
}

TEST(OpenCvFormat, AMissingImageSizeIsAskedFor) {
  const auto opencv = CalibrationFormat::kOpenCv;
  const std::string good = calibrationText(kRadtan, opencv);
  const std::string without =
      replaced(replaced(good, "image_width: 752\n", ""), "image_height: 480\n", "");
  EXPECT_TRUE(says(failureOf(without, opencv), "add the size of the images to the file"));
}

TEST(CalibrationFormat, CommentsDoNotTellTheFormat) {
  const std::string camchain = "%YAML:1.0\n#model_type: of VINS\n" + std::string(kCamchain);
  EXPECT_EQ(detectCalibrationFormat(camchain), CalibrationFormat::kKalibr);
}

TEST(RosFormat, CoefficientsThatNoModelHasAreNamed) {
  const std::string message =
      "height: 480\nwidth: 752\ndistortion_model: rational_polynomial\n"
      "D: [-0.28, 0.07, 0.0002, 1.7e-05, 0.01, 0.1, 0.02, 0.003]\n"
      "K: [458.6, 0.0, 367.2, 0.0, 457.2, 248.3, 0.0, 0.0, 1.0]\n";
  EXPECT_TRUE(says(failureOf(message, CalibrationFormat::kRos), "k4, k5, k6"));
}

TEST(RosFormat, ABinnedImageOrAPartOfOneIsNoticed) {
  const auto ros = CalibrationFormat::kRos;
  const std::string message =
      "height: 480\nwidth: 752\ndistortion_model: plumb_bob\nD: [0, 0, 0, 0, 0]\n"
      "K: [458.6, 0.0, 367.2, 0.0, 457.2, 248.3, 0.0, 0.0, 1.0]\n"
      "binning_x: 1\nbinning_y: 1\n"
      "roi:\n  x_offset: 0\n  y_offset: 0\n  height: 480\n  width: 752\n  do_rectify: false\n";
  EXPECT_FALSE(parseCalibration(message, ros).windowed);
  EXPECT_TRUE(parseCalibration(replaced(message, "binning_x: 1", "binning_x: 2"), ros).windowed);
  const StoredCalibration part =
      parseCalibration(replaced(message, "  width: 752", "  width: 700"), ros);
  EXPECT_TRUE(part.windowed);
  EXPECT_EQ(part.camera.width(), 752) << "of the full resolution";
}

TEST(VinsFormat, AnyNameReadsBack) {
  for (const char* name : {"front_left", "7", "front: left # 1", "\"", "a\nimage_width: 3"}) {
    CalibrationLabels labels;
    labels.camera_name = name;
    const std::string text = calibrationText(kRadtan, CalibrationFormat::kVins, labels);
    EXPECT_EQ(parseCalibration(text, CalibrationFormat::kVins).name, name) << text;
  }
}

TEST(PlainFormat, PlumbBobIsRadtan) {
  const std::string text =
      "model: plumb_bob\nwidth: 640\nheight: 480\nparams: [400, 400, 320, 240, -0.2, 0, 0, 0]\n";
  EXPECT_EQ(parseCalibration(text, CalibrationFormat::kPlain).camera.model(), CameraModel::kRadtan);
}

}  // namespace
}  // namespace camera_self_calibration
