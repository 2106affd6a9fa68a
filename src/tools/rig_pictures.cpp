#include "rig_pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "camera_self_calibration/plotting/image_map.h"
#include "info_matrix.h"
#include "report_pictures.h"

namespace camera_self_calibration {
namespace {

constexpr int kFewestViews = 50;  // of a pair, to be shown
constexpr int kFewestInCell = 4;
// Colours end at so many times the largest value of the last map.
constexpr double kColours = 3.0;
constexpr int kLines = 16;  // along the rows of a rectified pair

bool isOf(const SharedView& view, const CameraPair& pair) {
  return view.from == pair.from && view.to == pair.to;
}

Eigen::MatrixXd cellsOf(const Rig& rig, const std::vector<SharedView>& shared,
                        const CameraPair& pair) {
  const Camera& camera = rig.cameras[pair.to];
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(kMapRows, kMapColumns);
  Eigen::MatrixXd counts = squares;
  for (const SharedView& view : shared) {
    const auto offset = isOf(view, pair) ? epipolarOffset(rig, view) : std::nullopt;
    if (!offset) continue;
    const int row = partOf(view.to_pixel.y(), camera.height(), kMapRows);
    const int column = partOf(view.to_pixel.x(), camera.width(), kMapColumns);
    squares(row, column) += *offset * *offset;
    counts(row, column) += 1.0;
  }
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return (counts.array() >= kFewestInCell)
      .select((squares.array() / counts.array().max(1.0)).sqrt(),
              Eigen::MatrixXd::Constant(kMapRows, kMapColumns, kNone));
}

double largest(const Eigen::MatrixXd& cells) {
  double most = 0.0;
  for (const double value : cells.reshaped()) most = value > most ? value : most;
  return most;
}

/// What image_proc does with a CameraInfo.
class Rectification {
 public:
  explicit Rectification(const sensor_msgs::CameraInfo& info)
      : fisheye_(info.distortion_model == "equidistant"),
        k_(matrixOf(info.K, 3)),
        d_(matrixOf(info.D, static_cast<int>(info.D.size()))),
        r_(matrixOf(info.R, 3)),
        p_(matrixOf(info.P, 3)) {}

  cv::Mat image(const ImageView& view) const {
    const cv::Mat gray(view.height, view.width, CV_8UC1, const_cast<std::uint8_t*>(view.data),
                       static_cast<std::size_t>(view.stride));
    cv::Mat x, y, result;
    if (fisheye_) {
      cv::fisheye::initUndistortRectifyMap(k_, d_, r_, p_, gray.size(), CV_32FC1, x, y);
    } else {
      cv::initUndistortRectifyMap(k_, d_, r_, p_, gray.size(), CV_32FC1, x, y);
    }
    cv::remap(gray, result, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    return result;
  }

  std::vector<cv::Point2d> pixels(const std::vector<cv::Point2d>& raw) const {
    std::vector<cv::Point2d> result;
    if (raw.empty()) return result;
    if (fisheye_) {
      cv::fisheye::undistortPoints(raw, result, k_, d_, r_, p_);
    } else {
      cv::undistortPoints(raw, result, k_, d_, r_, p_);
    }
    return result;
  }

 private:
  bool fisheye_;
  cv::Mat k_, d_, r_, p_;
};

/// Views of the pair in the rectified images, left and right.
struct RectifiedViews {
  std::vector<cv::Point2d> left;
  std::vector<cv::Point2d> right;

  RectifiedViews(const StereoPair& pair, const std::vector<SharedView>& shared) {
    for (const SharedView& view : shared) {
      const cv::Point2d from(view.from_pixel.x(), view.from_pixel.y());
      const cv::Point2d to(view.to_pixel.x(), view.to_pixel.y());
      const bool from_left = view.from == pair.left;
      left.push_back(from_left ? from : to);
      right.push_back(from_left ? to : from);
    }
    left = Rectification(pair.left_info).pixels(left);
    right = Rectification(pair.right_info).pixels(right);
  }
};

void drawLines(cv::Mat* canvas) {
  for (int line = 1; line < kLines; ++line) {
    const int row = line * canvas->rows / kLines;
    cv::line(*canvas, {0, row}, {canvas->cols - 1, row}, cv::Scalar(80, 190, 80), 1, cv::LINE_AA);
  }
}

}  // namespace

std::vector<CameraPair> pairsOf(const RigEvidence& evidence, int cameras) {
  std::vector<CameraPair> pairs;
  for (int from = 0; from < cameras; ++from) {
    for (int to = 0; to < cameras; ++to) {
      const CameraPair pair{from, to};
      const auto count = std::count_if(evidence.shared.begin(), evidence.shared.end(),
                                       [&](const SharedView& view) { return isOf(view, pair); });
      if (count >= kFewestViews) pairs.push_back(pair);
    }
  }
  return pairs;
}

EpipolarError epipolarError(const Rig& rig, const std::vector<SharedView>& shared,
                            const CameraPair& pair) {
  EpipolarError error;
  double squares = 0.0;
  for (const SharedView& view : shared) {
    const auto offset = isOf(view, pair) ? epipolarOffset(rig, view) : std::nullopt;
    if (!offset) continue;
    squares += *offset * *offset;
    ++error.views;
  }
  error.rms = std::sqrt(squares / std::max(1, error.views));
  return error;
}

std::vector<Sheet> drawEpipolarMaps(const std::vector<std::pair<std::string, Rig>>& rigs,
                                    const std::vector<SharedView>& shared, const CameraPair& pair) {
  std::vector<ImageMap> maps;
  for (const auto& [title, rig] : rigs) {
    ImageMap map;
    map.title = title;
    map.unit = "px";
    map.image_width = rig.cameras[pair.to].width();
    map.image_height = rig.cameras[pair.to].height();
    map.values = cellsOf(rig, shared, pair);
    maps.push_back(std::move(map));
  }
  double most = 0.0;
  for (const ImageMap& map : maps) most = std::max(most, largest(map.values));
  const double highest = std::min(most, kColours * largest(maps.back().values));
  std::vector<Sheet> sheets;
  for (ImageMap& map : maps) {
    map.highest = highest;
    sheets.push_back(drawImageMap(map, kChartWidth));
  }
  return sheets;
}

cv::Mat drawRectifiedPair(const StereoPair& pair, const RigEvidence& evidence) {
  if (evidence.example.empty()) return {};
  cv::Mat gray, canvas;
  cv::hconcat(Rectification(pair.left_info).image(evidence.example[pair.left]),
              Rectification(pair.right_info).image(evidence.example[pair.right]), gray);
  cv::cvtColor(gray, canvas, cv::COLOR_GRAY2BGR);
  drawLines(&canvas);
  std::vector<SharedView> shown;
  std::copy_if(evidence.shared.begin(), evidence.shared.end(), std::back_inserter(shown),
               [&](const SharedView& view) { return view.stamp_ns == evidence.example_ns; });
  const RectifiedViews views(pair, shown);
  const double width = 0.5 * canvas.cols;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    for (const cv::Point2d& at : {views.left[i], views.right[i] + cv::Point2d(width, 0.0)}) {
      cv::circle(canvas, at, 4, cv::Scalar(20, 110, 226), 1, cv::LINE_AA);
    }
  }
  return canvas;
}

EpipolarError rowError(const StereoPair& pair, const std::vector<SharedView>& shared) {
  const RectifiedViews views(pair, shared);
  EpipolarError error;
  double squares = 0.0;
  for (std::size_t i = 0; i < views.left.size(); ++i) {
    const double rows = views.left[i].y - views.right[i].y;
    if (!std::isfinite(rows)) continue;
    squares += rows * rows;
    ++error.views;
  }
  error.rms = std::sqrt(squares / std::max(1, error.views));
  return error;
}

}  // namespace camera_self_calibration
