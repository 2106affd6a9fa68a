// cv::FileStorage with the keys of OpenCV's calibration sample.

#include <algorithm>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <utility>

#include "format_text.h"
#include "opencv_storage.h"

namespace camera_self_calibration {
namespace {

/// The first of these keys that is there, else the first.
std::string keyOf(const OpenCvStorage& storage, const std::vector<std::string>& names) {
  const auto found = std::find_if(names.begin(), names.end(),
                                  [&](const std::string& name) { return storage.has(name); });
  return found == names.end() ? names.front() : *found;
}

/// The keys of OpenCV's sample, older ones, those that people choose, and those of its stereo
/// sample.
struct Keys {
  std::string k;
  std::string d;
};
Keys keysOf(const OpenCvStorage& storage, const std::string& wanted) {
  const bool stereo = storage.has("M1") || storage.has("K1");
  if (!stereo && !wanted.empty()) {
    throw std::runtime_error("its only camera has no name; leave out --camera");
  }
  if (stereo) {
    const bool second = storage.has("M2") || storage.has("K2");
    const std::string number = chosenName(
        second ? std::vector<std::string>{"1", "2"} : std::vector<std::string>{"1"}, wanted);
    return {keyOf(storage, {"M" + number, "K" + number}), "D" + number};
  }
  return {keyOf(storage, {"camera_matrix", "Camera_Matrix", "cameraMatrix", "K", "M"}),
          keyOf(storage, {"distortion_coefficients", "Distortion_Coefficients", "distCoeffs",
                          "dist_coeffs", "distCoeff", "D"})};
}

/// Width and height; files of M1, D1 and the like often have none.
std::pair<int, int> sizeOf(const OpenCvStorage& storage) {
  for (const auto& [width, height] :
       {std::pair{"image_width", "image_height"}, std::pair{"image_Width", "image_Height"},
        std::pair{"width", "height"}}) {
    if (storage.has(width)) return {storage.wholeNumber(width), storage.wholeNumber(height)};
  }
  throw std::runtime_error(
      "'image_width' and 'image_height' are missing: add the size of the images to the file, in "
      "lines such as 'image_width: 640' and 'image_height: 480'");
}

}  // namespace

StoredCalibration parseOpenCv(const std::string& text, const std::string& wanted) {
  const OpenCvStorage storage(text);
  const Keys keys = keysOf(storage, wanted);
  const auto k = storage.matrix(keys.k);
  if (k.size() != 9) throw std::runtime_error("'" + keys.k + "' is not 3 x 3");
  if (k[1] != 0.0) throw std::runtime_error("'" + keys.k + "' has a skew, which no model here has");
  const std::vector<double> focal_and_centre = {k[0], k[4], k[2], k[5]};
  std::vector<double> d = storage.matrix(keys.d);
  const auto [width, height] = sizeOf(storage);
  const bool fisheye = storage.has("fisheye_model") && storage.number("fisheye_model") != 0.0;
  if (!fisheye) return {wanted, makeDistortedCamera(width, height, focal_and_centre, d)};
  if (d.size() != 4) throw std::runtime_error("the fisheye model has four coefficients");
  d.insert(d.begin(), focal_and_centre.begin(), focal_and_centre.end());
  return {wanted, makeCamera(CameraModel::kEquidistant, width, height, d)};
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
