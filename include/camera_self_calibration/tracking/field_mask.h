#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "camera_self_calibration/camera/image_field.h"
#include "camera_self_calibration/tracking/pyramid.h"

namespace camera_self_calibration {

/// Where a lens leaves the sensor dark: regions at the image border that have been dark in every
/// image so far. The edge of such a region stands still, whatever the camera does, and would be a
/// false feature. Kept at a quarter of the resolution.
class FieldMask {
 public:
  void add(const ImagePyramid& image);

  /// Finds the dark regions from the images added so far; contains() answers by them.
  void update();

  /// Whether the square of half width `radius` [px] around a pixel touches a dark region.
  bool touches(int x, int y, int radius) const;

  /// The same for an image of this size [px]; all of it sees as long as all of it is dark.
  ImageField field(int width, int height) const;

 private:
  int level_ = 0;  // of the pyramid that brightest_ and dark_ are of
  cv::Mat brightest_;
  cv::Mat dark_;
  std::vector<cv::Point> pending_;
};

}  // namespace camera_self_calibration
