#include "camera_self_calibration/tools/image_source.h"

#include <gtest/gtest.h>
#include <sensor_msgs/image_encodings.h>
#include <std_msgs/String.h>
#include <sys/resource.h>

#include <cstring>
#include <fstream>
#include <limits>
#include <opencv2/videoio.hpp>
#include <sstream>

#include "sanitized.h"
#include "tools/movie_file.h"
#include "tools/small_sequence.h"
#include "tools/temporary_folder.h"

namespace camera_self_calibration {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

cv::Mat picture(int brightness) {
  return cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(brightness));
}

sensor_msgs::Image rawMessage(double seconds, int brightness) {
  sensor_msgs::Image message;
  if (seconds > 0.0) message.header.stamp = ros::Time(seconds);
  message.encoding = sensor_msgs::image_encodings::MONO8;
  message.width = kWidth;
  message.height = kHeight;
  message.step = kWidth;
  message.data.assign(kWidth * kHeight, static_cast<std::uint8_t>(brightness));
  return message;
}

SourceOptions at(const std::string& path) {
  SourceOptions options;
  options.path = path;
  return options;
}

struct Seen {
  std::vector<double> seconds;
  std::vector<int> brightness;
  int errors = 0;
};

Seen readAll(const SourceOptions& options) {
  ImageSource source = openImages(options);
  Seen seen;
  while (const auto image = source.next()) {
    if (!image->view) {
      ++seen.errors;
      continue;
    }
    EXPECT_EQ(image->view->width, kWidth);
    EXPECT_EQ(image->view->height, kHeight);
    seen.seconds.push_back(toSeconds(image->view->stamp_ns));
    seen.brightness.push_back(image->view->data[image->view->stride * 10 + 10]);
  }
  EXPECT_FALSE(source.next());
  return seen;
}

std::string failureOf(const SourceOptions& options) {
  try {
    readAll(options);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return {};
}

TEST(ImageSource, FolderIsReadInTheOrderOfNames) {
  const TemporaryFolder folder;
  cv::imwrite(folder / "002.png", picture(20));
  cv::imwrite(folder / "001.png", picture(10));
  cv::imwrite(folder / "003.PNG", picture(30));
  std::ofstream(folder / "readme.txt") << "no image";
  std::ofstream(folder / "004.jpg") << "no image either";
  SourceOptions options = at(folder.string());
  options.rate = 10.0;
  const Seen seen = readAll(options);
  EXPECT_EQ(seen.brightness, (std::vector<int>{10, 20, 30}));
  EXPECT_EQ(seen.errors, 1);
  ASSERT_EQ(seen.seconds.size(), 3u);
  EXPECT_EQ(seen.seconds[0], 0.0);
  EXPECT_NEAR(seen.seconds[2], 0.2, 1e-9);
}

TEST(ImageSource, NumbersInNamesAreCountedNotSpelt) {
  const TemporaryFolder folder;
  for (const int i : {1, 2, 9, 10, 11, 100}) {
    cv::imwrite(folder / ("img" + std::to_string(i) + ".png"), picture(i));
  }
  EXPECT_EQ(readAll(at(folder.string())).brightness, (std::vector<int>{1, 2, 9, 10, 11, 100}));
  const std::string said = openImages(at(folder.string())).description;
  EXPECT_NE(said.find("6 images in the order img1.png, img2.png, img9.png, ..., img100.png"),
            std::string::npos)
      << said;
}

TEST(ImageSource, APictureThatIsCutOffIsNamedAndLeftOut) {
  const TemporaryFolder folder;
  cv::Mat noise(kHeight, kWidth, CV_8UC1);
  cv::randu(noise, 0, 255);
  for (const std::string name : {"1.jpg", "2.png", "3.jpg"}) {
    cv::imwrite(folder / name, noise);
    if (name != "3.jpg") {
      std::filesystem::resize_file(folder / name,
                                   std::filesystem::file_size(folder / name) * 6 / 10);
    }
  }
  const Seen seen = readAll(at(folder.string()));
  EXPECT_EQ(seen.errors, 2);
  EXPECT_EQ(seen.brightness.size(), 1u);
  const ImageSource source = openImages(at(folder.string()));
  const auto first = source.next();
  ASSERT_TRUE(first && !first->view);
  EXPECT_NE(first->error.find("1.jpg: "), std::string::npos) << first->error;
}

TEST(ImageSource, APictureThatCannotBeReadSaysWhy) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.png") << 'x';
  std::filesystem::resize_file(folder / "a.png", std::uintmax_t{1} << 30);
  ImageSource source = openImages(at(folder.string()));
  const std::optional<GrayImage> image = source.next();
  ASSERT_TRUE(image && !image->view);
  EXPECT_NE(image->error.find("a.png is too large"), std::string::npos) << image->error;
}

TEST(ImageSource, ATimeBeyondTheLastImageLeavesNone) {
  const TemporaryFolder folder;
  for (int i = 0; i < 3; ++i) cv::imwrite(folder / (std::to_string(i) + ".png"), picture(i));
  for (const double start : {1e9, 1e300, std::numeric_limits<double>::infinity()}) {
    SourceOptions options = at(folder.string());
    options.start_seconds = start;
    EXPECT_EQ(openImages(options).count, 0) << start;
    EXPECT_FALSE(openImages(options).next()) << start;
    options.start_seconds = 0.0;
    options.duration_seconds = start;
    EXPECT_EQ(openImages(options).count, 3) << start;
  }
}

TEST(ImageSource, OptionsOfAnotherKindOfInputAreRefused) {
  const TemporaryFolder folder;
  { rosbag::Bag bag(folder / "a.bag", rosbag::bagmode::Write); }
  SourceOptions options = at(folder / "a.bag");
  options.rate = 30.0;
  EXPECT_NE(failureOf(options).find("--rate is for folders"), std::string::npos);
  options = at(folder.string());
  options.topic = "/image";
  EXPECT_NE(failureOf(options).find("--topic chooses images of a bag"), std::string::npos);
}

TEST(ImageSource, StartAndDurationCountFromTheFirstImage) {
  const TemporaryFolder folder;
  for (int i = 0; i < 10; ++i) cv::imwrite(folder / (std::to_string(i) + ".png"), picture(i));
  rosbag::Bag bag(folder / "a.bag", rosbag::bagmode::Write);
  for (int i = 0; i < 10; ++i)
    bag.write("image", ros::Time(50 + 0.5 * i), rawMessage(50 + 0.5 * i, i));
  bag.close();
  for (const std::string& path : {folder.string(), folder / "a.bag"}) {
    SourceOptions options = at(path);
    options.rate = path == folder.string() ? 2.0 : 0.0;
    options.start_seconds = 1.0;
    options.duration_seconds = 1.5;
    EXPECT_EQ(readAll(options).brightness, (std::vector<int>{2, 3, 4})) << path;
    EXPECT_EQ(openImages(options).count, 3) << path;
  }
}

TEST(ImageSource, TimesOfTopicsTogetherCountFromTheLastToBegin) {
  const TemporaryFolder folder;
  rosbag::Bag bag(folder / "a.bag", rosbag::bagmode::Write);
  for (int i = 0; i < 10; ++i) bag.write("left", ros::Time(50 + i), rawMessage(50 + i, i));
  for (int i = 5; i < 10; ++i) bag.write("right", ros::Time(50 + i), rawMessage(50 + i, i));
  bag.close();
  SourceOptions options = at(folder / "a.bag");
  options.together = {"left", "right"};
  options.start_seconds = 1.0;
  options.duration_seconds = 2.0;
  for (const std::string& topic : options.together) {
    options.topic = topic;
    EXPECT_EQ(readAll(options).brightness, (std::vector<int>{6, 7})) << topic;
  }
}

TEST(ImageSource, BagFindsItsOnlyImageTopic) {
  const TemporaryFolder folder;
  rosbag::Bag bag(folder / "a.bag", rosbag::bagmode::Write);
  std_msgs::String text;
  bag.write("chatter", ros::Time(1.0), text);
  bag.write("image", ros::Time(2.0), rawMessage(1.5, 7));
  // A driver that sets no stamp: the time of the recording counts.
  bag.write("image", ros::Time(3.0), rawMessage(0.0, 8));
  bag.close();
  EXPECT_EQ(openImages(at(folder / "a.bag")).name, "image");
  const Seen seen = readAll(at(folder / "a.bag"));
  EXPECT_EQ(seen.brightness, (std::vector<int>{7, 8}));
  EXPECT_EQ(seen.seconds, (std::vector<double>{1.5, 3.0}));
}

TEST(ImageSource, ABagByAnotherNameIsABag) {
  const TemporaryFolder folder;
  sensor_msgs::CompressedImage jpeg;
  cv::imencode(".jpg", picture(40), jpeg.data);
  jpeg.header.stamp = ros::Time(1.5);
  {
    rosbag::Bag bag(folder / "a.bag", rosbag::bagmode::Write);
    bag.write("image/compressed", ros::Time(2.0), jpeg);
  }
  for (const std::string name : {"recording", "recording.avi"}) {
    std::filesystem::copy_file(folder / "a.bag", folder / name);
    EXPECT_EQ(readAll(at(folder / name)).seconds, std::vector<double>{1.5}) << name;
  }
}

TEST(ImageSource, BagOfSeveralTopicsAsksWhich) {
  const TemporaryFolder folder;
  rosbag::Bag bag(folder / "a.bag", rosbag::bagmode::Write);
  bag.write("/left/image_raw", ros::Time(1.0), rawMessage(1.0, 1));
  sensor_msgs::CompressedImage jpeg;
  cv::imencode(".png", picture(2), jpeg.data);
  jpeg.header.stamp = ros::Time(1.0);
  bag.write("/right/image_raw/compressed", ros::Time(1.0), jpeg);
  bag.close();
  SourceOptions options = at(folder / "a.bag");
  const std::string failure = failureOf(options);
  for (const char* word : {"/left/image_raw", "/right/image_raw/compressed", "--topic"}) {
    EXPECT_NE(failure.find(word), std::string::npos) << failure;
  }
  options.topic = "/left/image_raw";
  EXPECT_EQ(readAll(options).brightness, std::vector<int>{1});
  options.topic = "/right/image_raw";
  EXPECT_EQ(readAll(options).brightness, std::vector<int>{2});
  options.topic = "/top/image_raw";
  EXPECT_NE(failureOf(options).find("/left/image_raw"), std::string::npos);
}

TEST(ImageSource, VideoIsReadAsGray) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.avi";
  cv::VideoWriter writer(path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 20.0,
                         cv::Size(kWidth, kHeight));
  ASSERT_TRUE(writer.isOpened());
  for (int i = 0; i < 8; ++i) {
    writer.write(cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar::all(20 * i)));
  }
  writer.release();
  const Seen seen = readAll(at(path));
  ASSERT_EQ(seen.brightness.size(), 8u);
  EXPECT_NEAR(seen.brightness[5], 100, 3);
  EXPECT_NEAR(seen.seconds[7] - seen.seconds[0], 7 / 20.0, 1e-6);
  SourceOptions part = at(path);
  part.start_seconds = 0.1;
  part.duration_seconds = 0.15;
  EXPECT_EQ(readAll(part).brightness.size(), 3u);
}

TEST(ImageSource, AVideoKeepsItsOwnTimesAndTheSensorsOrientation) {
  if (100 * CV_VERSION_MAJOR + CV_VERSION_MINOR < 406) GTEST_SKIP() << "this OpenCV is too old";
  const TemporaryFolder folder;
  MovieFile movie;
  for (int i = 0; i < 6; ++i) movie.images.push_back(picture(40 * i));
  movie.milliseconds = {33, 50, 33, 200, 33, 33};
  movie.write(folder / "phone.mov");
  const Seen seen = readAll(at(folder / "phone.mov"));  // It expects the size before any turn.
  ASSERT_EQ(seen.seconds.size(), 6u);
  const std::vector<double> expected = {0.0, 0.033, 0.083, 0.116, 0.316, 0.349};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(seen.seconds[i], expected[i], 1e-6) << i;
    EXPECT_NEAR(seen.brightness[i], 40.0 * static_cast<double>(i), 3.0) << i;
  }
  const std::string said = openImages(at(folder / "phone.mov")).description;
  EXPECT_NE(said.find("times that stand in the video"), std::string::npos) << said;
  EXPECT_NE(said.find("asks to be shown turned"), std::string::npos) << said;

  SourceOptions options = at(folder / "phone.mov");
  options.start_seconds = 0.05;
  options.duration_seconds = 0.1;
  EXPECT_EQ(readAll(options).seconds.size(), 2u);
  options = at(folder / "phone.mov");
  options.rate = 10.0;
  EXPECT_NEAR(readAll(options).seconds.back(), 0.5, 1e-9);
  EXPECT_NE(openImages(options).description.find("10 Hz"), std::string::npos);
}

TEST(ImageSource, SaysWhatIsWrongWithAFile) {
  const TemporaryFolder folder;
  EXPECT_NE(failureOf(at(folder / "none.bag")).find("no file"), std::string::npos);
  std::ofstream(folder / "noise.bag") << "this is not a bag at all";
  EXPECT_NE(failureOf(at(folder / "noise.bag")).find("noise.bag"), std::string::npos);
  std::ofstream(folder / "text.txt") << "no video";
  EXPECT_NE(failureOf(at(folder / "text.txt")).find("neither"), std::string::npos);
}

TEST(ImageSource, ATruncatedBagIsAnErrorNotACrash) {
  const TemporaryFolder folder;
  {
    rosbag::Bag bag(folder / "whole.bag", rosbag::bagmode::Write);
    for (int i = 1; i < 200; ++i) bag.write("image", ros::Time(i), rawMessage(i, i));
  }
  const auto size = std::filesystem::file_size(folder / "whole.bag");
  for (const double share : {0.0, 0.01, 0.5, 0.95, 0.999}) {
    std::filesystem::copy_file(folder / "whole.bag", folder / "cut.bag",
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(folder / "cut.bag",
                                 static_cast<std::uintmax_t>(share * static_cast<double>(size)));
    EXPECT_NE(failureOf(at(folder / "cut.bag")).find("rosbag reindex"), std::string::npos) << share;
  }
}

/// Lowers the limit of this process on memory, which its children inherit.
class MemoryLimit {
 public:
  explicit MemoryLimit(rlim_t bytes) {
    getrlimit(RLIMIT_AS, &before_);
    const rlimit lowered = {bytes, before_.rlim_max};
    setrlimit(RLIMIT_AS, &lowered);
  }
  ~MemoryLimit() { setrlimit(RLIMIT_AS, &before_); }

 private:
  rlimit before_ = {};
};

// librosbag writes to a null pointer where there is not as much memory as a length claims.
TEST(ImageSource, ADamagedLengthInABagDoesNotEndTheProgram) {
  if (kSanitized) GTEST_SKIP() << "sanitizers need all addresses";
  const TemporaryFolder folder;
  {
    rosbag::Bag bag(folder / "whole.bag", rosbag::bagmode::Write);
    bag.write("image", ros::Time(1.0), rawMessage(1.0, 1));
  }
  std::stringstream whole;
  whole << std::ifstream(folder / "whole.bag", std::ios::binary).rdbuf();
  // Before the first field of the record CHUNK_INFO stands its length, before that the header's.
  const std::size_t header_length = whole.str().rfind("chunk_pos=") - 8;
  const MemoryLimit limit(rlim_t{2} << 30);
  for (const std::uint32_t length : {0xFFFFFFF0u, 0x7FFFFFF0u}) {
    std::string bytes = whole.str();
    std::memcpy(&bytes[header_length], &length, sizeof(length));
    std::ofstream(folder / "bad.bag", std::ios::binary) << bytes;
    const std::string failure = failureOf(at(folder / "bad.bag"));
    EXPECT_NE(failure.find("rosbag reindex"), std::string::npos) << failure;
  }
}

}  // namespace
}  // namespace camera_self_calibration
