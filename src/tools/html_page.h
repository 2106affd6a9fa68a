#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <utility>
#include <vector>

namespace camera_self_calibration {

/// One web page that needs nothing beside itself: pictures are embedded, there are no scripts.
class HtmlPage {
 public:
  explicit HtmlPage(const std::string& title) : title_(title) {}

  /// Begins a section; `text` explains it (plain text).
  void section(const std::string& heading, const std::string& text = "");
  void paragraph(const std::string& text);

  /// The line at the top: a coloured word and a sentence.
  void verdict(const std::string& word, const std::string& css_colour, const std::string& sentence);

  /// Numbers side by side, each with what it is.
  void figures(const std::vector<std::pair<std::string, std::string>>& value_and_name);

  /// The first row is the header; cells are plain text, numbers are set to the right.
  void table(const std::vector<std::vector<std::string>>& rows);

  /// Pictures side by side, each with a caption; shown at half their size in pixels.
  void pictures(const std::vector<std::pair<cv::Mat, std::string>>& picture_and_caption);

  std::string text() const;

 private:
  std::string title_;
  std::string body_;
};

}  // namespace camera_self_calibration
