// cv::FileStorage with the keys of OpenCV's calibration sample.

#include <opencv2/core.hpp>
#include <stdexcept>

#include "format_text.h"
#include "opencv_storage.h"

namespace camera_self_calibration {
namespace {

/// The name of a key in new files or, if that is not there, in older ones.
std::string keyOf(const OpenCvStorage& storage, const char* name, const char* older) {
  return !storage.has(name) && storage.has(older) ? older : name;
}

}  // namespace

StoredCalibration parseOpenCv(const std::string& text) {
  const OpenCvStorage storage(text);
  const auto k = storage.matrix(keyOf(storage, "camera_matrix", "Camera_Matrix"));
  if (k.size() != 9) throw std::runtime_error("'camera_matrix' is not 3 x 3");
  if (k[1] != 0.0) throw std::runtime_error("'camera_matrix' has a skew, which no model here has");
  const std::vector<double> focal_and_centre = {k[0], k[4], k[2], k[5]};
  const std::string d_key = keyOf(storage, "distortion_coefficients", "Distortion_Coefficients");
  std::vector<double> d = storage.matrix(d_key);
  const int width = storage.wholeNumber(keyOf(storage, "image_width", "image_Width"));
  const int height = storage.wholeNumber(keyOf(storage, "image_height", "image_Height"));
  const bool fisheye = storage.has("fisheye_model") && storage.number("fisheye_model") != 0.0;
  if (!fisheye) return {{}, makeDistortedCamera(width, height, focal_and_centre, d)};
  if (d.size() != 4) throw std::runtime_error("the fisheye model has four coefficients");
  d.insert(d.begin(), focal_and_centre.begin(), focal_and_centre.end());
  return {{}, makeCamera(CameraModel::kEquidistant, width, height, d)};
}

std::string openCvText(const Camera& camera) {
  const Intrinsics& p = camera.parameters();
  const bool fisheye = camera.model() == CameraModel::kEquidistant;
  const cv::Mat k = (cv::Mat_<double>(3, 3) << p[0], 0.0, p[2], 0.0, p[1], p[3], 0.0, 0.0, 1.0);
  cv::Mat d = cv::Mat::zeros(fisheye ? 4 : 5, 1, CV_64F);
  for (int i = 4; i < camera.parameterCount(); ++i) d.at<double>(i - 4) = p[i];
  try {
    cv::FileStorage storage(".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
    storage << "image_width" << camera.width() << "image_height" << camera.height();
    storage << "fisheye_model" << static_cast<int>(fisheye);
    storage << "camera_matrix" << k << "distortion_coefficients" << d;
    return storage.releaseAndGetString();
  } catch (const cv::Exception& e) {
    throw std::runtime_error("OpenCV cannot write the calibration: " + e.err);
  }
}

}  // namespace camera_self_calibration
