#include "camera_self_calibration/plotting/track_overlay.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <sstream>
#include <string>

namespace camera_self_calibration {
namespace {

// After so many images a track counts as old.
constexpr double kOldImages = 40.0;
const Colour kNew(40, 150, 255);
const Colour kOld(90, 220, 110);
// OpenCV's fixed-point coordinates: 1/16 px.
constexpr int kShift = 4;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.48;

int strokeOf(double size) { return std::max(1, static_cast<int>(size)); }

cv::Point fixed(const Eigen::Vector2d& pixel) {
  return {static_cast<int>(std::lround(pixel.x() * 16.0)),
          static_cast<int>(std::lround(pixel.y() * 16.0))};
}

void drawTrail(const TrackTrails::Trail& trail, double size, cv::Mat* picture) {
  const double age = std::min(1.0, trail.images / kOldImages);
  const Colour colour = kNew * (1.0 - age) + kOld * age;
  std::vector<cv::Point> points;
  for (const Eigen::Vector2d& pixel : trail.pixels) points.push_back(fixed(pixel));
  cv::polylines(*picture, points, false, colour, strokeOf(size), cv::LINE_AA, kShift);
  const int radius = static_cast<int>(std::lround(2.2 * size * 16.0));
  cv::circle(*picture, points.back(), radius + 16, Colour(20, 20, 20), cv::FILLED, cv::LINE_AA,
             kShift);
  cv::circle(*picture, points.back(), radius, colour, cv::FILLED, cv::LINE_AA, kShift);
}

/// A line of a caption; only its first has a dot.
struct CaptionLine {
  std::optional<Colour> dot;
  std::string text;
};

/// Broken between words where it is wider than `width` [px].
std::vector<CaptionLine> linesOf(const Caption& caption, double size, int width) {
  std::vector<CaptionLine> lines = {{caption.colour, ""}};
  std::istringstream words(caption.text);
  for (std::string word; words >> word;) {
    const std::string& begun = lines.back().text;
    const std::string longer = begun.empty() ? word : begun + " " + word;
    const int stroke = strokeOf(size);
    if (begun.empty() ||
        cv::getTextSize(longer, kFont, kFontScale * size, stroke, nullptr).width <= width) {
      lines.back().text = longer;
    } else {
      lines.push_back({std::nullopt, word});
    }
  }
  return lines;
}

/// One below the other on a darkened strip at the lower border.
void drawCaptions(const std::vector<Caption>& captions, double size, cv::Mat* picture) {
  const int line = static_cast<int>(std::lround(20.0 * size));
  std::vector<CaptionLine> lines;
  for (const Caption& caption : captions) {
    const std::vector<CaptionLine> own = linesOf(caption, size, picture->cols - 3 * line / 2);
    lines.insert(lines.end(), own.begin(), own.end());
  }
  if (lines.empty()) return;
  const int height = std::min(picture->rows, line * static_cast<int>(lines.size()) + line / 3);
  cv::Mat strip = picture->rowRange(picture->rows - height, picture->rows);
  strip.convertTo(strip, -1, 0.35);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const int y = line * static_cast<int>(i) + line * 2 / 3;
    if (lines[i].dot) {
      cv::circle(strip, {line / 2, y}, line / 4, *lines[i].dot, cv::FILLED, cv::LINE_AA);
    }
    cv::putText(strip, lines[i].text, {line, y + line / 4}, kFont, kFontScale * size,
                Colour(240, 240, 240), strokeOf(size), cv::LINE_AA);
  }
}

}  // namespace

void TrackTrails::add(const TrackedFrame& frame) {
  std::map<std::int64_t, Trail> live;
  for (const Track& track : frame.tracks) {
    Trail& trail = live[track.id];
    const auto known = trails_.find(track.id);
    if (known != trails_.end()) trail = std::move(known->second);
    trail.pixels.push_back(track.pixel);
    if (trail.pixels.size() > max_pixels_) trail.pixels.pop_front();
    ++trail.images;
  }
  trails_.swap(live);
}

cv::Mat drawTracks(const cv::Mat& gray, const TrackTrails& trails,
                   const std::vector<Caption>& captions) {
  cv::Mat picture;
  cv::cvtColor(gray, picture, cv::COLOR_GRAY2BGR);
  const double size = std::max(1.0, gray.cols / 640.0);
  for (const auto& [id, trail] : trails.trails()) drawTrail(trail, size, &picture);
  drawCaptions(captions, size, &picture);
  return picture;
}

}  // namespace camera_self_calibration
