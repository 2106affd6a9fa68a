#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "camera_self_calibration/ros/gray_image.h"

namespace camera_self_calibration {

/// Where images come from and which of them.
struct SourceOptions {
  std::string path;   ///< A bag, a folder of images or a video file.
  std::string topic;  ///< Of a bag; empty: the only image topic.
  /// Topics of a bag that are used together: the last of them to begin has the first image that
  /// times count from.
  std::vector<std::string> together;
  /// Of a folder or video [Hz]; 0: 30, or the times that stand in the video.
  double rate = 0.0;
  double start_seconds = 0.0;     ///< Images before this time after the first one are skipped.
  double duration_seconds = 0.0;  ///< 0: to the end.
};

/// A stored sequence of images, read one after the other.
struct ImageSource {
  std::function<std::optional<GrayImage>()> next;  ///< Nothing at the end.
  std::int64_t count = 0;                          ///< Images to come; for progress.
  std::string name;                                ///< Topic, folder or file.
  std::string description;                         ///< What is read and how, for people.
};

/// Opens a folder (a directory; its images in the natural order of their names, img2 before img10),
/// a bag (*.bag, or by its first bytes) or else a video. Throws std::runtime_error that says what
/// is wrong and what to do: missing or malformed file, no such topic, several topics.
ImageSource openImages(const SourceOptions& options);

/// The three kinds of openImages. Folders and videos begin at time 0; the images of a video have
/// the sensor's orientation, whatever it asks players to do.
ImageSource openBag(const SourceOptions& options);
ImageSource openFolder(const SourceOptions& options);
ImageSource openVideo(const SourceOptions& options);

}  // namespace camera_self_calibration
