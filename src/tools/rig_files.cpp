#include "camera_self_calibration/tools/rig_files.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <stdexcept>

#include "camera_self_calibration/base/angle.h"
#include "camera_self_calibration/base/formatted.h"
#include "camera_self_calibration/camera/field_of_view.h"
#include "camera_self_calibration/ros/camera_info.h"
#include "camera_self_calibration/tools/calibration_format.h"
#include "format_text.h"
#include "info_matrix.h"

namespace camera_self_calibration {
namespace {

/// Of the row of the principal point [rad]; of all directions where its ends have no rays.
double widthOfView(const Camera& camera) {
  const double horizontal = fieldOfView(camera).horizontal;
  return std::isfinite(horizontal) ? horizontal * kDegree : 2.0 * M_PI;
}

std::string commentLine(const std::string& text) { return text.empty() ? "" : "# " + text + "\n"; }

std::string motionText(const Rigid3& motion) {
  Eigen::Matrix<double, 3, 4> rows;
  rows << motion.rotation.toRotationMatrix(), motion.translation;
  std::string text = "  T_cn_cnm1:\n";
  for (int r = 0; r < 3; ++r) {
    text += "  - [";
    for (int c = 0; c < 4; ++c) text += (c > 0 ? ", " : "") + realText(rows(r, c));
    text += "]\n";
  }
  return text + "  - [0.0, 0.0, 0.0, 1.0]\n";
}

template <typename Array>
void copyTo(const cv::Mat& matrix, Array* values) {
  std::copy(matrix.begin<double>(), matrix.end<double>(), values->begin());
}

/// The pair in one distortion model, which is that of the rectification.
std::optional<OutputModel> commonModel(const Rig& rig) {
  std::vector<std::string> names;
  for (const Camera& camera : rig.cameras) {
    const auto conversion = toCameraInfo(camera);
    if (!conversion) return std::nullopt;
    names.push_back(conversion->info.distortion_model);
  }
  const bool both = std::all_of(names.begin(), names.end(),
                                [](const std::string& name) { return name == "plumb_bob"; });
  return both ? OutputModel::kPlumbBob : OutputModel::kEquidistant;
}

/// Nothing where the distortion model does not reach the whole image.
std::optional<CameraInfoConversion> wholeInfo(const Camera& camera, OutputModel model) {
  const auto conversion = toCameraInfo(camera, model);
  return conversion && std::isfinite(conversion->error.max) ? conversion : std::nullopt;
}

std::string whyNoPair(const Rig& rig) {
  if (rig.size() != 2) return "left.yaml and right.yaml are for rigs of two cameras";
  const Camera& a = rig.cameras[0];
  const Camera& b = rig.cameras[1];
  if (a.width() != b.width() || a.height() != b.height()) {
    return "the images differ in size, so that there is no rectified pair";
  }
  const Rigid3& pose = rig.rig_from_camera[1];
  const double between = std::acos(std::clamp((pose.rotation.toRotationMatrix())(2, 2), -1.0, 1.0));
  if (between > 0.5 * std::min(widthOfView(a), widthOfView(b))) {
    return "the cameras share less than half of their views, so that there is no rectified pair";
  }
  const Eigen::Vector3d t = pose.translation.cwiseAbs();
  if (t.x() <= std::max(t.y(), t.z())) {
    return "the cameras do not stand side by side, as stereo_image_proc wants it: there is no "
           "rectified pair";
  }
  return {};
}

void rectify(const Rigid3& right_from_left, OutputModel model, StereoPair* pair) {
  const cv::Size size(static_cast<int>(pair->left_info.width),
                      static_cast<int>(pair->left_info.height));
  cv::Mat r, t, r1, r2, p1, p2, q;
  cv::eigen2cv(Eigen::Matrix3d(right_from_left.rotation.toRotationMatrix()), r);
  cv::eigen2cv(Eigen::Vector3d(right_from_left.translation), t);
  const cv::Mat k1 = matrixOf(pair->left_info.K, 3);
  const cv::Mat k2 = matrixOf(pair->right_info.K, 3);
  const cv::Mat d1 = matrixOf(pair->left_info.D, static_cast<int>(pair->left_info.D.size()));
  const cv::Mat d2 = matrixOf(pair->right_info.D, static_cast<int>(pair->right_info.D.size()));
  if (model == OutputModel::kPlumbBob) {
    cv::stereoRectify(k1, d1, k2, d2, size, r, t, r1, r2, p1, p2, q, cv::CALIB_ZERO_DISPARITY, 0.0);
  } else {
    cv::fisheye::stereoRectify(k1, d1, k2, d2, size, r, t, r1, r2, p1, p2, q,
                               cv::CALIB_ZERO_DISPARITY);
  }
  copyTo(r1, &pair->left_info.R);
  copyTo(p1, &pair->left_info.P);
  copyTo(r2, &pair->right_info.R);
  copyTo(p2, &pair->right_info.P);
}

}  // namespace

std::string rigCamchain(const Rig& rig, const std::vector<std::string>& topics,
                        const std::string& comment) {
  std::string text = commentLine(comment);
  for (int c = 0; c < rig.size(); ++c) {
    CalibrationLabels labels;
    labels.topic = topics[c];
    const CameraFit fit = storable(rig.cameras[c], CalibrationFormat::kKalibr);
    text += commentLine(fitNote(rig.cameras[c], fit.error));
    text += kalibrText(fit.camera, labels, formatted("cam%d", c));
    if (c == 0) continue;
    text += motionText(rig.rig_from_camera[c].inverse() * rig.rig_from_camera[c - 1]);
  }
  return text;
}

std::vector<std::string> camchainNotes(const Rig& rig, const std::string& file) {
  std::vector<std::string> notes;
  for (int c = 0; c < rig.size(); ++c) {
    const CameraFit fit = storable(rig.cameras[c], CalibrationFormat::kKalibr);
    const std::string note = approximationNote(formatted("cam%d in %s", c, file.c_str()),
                                               rig.cameras[c], CalibrationFormat::kKalibr, fit);
    if (!note.empty()) notes.push_back(note);
  }
  return notes;
}

std::string scaleNote(const RigEstimate& estimate) {
  return estimate.metric ? "Lengths in metres."
                         : "Lengths in distances between cam0 and cam1: the scale is not known.";
}

std::optional<StereoPair> stereoPair(const Rig& rig, std::string* problem) {
  *problem = whyNoPair(rig);
  if (!problem->empty()) return std::nullopt;
  StereoPair pair;
  if (rig.rig_from_camera[1].translation.x() < 0.0) std::swap(pair.left, pair.right);
  const auto model = commonModel(rig);
  const auto left = model ? wholeInfo(rig.cameras[pair.left], *model) : std::nullopt;
  const auto right = model ? wholeInfo(rig.cameras[pair.right], *model) : std::nullopt;
  if (!left || !right) {
    *problem = "the lenses have no distortion model of ROS in common";
    return std::nullopt;
  }
  pair.left_info = left->info;
  pair.right_info = right->info;
  pair.left_error = left->error;
  pair.right_error = right->error;
  rectify(rig.rig_from_camera[pair.right].inverse() * rig.rig_from_camera[pair.left], *model,
          &pair);
  return pair;
}

std::string stereoNote(const std::string& holder, const sensor_msgs::CameraInfo& info,
                       const PixelError& error) {
  if (error.max < kNoticeablePx) return {};
  return holder + " holds an approximation, since both of a pair have one distortion model: " +
         info.distortion_model + ", " + offBy(error) + ".";
}

}  // namespace camera_self_calibration
