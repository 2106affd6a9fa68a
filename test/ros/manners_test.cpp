// The nodelet among others in one manager: comes and goes without a trace, minds its own camera,
// copies nothing, holds nobody up.

#include <camera_self_calibration/SelfCalibrationConfig.h>
#include <dynamic_reconfigure/client.h>
#include <gtest/gtest.h>
#include <nodelet/NodeletList.h>
#include <nodelet/loader.h>
#include <ros/callback_queue.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/spinner.h>
#include <ros/xmlrpc_manager.h>
#include <sensor_msgs/CompressedImage.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <fstream>
#include <iostream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <thread>

#include "camera/sample_cameras.h"
#include "ros/robot.h"
#include "sanitized.h"

namespace camera_self_calibration {
namespace {

/// Some rendered images, again and again, forth and back, with growing stamps.
class Clip {
 public:
  explicit Clip(int width) {
    SequenceOptions options;
    options.lens.camera = Camera::defaultGuess(CameraModel::kFov, width, width * 3 / 4);
    options.room.texture_detail = 0.3;
    options.rate_hz = 15.0;
    options.motion.speed = 0.6;
    const SimulatedSequence sequence(options);
    for (int i = 0; i < 25; ++i) images_.push_back(toMessage(sequence.frame(i).view()));
  }
  sensor_msgs::ImagePtr next() {
    const int last = static_cast<int>(images_.size()) - 1;
    const int phase = count_ % (2 * last);
    auto image =
        boost::make_shared<sensor_msgs::Image>(images_[phase <= last ? phase : 2 * last - phase]);
    image->header.stamp = ros::Time(1000.0 + count_++ / 15.0);
    return image;
  }

 private:
  std::vector<sensor_msgs::Image> images_;
  int count_ = 0;
};

/// Publishes a clip in the background.
class Stream {
 public:
  Stream(const std::string& topic, int width, double rate_hz)
      : clip_(width),
        publisher_(ros::NodeHandle().advertise<sensor_msgs::Image>(topic, 5)),
        thread_([this, rate_hz] {
          while (!stop_) {
            publisher_.publish(clip_.next());
            ros::WallDuration(1.0 / rate_hz).sleep();
          }
        }) {}
  ~Stream() {
    stop_ = true;
    thread_.join();
  }

 private:
  Clip clip_;
  ros::Publisher publisher_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// Process id of a node, asked of itself; 0 if it does not answer.
int pidOf(const std::string& node) {
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = "/manners_test";
  request[1] = node;
  if (!ros::master::execute("lookupNode", request, response, payload, false)) return 0;
  std::string host;
  std::uint32_t port = 0;
  ros::network::splitURI(static_cast<std::string>(payload), host, port);
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue caller, answer;
  caller[0] = "/manners_test";
  if (!client.execute("getPid", caller, answer) || answer.size() < 3) return 0;
  return static_cast<int>(answer[2]);
}

/// A number from /proc/PID/status, such as "VmRSS" [kB] or "Threads".
long statusOf(int pid, const std::string& key) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, key.size() + 1, key + ":") != 0) continue;
    return std::stol(line.substr(key.size() + 1));
  }
  return -1;
}

bool isAdvertised(const std::string& topic) {
  ros::master::V_TopicInfo topics;
  EXPECT_TRUE(ros::master::getTopics(topics));
  return std::any_of(topics.begin(), topics.end(),
                     [&](const ros::master::TopicInfo& info) { return info.name == topic; });
}

bool holds(const std::string& nodelet_name) {
  nodelet::NodeletList list;
  if (!ros::service::call("/manager/list", list)) return false;
  const auto& names = list.response.nodelets;
  return std::find(names.begin(), names.end(), nodelet_name) != names.end();
}

template <typename Message>
bool hears(const Recorder<Message>& recorder, std::size_t more) {
  const std::size_t before = recorder.messages.size();
  return spinUntil([&] { return recorder.messages.size() >= before + more; }, 20.0);
}

class Manners : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(ros::service::waitForService("/manager/load_nodelet", 20000));
  }
};

TEST_F(Manners, TwentyTimesLoadedAndUnloadedLeavesNothingBehind) {
  const Stream stream("/left_camera/image_raw", 320, 30.0);
  Recorder<TrackingStatus> status("/left/tracking_status");
  const int pid = pidOf("/manager");
  ASSERT_GT(pid, 0);
  long memory_before = 0;
  long threads_before = 0;
  for (int round = 0; round < 20; ++round) {
    ASSERT_TRUE(loadNodelet("/left", "/left_camera/image_raw")) << round;
    EXPECT_TRUE(hears(status, 3)) << round;
    ASSERT_TRUE(unloadNodelet("/left")) << round;
    ASSERT_FALSE(holds("/left"));
    if (round == 7) {  // pools of memory and threads are filled by then
      memory_before = statusOf(pid, "VmRSS");
      threads_before = statusOf(pid, "Threads");
    }
  }
  // The nodelet's end is not over when the service answers.
  EXPECT_TRUE(spinUntil([&] { return statusOf(pid, "Threads") <= threads_before; }, 10.0));
  EXPECT_TRUE(spinUntil([] { return !isAdvertised("/left/tracking_status"); }, 10.0));
  const long memory = statusOf(pid, "VmRSS");
  const long threads = statusOf(pid, "Threads");
  std::cout << "manager: " << memory_before << " kB and " << threads_before
            << " threads after 8 rounds, " << memory << " kB and " << threads << " after 20\n";
  EXPECT_EQ(pidOf("/manager"), pid) << "the manager died";
  if (kSanitized) return;  // a sanitizer keeps what is freed for a while
  EXPECT_LT(memory - memory_before, 12 * 300) << "at most 300 kB a round";
}

TEST_F(Manners, TwoCamerasInOneManagerKeepApart) {
  const Stream left_stream("/left_camera/image_raw", 320, 15.0);
  const Stream right_stream("/right_camera/image_raw", 256, 15.0);
  ASSERT_TRUE(loadNodelet("/left", "/left_camera/image_raw"));
  ASSERT_TRUE(loadNodelet("/right", "/right_camera/image_raw"));
  Recorder<Calibration> left("/left/calibration"), right("/right/calibration");
  Recorder<sensor_msgs::CameraInfo> left_info("/left/camera_info"),
      right_info("/right/camera_info");
  EXPECT_TRUE(hears(left, 3));
  EXPECT_TRUE(hears(right, 3));
  EXPECT_TRUE(hears(left_info, 3));
  EXPECT_TRUE(hears(right_info, 3));
  for (const auto& message : left.messages) {
    EXPECT_EQ(message->model, "fov");
    EXPECT_EQ(message->width, 320u);
  }
  for (const auto& message : right.messages) {
    EXPECT_EQ(message->model, "pinhole");
    EXPECT_EQ(message->width, 256u);
  }
  for (const auto& info : left_info.messages) EXPECT_EQ(info->width, 320u);
  for (const auto& info : right_info.messages) EXPECT_EQ(info->width, 256u);
  // One goes, the other stays.
  ASSERT_TRUE(unloadNodelet("/left"));
  EXPECT_TRUE(hears(right, 1));
  EXPECT_TRUE(hears(right_info, 5));
  ASSERT_TRUE(unloadNodelet("/right"));
}

TEST_F(Manners, LiveParametersChangeWhileItRuns) {
  const Stream stream("/left_camera/image_raw", 320, 15.0);
  ASSERT_TRUE(loadNodelet("/left", "/left_camera/image_raw"));
  // The client waits for answers that another thread has to hear.
  ros::CallbackQueue queue;
  ros::NodeHandle client_node("/left");
  client_node.setCallbackQueue(&queue);
  ros::AsyncSpinner spinner(1, &queue);
  spinner.start();
  dynamic_reconfigure::Client<SelfCalibrationConfig> client("/left", client_node);
  SelfCalibrationConfig config;
  ASSERT_TRUE(client.getCurrentConfiguration(config, ros::Duration(10.0)));
  EXPECT_EQ(config.min_publish_change_px, 0.1);
  EXPECT_TRUE(config.publish_tf);
  Recorder<tf2_msgs::TFMessage> tf("/tf");
  EXPECT_TRUE(hears(tf, 2));
  config.publish_tf = false;
  ASSERT_TRUE(client.setConfiguration(config));
  Recorder<TrackingStatus> status("/left/tracking_status");
  EXPECT_TRUE(hears(status, 3));
  const std::size_t transforms = tf.messages.size();
  EXPECT_TRUE(hears(status, 8));
  EXPECT_LE(tf.messages.size(), transforms + 2) << "those under way";
  config.publish_tf = true;
  ASSERT_TRUE(client.setConfiguration(config));
  EXPECT_TRUE(hears(tf, 2));
  ASSERT_TRUE(unloadNodelet("/left"));
}

/// Counts the images of a size that OpenCV makes in this process while it exists.
class ImageCounter : public cv::MatAllocator {
 public:
  ImageCounter(int width, int height) : size_{height, width} { cv::Mat::setDefaultAllocator(this); }
  ~ImageCounter() override { cv::Mat::setDefaultAllocator(standard_); }
  int gray() const { return gray_; }
  int colour() const { return colour_; }

 private:
  // What this makes belongs to the standard allocator, and outlives the counter.
  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, std::size_t* step,
                         cv::AccessFlag access, cv::UMatUsageFlags usage) const override {
    if (dims == 2 && std::equal(size_.begin(), size_.end(), sizes)) {
      gray_ += type == CV_8UC1;
      colour_ += type == CV_8UC3;
    }
    return standard_->allocate(dims, sizes, type, data, step, access, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag access,
                cv::UMatUsageFlags usage) const override {
    return standard_->allocate(data, access, usage);
  }
  void deallocate(cv::UMatData* data) const override { standard_->deallocate(data); }

  const std::array<int, 2> size_;
  cv::MatAllocator* const standard_ = cv::Mat::getStdAllocator();
  mutable std::atomic<int> gray_{0};
  mutable std::atomic<int> colour_{0};
};

/// The nodelet /inside in this process, where messages are handed over by pointer, as between
/// nodelets.
class Inside {
 public:
  explicit Inside(const std::string& image_topic) : loader_(false) {
    const nodelet::M_string remappings = {{ros::names::resolve("/image"), image_topic}};
    EXPECT_TRUE(loader_.load("/inside", "camera_self_calibration/SelfCalibrationNodelet",
                             remappings, nodelet::V_string()));
  }
  ~Inside() { EXPECT_TRUE(loader_.unload("/inside")); }

 private:
  nodelet::Loader loader_;
};

TEST_F(Manners, ImagesAreNeitherCopiedNorHeldUp) {
  const Inside nodelet("/inside_camera/image_raw");
  ros::Publisher publisher =
      ros::NodeHandle().advertise<sensor_msgs::Image>("/inside_camera/image_raw", 5);
  Recorder<sensor_msgs::Image> images("/inside/image_raw");
  Recorder<sensor_msgs::CameraInfo> infos("/inside/camera_info");
  Recorder<TrackingStatus> status("/inside/tracking_status");
  int held_up = 0;  // images that came after what the nodelet has made of them
  const ros::Subscriber order = ros::NodeHandle().subscribe<sensor_msgs::Image>(
      "/inside/image_raw", 10, [&](const sensor_msgs::ImageConstPtr& image) {
        if (status.messages.empty()) return;
        if (status.messages.back()->header.stamp >= image->header.stamp) ++held_up;
      });
  ASSERT_TRUE(spinUntil(
      [&] {
        return publisher.getNumSubscribers() > 0 && images.connected() && infos.connected() &&
               status.connected();
      },
      20.0));
  Clip clip(320);
  std::vector<sensor_msgs::ImageConstPtr> sent;
  for (int i = 0; i < 60; ++i) {
    sent.push_back(clip.next());
    publisher.publish(sent.back());
    ASSERT_TRUE(spinUntil([&] { return images.messages.size() == sent.size(); }, 10.0));
  }
  ASSERT_TRUE(spinUntil(
      [&] {
        return infos.messages.size() == sent.size() && !status.messages.empty() &&
               status.messages.back()->header.stamp == sent.back()->header.stamp;
      },
      10.0));
  EXPECT_EQ(held_up, 0);
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(images.messages[i].get(), sent[i].get()) << "image " << i << " was copied";
    EXPECT_EQ(infos.messages[i]->header.stamp, sent[i]->header.stamp);
  }
}

sensor_msgs::CompressedImage compressed(const sensor_msgs::Image& image) {
  const cv::Mat pixels(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC1,
                       const_cast<std::uint8_t*>(image.data.data()));
  cv::Mat colour;
  cv::cvtColor(pixels, colour, cv::COLOR_GRAY2BGR);
  sensor_msgs::CompressedImage message;
  message.header = image.header;
  message.format = "jpeg";
  cv::imencode(".jpg", colour, message.data);
  return message;
}

// Decoding in colour for ~image_raw is the dearest work that only listeners need.
TEST_F(Manners, ImagesAreDecodedInColourForListenersAlone) {
  const ImageCounter made(320, 240);
  const Inside nodelet("/packed_camera/image_raw");
  ros::Publisher publisher = ros::NodeHandle().advertise<sensor_msgs::CompressedImage>(
      "/packed_camera/image_raw/compressed", 5);
  Recorder<TrackingStatus> status("/inside/tracking_status");
  ASSERT_TRUE(
      spinUntil([&] { return publisher.getNumSubscribers() > 0 && status.connected(); }, 20.0));
  Clip clip(320);
  constexpr int kImages = 10;
  std::vector<sensor_msgs::CompressedImage> images;
  for (int i = 0; i < 2 * kImages; ++i) images.push_back(compressed(*clip.next()));
  const auto publish = [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const std::size_t before = status.messages.size();
      publisher.publish(images[static_cast<std::size_t>(i)]);
      EXPECT_TRUE(spinUntil([&] { return status.messages.size() > before; }, 10.0));
    }
  };
  const int gray = made.gray();
  const int colour = made.colour();
  publish(0, kImages);
  EXPECT_GE(made.gray(), gray + kImages) << "what is decoded would not be seen";
  EXPECT_EQ(made.colour(), colour);
  Recorder<sensor_msgs::Image> listener("/inside/image_raw");
  ASSERT_TRUE(spinUntil([&] { return listener.connected(); }, 20.0));
  publish(kImages, 2 * kImages);
  EXPECT_GE(made.colour(), colour + kImages);
  EXPECT_TRUE(spinUntil([&] { return listener.messages.size() == kImages; }, 10.0));
}

}  // namespace
}  // namespace camera_self_calibration

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "manners_test");
  ros::NodeHandle node;
  return RUN_ALL_TESTS();
}
