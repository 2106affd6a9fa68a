#include "bag_source.h"

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "camera_self_calibration/ros/gray_image.h"
#include "camera_self_calibration/ros/stamps.h"
#include "image_child.h"

namespace camera_self_calibration {
namespace {

void openReadable(const std::string& path, rosbag::Bag* bag) {
  try {
    bag->open(path, rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    throw std::runtime_error(path + " has no index, since its recording was cut off. Repair it " +
                             "with: rosbag reindex " + path);
  } catch (const std::exception& e) {
    throw std::runtime_error(path + " cannot be read as a bag: " + e.what() +
                             ". It is cut off, damaged or no bag; a bag that was cut off is " +
                             "repaired with: rosbag reindex " + path);
  }
}

bool isImageType(const std::string& type) {
  return type == "sensor_msgs/Image" || type == "sensor_msgs/CompressedImage";
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::vector<std::string> imageTopics(const rosbag::Bag& bag) {
  rosbag::View view(bag);
  std::vector<std::string> topics;
  for (const rosbag::ConnectionInfo* connection : view.getConnections()) {
    if (isImageType(connection->datatype)) topics.push_back(connection->topic);
  }
  std::sort(topics.begin(), topics.end());
  topics.erase(std::unique(topics.begin(), topics.end()), topics.end());
  return topics;
}

/// The topic asked for, as it is or with /compressed behind it, or the only one. Empty: none there.
std::string chosenTopic(const std::vector<std::string>& topics, const std::string& wanted) {
  if (wanted.empty()) {
    if (topics.size() > 1) {
      throw std::runtime_error("the bag holds several image topics: " + joined(topics) +
                               ". Choose one with --topic");
    }
    return topics.empty() ? std::string() : topics.front();
  }
  for (const std::string& name : {wanted, wanted + "/compressed"}) {
    if (std::find(topics.begin(), topics.end(), name) != topics.end()) return name;
  }
  throw std::runtime_error("the bag has no image topic " + wanted +
                           "; it holds: " + (topics.empty() ? "none" : joined(topics)));
}

/// The bag stays open as long as its view is read.
struct BagReader {
  rosbag::Bag bag;
  std::unique_ptr<rosbag::View> view;
  rosbag::View::iterator position;
  GrayConverter converter;

  GrayImage gray(const rosbag::MessageInstance& message) {
    if (message.getDataType() == "sensor_msgs/Image") {
      const auto image = message.instantiate<sensor_msgs::Image>();
      if (!image) return {std::nullopt, "a message is not of the type sensor_msgs/Image"};
      return converter.convert(sensor_msgs::ImageConstPtr(image));
    }
    const auto image = message.instantiate<sensor_msgs::CompressedImage>();
    if (!image) return {std::nullopt, "a message is not of the type sensor_msgs/CompressedImage"};
    return converter.convert(*image);
  }

  std::optional<GrayImage> next() {
    if (!view || position == view->end()) return std::nullopt;
    const rosbag::MessageInstance& message = *position;
    GrayImage image = gray(message);
    // Drivers that set no stamp: the time of the recording.
    if (image.view && image.view->stamp_ns == 0) {
      image.view->stamp_ns = toNanoseconds(message.getTime());
    }
    ++position;
    return image;
  }
};

/// When the last of those topics begins that have messages.
ros::Time beginOf(const std::vector<std::string>& topics, const rosbag::Bag& bag) {
  ros::Time begin = ros::TIME_MIN;
  for (const std::string& topic : topics) {
    rosbag::View view(bag, rosbag::TopicQuery(topic));
    if (view.size() > 0) begin = std::max(begin, view.getBeginTime());
  }
  return begin;
}

/// Limits the view of the first topic to [start, start + duration) after all of them have begun.
void selectTimes(const std::vector<std::string>& topics, const SourceOptions& options,
                 BagReader* reader) {
  const rosbag::TopicQuery query(topics.front());
  reader->view = std::make_unique<rosbag::View>(reader->bag, query);
  if (reader->view->size() > 0 && (options.start_seconds > 0.0 || options.duration_seconds > 0.0)) {
    const ros::Time begin = beginOf(topics, reader->bag) + ros::Duration(options.start_seconds);
    ros::Time end = ros::TIME_MAX;
    if (options.duration_seconds > 0.0) {
      end = begin + ros::Duration(options.duration_seconds) - ros::Duration(0, 1);
    }
    reader->view = std::make_unique<rosbag::View>(reader->bag, query, begin, end);
  }
  reader->position = reader->view->begin();
}

/// A chunk that is damaged in the middle of a bag shows only when it is read.
std::optional<GrayImage> readNext(BagReader* reader, const std::string& path) {
  try {
    return reader->next();
  } catch (const std::exception& e) {
    throw std::runtime_error(path + " is damaged: " + e.what());
  }
}

}  // namespace

ImageSource openBagHere(const SourceOptions& options) {
  const auto reader = std::make_shared<BagReader>();
  openReadable(options.path, &reader->bag);
  const std::vector<std::string> there = imageTopics(reader->bag);
  const std::string topic = chosenTopic(there, options.topic);
  ImageSource source;
  source.name = topic;
  if (!topic.empty()) {
    std::vector<std::string> topics = {topic};
    for (const std::string& other : options.together) topics.push_back(chosenTopic(there, other));
    selectTimes(topics, options, reader.get());
    source.count = reader->view->size();
  }
  source.next = [reader, path = options.path] { return readNext(reader.get(), path); };
  return source;
}

// librosbag trusts the lengths that stand in a bag, and crashes where one of them is damaged.
ImageSource openBag(const SourceOptions& options) {
  return openInChild([&options] { return openBagHere(options); },
                     options.path + " is damaged: what reads it has crashed. Repair it with: " +
                         "rosbag reindex " + options.path);
}

}  // namespace camera_self_calibration
