#pragma once

#include <opencv2/core/mat.hpp>

namespace camera_self_calibration {

/// K, D, R or P of a CameraInfo, row by row, as OpenCV takes it.
template <typename Values>
cv::Mat matrixOf(const Values& values, int rows) {
  const int columns = rows > 0 ? static_cast<int>(values.size()) / rows : 0;
  return cv::Mat(rows, columns, CV_64F, const_cast<double*>(values.data())).clone();
}

}  // namespace camera_self_calibration
