#include "camera_self_calibration/tracking/flow_prediction.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "camera_self_calibration/camera/image_size.h"

namespace camera_self_calibration {
namespace {

constexpr float kMaxReturn = 1.0f;  // [px] Between a point and where the way back leads.
constexpr LucasKanade::Effort kBackward = {0, 5, 0.1f};
constexpr std::size_t kScoutEvery = 5;
constexpr int kCorrectedLevel = 1;  // coarsest level that a corrected guess needs
// [longer sides of the image] Over which scouts speak for others.
constexpr double kNeighbourhood = 0.15;
// Ratio of brightness beyond which the flow, which knows no gain, would fail.
constexpr double kSameExposure = 0.04;

// Brightness of the second image against that of the first.
float gainBetween(const ImagePyramid& from, const ImagePyramid& to) {
  const int coarsest = std::min(from.levels(), to.levels()) - 1;
  const double before = cv::mean(from.level(coarsest))[0];
  const double gain = cv::mean(to.level(coarsest))[0] / std::max(before, 1.0);
  const bool differs = gain > 0.2 && gain < 5.0 && std::abs(gain - 1.0) >= kSameExposure;
  return differs ? static_cast<float>(gain) : 1.0f;
}

}  // namespace

// The chosen points, and back on the finest level.
void FlowPrediction::follow(const ImagePyramid& from, const ImagePyramid& to, int coarsest,
                            const std::vector<cv::Point2f>& points,
                            std::vector<cv::Point2f>* predicted) {
  LucasKanade::Effort forward;
  forward.coarsest_level = coarsest;
  inStripes(static_cast<int>(chosen_.size()), [&](int stripe, int begin, int end) {
    LucasKanade& worker = lucas_kanade_[static_cast<std::size_t>(stripe)];
    for (int k = begin; k < end; ++k) {
      const std::size_t i = chosen_[static_cast<std::size_t>(k)];
      cv::Point2f back = points[i];
      const bool returns = worker.follow(from, gain_, points[i], to, forward, &(*predicted)[i]) &&
                           worker.follow(to, 1.0f / gain_, (*predicted)[i], from, kBackward, &back);
      const cv::Point2f miss = back - points[i];
      found_[i] = returns && miss.dot(miss) <= kMaxReturn * kMaxReturn;
    }
  });
}

// By how far the scouts, which are the only points found yet, were from theirs.
void FlowPrediction::correctGuesses(double reach, std::vector<cv::Point2f>* predicted) {
  correction_.fit(
      guesses_, *predicted, [this](std::size_t i) { return found(i); }, reach);
  for (std::size_t i = 0; i < guesses_.size(); ++i) {
    if (found(i)) continue;
    const Eigen::Vector2d guess(guesses_[i].x, guesses_[i].y);
    const Eigen::Vector2f corrected = correction_.at(guess).pixel.cast<float>();
    (*predicted)[i] = {corrected.x(), corrected.y()};
  }
}

void FlowPrediction::run(const ImagePyramid& from, const ImagePyramid& to,
                         const std::vector<cv::Point2f>& points,
                         std::vector<cv::Point2f>* predicted) {
  found_.assign(points.size(), 0);
  if (points.empty()) return;
  gain_ = gainBetween(from, to);
  const int coarsest = from.levels() - 1;
  guesses_ = *predicted;
  choose([&](std::size_t i) { return i % kScoutEvery == 0; });
  follow(from, to, coarsest, points, predicted);
  correctGuesses(kNeighbourhood * longerSide(to.size().width, to.size().height), predicted);
  choose([&](std::size_t i) { return i % kScoutEvery != 0; });
  follow(from, to, std::min(coarsest, kCorrectedLevel), points, predicted);
  choose([&](std::size_t i) { return i % kScoutEvery != 0 && !found(i); });
  for (const std::size_t i : chosen_) (*predicted)[i] = guesses_[i];
  follow(from, to, coarsest, points, predicted);
}

}  // namespace camera_self_calibration
