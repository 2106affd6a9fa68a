#include "camera_self_calibration/ros/calibration_store.h"

#include <camera_calibration_parsers/parse_yml.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <sstream>

#include "camera/sample_cameras.h"
#include "camera_self_calibration/camera/pixel_distance.h"
#include "camera_self_calibration/camera/rational_fit.h"
#include "camera_self_calibration/pipeline/atomic_file.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "camera_self_calibration/ros/model_conversion.h"
#include "pipeline/small_state.h"

namespace camera_self_calibration {
namespace {

namespace fs = std::filesystem;

const Camera kFov = camera640(CameraModel::kFov, {300, 302, 318, 242, 0.95});

class CalibrationStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("store_test_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    options_.camera_name = "eye";
    options_.calibration_file = folder_ / "eye.yaml";
    options_.state_file = folder_ / "eye.state";
  }
  void TearDown() override { fs::remove_all(folder_); }
  static sensor_msgs::CameraInfo info() { return toCameraInfo(kFov)->info; }
  CalibrationStore::Loaded load(const StoreOptions& options, CameraModel model = CameraModel::kFov,
                                int width = 640) const {
    return CalibrationStore(options).load(model, width, 480);
  }

  fs::path folder_;
  StoreOptions options_;
};

TEST_F(CalibrationStoreTest, NothingThereIsNoProblem) {
  const auto loaded = load(options_);
  EXPECT_FALSE(loaded.state);
  EXPECT_FALSE(loaded.camera);
  EXPECT_TRUE(loaded.problems.empty());
}

TEST_F(CalibrationStoreTest, LoadsWhatItSaved) {
  const auto outcome = CalibrationStore(options_).save(smallState(kFov, 3), info());
  EXPECT_TRUE(outcome.success) << outcome.message;
  EXPECT_NE(outcome.message.find("eye.yaml"), std::string::npos);
  const auto loaded = load(options_);
  EXPECT_TRUE(loaded.problems.empty());
  EXPECT_EQ(loaded.notes.size(), 2u);
  ASSERT_TRUE(loaded.state);
  EXPECT_EQ(loaded.state->epoch, 3u);
  ASSERT_TRUE(loaded.camera);
  EXPECT_EQ(loaded.camera->model(), CameraModel::kFov);
  EXPECT_LT(pixelDistance(kFov, *loaded.camera).rms, 0.1);
  // The calibration alone will do, for another model too.
  EXPECT_EQ(load(options_, CameraModel::kEquidistant).camera->model(), CameraModel::kEquidistant);
}

TEST_F(CalibrationStoreTest, WhatDoesNotFitIsNamedAndNeverWrittenOver) {
  ASSERT_TRUE(CalibrationStore(options_).save(smallState(kFov, 0), info()).success);
  const std::string state = readFile(options_.state_file).bytes;
  const std::string calibration = readFile(options_.calibration_file).bytes;
  const auto expectRefused = [&](const StoreOptions& options, const Camera& camera,
                                 std::size_t problems, const std::string& word) {
    CalibrationStore store(options);
    const auto loaded = store.load(camera.model(), camera.width(), camera.height());
    ASSERT_EQ(loaded.problems.size(), problems);
    std::string all;
    for (const std::string& problem : loaded.problems) all += problem;
    EXPECT_NE(all.find(word), std::string::npos) << all;
    const auto outcome = store.save(smallState(camera, 1), toCameraInfo(camera)->info);
    EXPECT_FALSE(outcome.success);
    EXPECT_NE(outcome.message.find("left untouched"), std::string::npos) << outcome.message;
  };
  expectRefused(options_, Camera::defaultGuess(CameraModel::kFov, 320, 240), 2, "640 x 480");
  StoreOptions other = options_;
  other.camera_name = "ear";
  expectRefused(other, kFov, 1, "'eye'");
  EXPECT_EQ(readFile(options_.calibration_file).bytes, calibration);
  expectRefused(options_, Camera::defaultGuess(CameraModel::kPinhole, 640, 480), 1,
                "the model fov");

  for (const std::string& bytes : std::vector<std::string>{"", state.substr(0, 100), "x: y"}) {
    ASSERT_EQ(writeFileAtomically(options_.state_file, bytes), "");
    ASSERT_EQ(writeFileAtomically(options_.calibration_file, bytes), "");
    expectRefused(options_, kFov, 2, "not used");
    EXPECT_EQ(readFile(options_.state_file).bytes, bytes);
    EXPECT_EQ(readFile(options_.calibration_file).bytes, bytes);
  }
}

// A good file of the right camera, of which a single value is of no use to this program.
TEST_F(CalibrationStoreTest, WhatIsRefusedAsAStartIsNeverWrittenOver) {
  sensor_msgs::CameraInfo unknown = info();
  unknown.distortion_model = "brown_conrady";
  sensor_msgs::CameraInfo no_number = info();
  no_number.K[0] = std::numeric_limits<double>::quiet_NaN();
  sensor_msgs::CameraInfo negative = info();
  negative.K[0] = -300.0;
  sensor_msgs::CameraInfo bent = info();
  bent.D[0] = std::numeric_limits<double>::quiet_NaN();
  sensor_msgs::CameraInfo uncalibrated = uncalibratedCameraInfo(640, 480);
  for (const auto& given : {unknown, no_number, negative, bent, uncalibrated}) {
    std::ostringstream text;
    ASSERT_TRUE(camera_calibration_parsers::writeCalibrationYml(text, "eye", given));
    ASSERT_EQ(writeFileAtomically(options_.calibration_file, text.str()), "");
    CalibrationStore store(options_);
    const auto loaded = store.load(CameraModel::kFov, 640, 480);
    EXPECT_FALSE(loaded.camera);
    ASSERT_EQ(loaded.problems.size(), 1u);
    EXPECT_NE(loaded.problems[0].find("left untouched"), std::string::npos) << loaded.problems[0];
    EXPECT_FALSE(store.save(smallState(kFov, 1), info()).success);
    EXPECT_EQ(readFile(options_.calibration_file).bytes, text.str());
  }
}

// On which camera_calibration_parsers ends the process.
TEST_F(CalibrationStoreTest, AMatrixOfAnotherSizeIsRefused) {
  options_.state_file.clear();
  ASSERT_TRUE(CalibrationStore(options_).save(smallState(kFov, 0), info()).success);
  const std::string good = readFile(options_.calibration_file).bytes;
  const auto expectRefused = [&](const std::string& last, const std::string& other) {
    std::string bytes = good;
    bytes.replace(bytes.rfind(last), last.size(), other);
    ASSERT_EQ(writeFileAtomically(options_.calibration_file, bytes), "");
    CalibrationStore store(options_);
    const auto loaded = store.load(CameraModel::kFov, 640, 480);
    ASSERT_EQ(loaded.problems.size(), 1u);
    EXPECT_NE(loaded.problems[0].find("'projection_matrix' of"), std::string::npos)
        << loaded.problems[0];
    EXPECT_FALSE(store.save(smallState(kFov, 0), info()).success);
    EXPECT_EQ(readFile(options_.calibration_file).bytes, bytes);
  };
  expectRefused("cols: 4", "cols: 3");
  expectRefused("rows: 3", "rows: 30");
}

// yaml-cpp would take it for UTF-32, cut off.
TEST_F(CalibrationStoreTest, AFileThatIsNoTextIsRefused) {
  const std::string binary("\x2c\0\0\0\xf8\x7f\xba\xff\x7f\0\0\0\0\x06\x38\x20", 16);
  ASSERT_EQ(writeFileAtomically(options_.calibration_file, binary), "");
  ASSERT_EQ(load(options_).problems.size(), 1u);
  EXPECT_FALSE(CalibrationStore(options_).save(smallState(kFov, 3), info()).success);
  EXPECT_EQ(readFile(options_.calibration_file).bytes, binary);
}

TEST_F(CalibrationStoreTest, AFileOnWhichYamlCppOfDebian11DoesNotEndIsRefused) {
  const std::string endless = "camera_matrix:\n  rows: 1\n  data: [1, 2, :]\n";
  ASSERT_EQ(writeFileAtomically(options_.calibration_file, endless), "");
  EXPECT_EQ(load(options_).problems.size(), 1u);
}

TEST_F(CalibrationStoreTest, WhatWasLearntOfAnotherLensIsKept) {
  CalibrationStore store(options_);
  ASSERT_TRUE(store.save(smallState(kFov, 0), info()).success);
  const std::string first = readFile(options_.state_file).bytes;
  EXPECT_FALSE(readFile(options_.state_file + ".previous").exists);
  ASSERT_TRUE(store.save(smallState(kFov, 1), info()).success);
  EXPECT_EQ(readFile(options_.state_file + ".previous").bytes, first);
  const std::string second = readFile(options_.state_file).bytes;
  ASSERT_TRUE(store.save(smallState(kFov, 1), info()).success);
  EXPECT_EQ(readFile(options_.state_file + ".previous").bytes, first);
  store.beginAnew();
  ASSERT_TRUE(store.save(smallState(kFov, 1), info()).success);
  EXPECT_EQ(readFile(options_.state_file + ".previous").bytes, second);
}

// What a calibration of the pair knew is not lost with that of one camera.
TEST_F(CalibrationStoreTest, RectificationOfAStereoPairIsKept) {
  sensor_msgs::CameraInfo pair = info();
  pair.P[3] = -36.0;
  CalibrationStore store(options_);
  ASSERT_TRUE(store.saveGiven(CameraModel::kFov, pair).success);
  const std::string left = readFile(options_.calibration_file).bytes;
  const std::string previous = options_.calibration_file + ".previous";
  ASSERT_TRUE(store.saveGiven(CameraModel::kFov, pair).success);
  EXPECT_FALSE(readFile(previous).exists) << "nothing is lost yet";
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(store.save(smallState(kFov, 0), info()).success);
    EXPECT_EQ(readFile(previous).bytes, left);
  }
}

TEST_F(CalibrationStoreTest, WhatIsGivenIsTheNextStart) {
  CalibrationStore store(options_);
  ASSERT_TRUE(store.save(smallState(kFov, 0), info()).success);
  const Camera given = camera640(CameraModel::kEquidistant, {350, 351, 320, 240, 0, 0, 0, 0});
  const auto outcome = store.saveGiven(CameraModel::kFov, toCameraInfo(given)->info);
  EXPECT_TRUE(outcome.success) << outcome.message;
  const auto loaded = load(options_);
  EXPECT_FALSE(loaded.state) << "what was learnt before is not preferred";
  EXPECT_TRUE(readFile(options_.state_file + ".previous").exists);
  ASSERT_TRUE(loaded.camera);
  EXPECT_LT(pixelDistance(given, *loaded.camera).rms, 1.0);
  StoreOptions nowhere;
  EXPECT_FALSE(CalibrationStore(nowhere).saveGiven(CameraModel::kFov, info()).success);
}

// A lens that no distortion model of camera_info holds goes out as zeros, CONVERGED as it may be.
TEST_F(CalibrationStoreTest, ZerosNeverReplaceACalibration) {
  CalibrationStore store(options_);
  ASSERT_TRUE(store.save(smallState(kFov, 0), info()).success);
  const std::string calibration = readFile(options_.calibration_file).bytes;
  const sensor_msgs::CameraInfo zeros = uncalibratedCameraInfo(640, 480);
  for (const auto& outcome :
       {store.save(smallState(kFov, 0), zeros), store.saveGiven(std::nullopt, zeros)}) {
    EXPECT_FALSE(outcome.success);
    EXPECT_NE(outcome.message.find("camera_info is zeros"), std::string::npos) << outcome.message;
  }
  EXPECT_EQ(readFile(options_.calibration_file).bytes, calibration);
  EXPECT_TRUE(load(options_).state) << "what was learnt is still kept";
}

TEST_F(CalibrationStoreTest, SaysWhereItCannotWrite) {
  ASSERT_EQ(writeFileAtomically(folder_ / "file", "x"), "");
  options_.state_file = folder_ / "file" / "below.state";
  const auto outcome = CalibrationStore(options_).save(smallState(kFov, 0), info());
  EXPECT_FALSE(outcome.success);
  EXPECT_NE(outcome.message.find("below.state"), std::string::npos) << outcome.message;
  EXPECT_NE(outcome.message.find("saved to"), std::string::npos) << "the other one was";
  EXPECT_FALSE(CalibrationStore(StoreOptions()).save(smallState(kFov, 0), info()).success);
}

TEST(CameraStart, IsExactWhereTheModelsAgree) {
  const Camera radtan =
      camera640(CameraModel::kRadtan, {400, 401, 320, 240, -0.2, 0.05, 0.001, -0.001});
  const auto same = startFrom(toCameraInfo(radtan)->info, CameraModel::kRadtan);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->camera.parameters(), radtan.parameters());
  const Camera pinhole = camera640(CameraModel::kPinhole, {400, 401, 320, 240});
  const auto wider = startFrom(toCameraInfo(pinhole)->info, CameraModel::kRadtan);
  ASSERT_TRUE(wider);
  EXPECT_EQ(wider->error.max, 0.0);
  EXPECT_EQ(wider->camera.estimatedCount(), 8);
  EXPECT_EQ(wider->camera.parameters().head<4>(), pinhole.parameters());
  EXPECT_FALSE(startFrom(sensor_msgs::CameraInfo(), CameraModel::kFov));
  EXPECT_FALSE(startFrom(uncalibratedCameraInfo(640, 480), CameraModel::kFov));
}

// fov sees nothing at 90 degrees from the axis or beyond, as the corners of this fisheye do.
TEST(CameraStart, ReachesTheWholeImageOrIsNone) {
  const Camera fisheye = camera640(CameraModel::kEquidistant, {200, 200, 320, 240, 0, 0, 0, 0});
  const auto fit = fitCamera(fisheye, CameraModel::kPinhole);
  ASSERT_FALSE(fit && std::isfinite(fit->error.max)) << "else this tests nothing";
  EXPECT_FALSE(startFrom(toCameraInfo(fisheye)->info, CameraModel::kPinhole));
  EXPECT_NE(whyNoStart(toCameraInfo(fisheye)->info, CameraModel::kPinhole).find("whole image"),
            std::string::npos);
}

// No radtan goes on growing as far out as this lens does.
TEST(CameraStart, AFitOfARationalPolynomialReachesTheWholeImageOrIsNone) {
  const RationalPolynomial lens{300, 300, 320, 240, {0.2, 0, 0, 0, 0, 0.6, 0, 0}};
  const auto fit = fitCamera(lens, 640, 480, CameraModel::kRadtan);
  ASSERT_FALSE(fit && std::isfinite(fit->error.max)) << "else this tests nothing";
  sensor_msgs::CameraInfo info = uncalibratedCameraInfo(640, 480);
  info.distortion_model = "rational_polynomial";
  info.K = {300, 0, 320, 0, 300, 240, 0, 0, 1};
  info.D.assign(lens.coefficients.begin(), lens.coefficients.end());
  EXPECT_FALSE(startFrom(info, CameraModel::kRadtan));
  EXPECT_NE(whyNoStart(info, CameraModel::kRadtan).find("radtan over the whole image"),
            std::string::npos);
  const auto fisheye = startFrom(info, CameraModel::kEquidistant);
  ASSERT_TRUE(fisheye);
  EXPECT_GT(fisheye->error.max, 0.0) << "what the fit costs is known";
  EXPECT_LT(fisheye->error.max, 5.0);
}

TEST(CameraStart, EveryRefusalHasItsReason) {
  const sensor_msgs::CameraInfo good = toCameraInfo(kFov)->info;
  const auto why = [&good](const std::function<void(sensor_msgs::CameraInfo*)>& spoil) {
    sensor_msgs::CameraInfo info = good;
    spoil(&info);
    EXPECT_FALSE(startFrom(info, CameraModel::kFov));
    return whyNoStart(info, CameraModel::kFov);
  };
  using Info = sensor_msgs::CameraInfo;
  EXPECT_NE(why([](Info* i) { i->width = 0; }).find("size"), std::string::npos);
  EXPECT_NE(why([](Info* i) { i->K.assign(0.0); }).find("uncalibrated"), std::string::npos);
  EXPECT_NE(why([](Info* i) { i->K[0] = -300.0; }).find("positive"), std::string::npos);
  EXPECT_NE(why([](Info* i) { i->D[1] = std::nan(""); }).find("numbers"), std::string::npos);
  EXPECT_NE(why([](Info* i) { i->distortion_model = "fov"; }).find("'fov'"), std::string::npos);
  EXPECT_NE(why([](Info* i) { i->D.resize(3); }).find("has 4 coefficients, but it holds 3"),
            std::string::npos);
  EXPECT_NE(why([](Info* i) { i->D[0] = 1e30; }).find("k1 = 1e+30"), std::string::npos);
  const auto rational = [](Info* i) {
    i->distortion_model = "rational_polynomial";
    i->D.assign(8, 0.1);
    i->K[2] = 1e25;
  };
  EXPECT_NE(why(rational).find("principal point"), std::string::npos);
}

}  // namespace
}  // namespace camera_self_calibration
