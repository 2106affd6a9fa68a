#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace camera_self_calibration {

/// Tells several cameras that publish on one topic from one that was started anew, by the names of
/// their nodes. Nodelets of one manager all have its name, so that two cameras among them cannot be
/// told apart here.
class PublisherWatch {
 public:
  /// Images of others in a row after which a publisher counts as gone.
  static constexpr int kPatience = 30;

  /// For each image the name of the node that published it. Empty, or why the image is to be left
  /// out: other nodes publish on the topic too, and the images of one of them are used.
  std::string check(const std::string& name);

 private:
  struct Publisher {
    std::string name;
    std::int64_t last = 0;  // of its images
    bool beside = false;    // while another one's images are used
  };
  static constexpr std::size_t kMostPublishers = 8;

  Publisher* find(const std::string& name);
  bool isThere(const Publisher& publisher) const;
  Publisher* begin(const std::string& name);
  std::string problem() const;

  std::vector<Publisher> recent_;  // in the order in which they began
  std::string current_;            // whose images are used
  std::int64_t images_ = 0;
};

}  // namespace camera_self_calibration
