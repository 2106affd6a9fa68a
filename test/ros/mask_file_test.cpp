#include "camera_self_calibration/ros/mask_file.h"

#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

namespace camera_self_calibration {
namespace {

std::string writtenMask(const std::string& name, int gray) {
  const std::string path = testing::TempDir() + name;
  cv::Mat image(48, 64, CV_8UC1, cv::Scalar(gray));
  image.row(47).setTo(0);
  EXPECT_TRUE(cv::imwrite(path, image));
  return path;
}

TEST(MaskFile, ReadsPathsAndUrls) {
  const std::string path = writtenMask("mask.png", 255);
  for (const std::string& url : {path, "file://" + path}) {
    const MaskReading reading = readMaskUrl(url);
    ASSERT_TRUE(reading.mask) << reading.error;
    EXPECT_EQ(reading.mask->width, 64);
    EXPECT_EQ(reading.mask->data[0], 255);
    EXPECT_EQ(reading.mask->data[47 * reading.mask->stride], 0);
  }
  const MaskReading none = readMaskUrl("");
  EXPECT_FALSE(none.mask);
  EXPECT_TRUE(none.error.empty());
}

TEST(MaskFile, SaysWhatIsWrong) {
  const std::string text = testing::TempDir() + "no_image.png";
  std::ofstream(text) << "no image";
  for (const std::string& url :
       {std::string("/nowhere/mask.png"), text,
        std::string("package://no_such_package_here/mask.png"), writtenMask("black.png", 0)}) {
    const MaskReading reading = readMaskUrl(url);
    EXPECT_FALSE(reading.mask) << url;
    EXPECT_FALSE(reading.error.empty()) << url;
  }
}

TEST(MaskFile, NamesTheReasonOfTheSystem) {
  EXPECT_NE(readMask("/nowhere/mask.png").error.find("there is no file"), std::string::npos);
  EXPECT_NE(readMask(testing::TempDir()).error.find("not a file"), std::string::npos);
}

TEST(MaskFile, FitsImagesOfItsShape) {
  const MaskReading reading = readMask(writtenMask("mask.png", 255));
  ASSERT_TRUE(reading.mask);
  EXPECT_EQ(maskMisfit(*reading.mask, 64, 48), "");
  EXPECT_EQ(maskMisfit(*reading.mask, 640, 480), "");
  EXPECT_NE(maskMisfit(*reading.mask, 752, 480).find("752 x 480"), std::string::npos);
}

}  // namespace
}  // namespace camera_self_calibration
