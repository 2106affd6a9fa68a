#include "camera_self_calibration/rig/across_images.h"

#include <array>
#include <cmath>

namespace camera_self_calibration {
namespace {

// Starts along the epipolar line: the registration finds what is within about 2 px.
constexpr std::array<double, 7> kStarts{0.0, 3.0, -3.0, 6.0, -6.0, 9.0, -9.0};  // [px]

bool inside(const ImagePyramid& image, const Eigen::Vector2i& pixel) {
  constexpr int kMargin = ReferencePatch::kRawRadius;
  return pixel.x() >= kMargin && pixel.y() >= kMargin && pixel.x() < image.size().width - kMargin &&
         pixel.y() < image.size().height - kMargin;
}

}  // namespace

const ImagePyramid& AcrossImages::pyramidOf(const RigFrame& frame, int camera) {
  if (stamp_ns_ != frame.stamp_ns) pyramids_.clear();
  stamp_ns_ = frame.stamp_ns;
  const auto [entry, is_new] = pyramids_.try_emplace(camera);
  if (is_new && ImagePyramid::usable(frame.views[camera].image)) {
    entry->second.build(frame.views[camera].image);
  }
  return entry->second;
}

bool AcrossImages::find(const ImagePyramid& from, const ImagePyramid& to,
                        const ExpectedAcross& expected, SeenAcross* seen) {
  const Eigen::Vector2i centre = expected.pixel.array().round().cast<int>();
  if (!inside(from, centre)) return false;
  const Eigen::Vector2d offset = expected.pixel - centre.cast<double>();
  ReferencePatch patch;
  patch.cut(from.level(0), centre.x(), centre.y());
  if (!registration_.prepare(&patch)) return false;
  for (const double start : kStarts) {
    Warp warp = expected.there;
    warp.pixel += start * expected.along - warp.linear * offset;
    const Registration result = registration_.run(&patch, to, warp);
    if (!gate_.accepts(result) || !gate_.looksTheSame(result)) continue;
    accepted_.push_back(result);
    seen->pixel = result.warp.pixel + result.warp.linear * offset;
    seen->sigma = std::hypot(gate_.sigma(result), expected.sigma);
    return true;
  }
  return false;
}

std::vector<SeenAcross> AcrossImages::operator()(const RigFrame& frame, int from, int to,
                                                 const std::vector<ExpectedAcross>& expected) {
  std::vector<SeenAcross> result;
  pyramidOf(frame, to);
  const ImagePyramid& from_image = pyramidOf(frame, from);
  const ImagePyramid& to_image = pyramidOf(frame, to);
  if (from_image.empty() || to_image.empty()) return result;
  accepted_.clear();
  for (const ExpectedAcross& feature : expected) {
    SeenAcross seen;
    seen.from = from;
    seen.to = to;
    seen.track_id = feature.track_id;
    if (find(from_image, to_image, feature, &seen)) result.push_back(seen);
  }
  gate_.learn(accepted_);
  registration_.setNoise(0, gate_.whiteNoise());
  return result;
}

}  // namespace camera_self_calibration
