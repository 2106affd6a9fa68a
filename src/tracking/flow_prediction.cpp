#include "camera_self_calibration/tracking/flow_prediction.h"

#include <opencv2/video/tracking.hpp>

namespace camera_self_calibration {
namespace {

constexpr double kMaxReturn = 1.0;       // [px] Between a point and where the way back leads.
constexpr double kMinEigenvalue = 1e-4;  // OpenCV's default: drops windows without texture.
const cv::TermCriteria kForward(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 10, 0.05);
const cv::TermCriteria kBackward(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 5, 0.1);

}  // namespace

void FlowPrediction::run(const ImagePyramid& from, const ImagePyramid& to,
                         const std::vector<cv::Point2f>& points,
                         std::vector<cv::Point2f>* predicted) {
  found_.assign(points.size(), 0);
  if (points.empty()) return;
  const cv::Size window(kFlowWindow, kFlowWindow);
  cv::calcOpticalFlowPyrLK(from.mats(), to.mats(), points, *predicted, found_, unused_error_,
                           window, from.levels() - 1, kForward, cv::OPTFLOW_USE_INITIAL_FLOW,
                           kMinEigenvalue);
  back_ = points;
  cv::calcOpticalFlowPyrLK(to.mats(), from.mats(), *predicted, back_, found_back_, unused_error_,
                           window, 0, kBackward, cv::OPTFLOW_USE_INITIAL_FLOW, kMinEigenvalue);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point2f miss = back_[i] - points[i];
    // Written so that what is not a number fails.
    const bool returns = found_back_[i] && miss.dot(miss) <= kMaxReturn * kMaxReturn;
    found_[i] = found_[i] && returns;
  }
}

}  // namespace camera_self_calibration
