#pragma once

#include <string>

namespace camera_self_calibration {

/// The names of the frames that poses are about: the world's and the camera's.
struct FrameNames {
  std::string world;        ///< Of ~world_frame.
  std::string child;        ///< Of ~child_frame; empty: that of the images.
  std::string image_frame;  ///< frame_id of the images as it came.

  /// The camera's optical frame, as tf2 takes it: without a leading slash; "camera" where the
  /// images name none.
  std::string camera() const;

  /// Why no transform can be published between the two, in words; empty if it can.
  std::string problem() const;
};

/// A name as tf2 takes it, without the leading slash of tf's old names.
std::string withoutSlash(const std::string& frame);

}  // namespace camera_self_calibration
