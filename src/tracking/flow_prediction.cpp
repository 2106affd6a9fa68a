#include "camera_self_calibration/tracking/flow_prediction.h"

#include <algorithm>
#include <cmath>
#include <opencv2/video/tracking.hpp>

namespace camera_self_calibration {
namespace {

constexpr double kMaxReturn = 1.0;       // [px] Between a point and where the way back leads.
constexpr double kMinEigenvalue = 1e-4;  // OpenCV's default: drops windows without texture.
const cv::TermCriteria kForward(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 10, 0.05);
const cv::TermCriteria kBackward(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 5, 0.1);

// Ratio of brightness beyond which the flow, which knows no gain, would fail.
constexpr double kSameExposure = 0.04;

// An image and the border that the flow needs around it, with all values multiplied.
cv::Mat brightened(const cv::Mat& image, double gain) {
  cv::Size whole_size;
  cv::Point offset;
  image.locateROI(whole_size, offset);
  cv::Mat whole = image;
  whole.adjustROI(offset.y, whole_size.height - offset.y - image.rows, offset.x,
                  whole_size.width - offset.x - image.cols);
  cv::Mat result;
  whole.convertTo(result, -1, gain);
  return result(cv::Rect(offset, image.size()));
}

}  // namespace

// The first image and its derivatives, as bright as the second.
const std::vector<cv::Mat>& FlowPrediction::balanced(const ImagePyramid& from,
                                                     const ImagePyramid& to) {
  const int coarsest = std::min(from.levels(), to.levels()) - 1;
  const double before = cv::mean(from.level(coarsest))[0];
  const double gain = cv::mean(to.level(coarsest))[0] / std::max(before, 1.0);
  if (!(gain > 0.2 && gain < 5.0) || std::abs(gain - 1.0) < kSameExposure) return from.mats();
  balanced_.clear();
  for (const cv::Mat& image : from.mats()) balanced_.push_back(brightened(image, gain));
  return balanced_;
}

void FlowPrediction::run(const ImagePyramid& from, const ImagePyramid& to,
                         const std::vector<cv::Point2f>& points,
                         std::vector<cv::Point2f>* predicted) {
  found_.assign(points.size(), 0);
  if (points.empty()) return;
  const std::vector<cv::Mat>& from_mats = balanced(from, to);
  const cv::Size window(kFlowWindow, kFlowWindow);
  cv::calcOpticalFlowPyrLK(from_mats, to.mats(), points, *predicted, found_, unused_error_, window,
                           from.levels() - 1, kForward, cv::OPTFLOW_USE_INITIAL_FLOW,
                           kMinEigenvalue);
  back_ = points;
  cv::calcOpticalFlowPyrLK(to.mats(), from_mats, *predicted, back_, found_back_, unused_error_,
                           window, 0, kBackward, cv::OPTFLOW_USE_INITIAL_FLOW, kMinEigenvalue);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point2f miss = back_[i] - points[i];
    // Written so that what is not a number fails.
    const bool returns = found_back_[i] && miss.dot(miss) <= kMaxReturn * kMaxReturn;
    found_[i] = found_[i] && returns;
  }
}

}  // namespace camera_self_calibration
