#pragma once

#include <string>

namespace camera_self_calibration {

/// Tells two cameras that publish on one topic from one that was started anew.
class PublisherWatch {
 public:
  /// Images in a row of the other publisher after which the first one counts as gone.
  static constexpr int kPatience = 30;

  /// For each image the name of the node that published it. Empty, or why the image is to be left
  /// out: another node publishes on the topic too, and its images are the ones that are used.
  std::string check(const std::string& publisher);

 private:
  std::string current_;   // Whose images are used.
  std::string previous_;  // Whose were used before.
  std::string rival_;     // Who publishes beside it; empty: nobody.
  int of_rival_ = 0;      // Its images in a row.
};

}  // namespace camera_self_calibration
