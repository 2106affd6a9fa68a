#include "camera_self_calibration/map/rolling_shutter.h"

#include "camera_self_calibration/tracking/image_motion.h"

namespace camera_self_calibration {

void placePixel(double row_time_s, int image_height, Eigen::Vector2d* pixel, RowShift* shift) {
  const Eigen::Vector2d seen = *pixel + shift->shift;
  *pixel = asSeenAtOnce(seen, shift->motion, 0.5 * (image_height - 1), row_time_s);
  shift->shift = seen - *pixel;
}

void setRowTime(double row_time_s, int image_height, Segment* segment) {
  for (Keyframe& keyframe : segment->keyframes) keyframe.row_time_s = row_time_s;
  for (Landmark& landmark : segment->landmarks) {
    placePixel(row_time_s, image_height, &landmark.reference_pixel, &landmark.reference_shift);
  }
  for (Observation& observation : segment->observations) {
    placePixel(row_time_s, image_height, &observation.pixel, &observation.shift);
  }
}

}  // namespace camera_self_calibration
