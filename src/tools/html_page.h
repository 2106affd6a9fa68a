#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <utility>
#include <vector>

#include "camera_self_calibration/plotting/sheet.h"

namespace camera_self_calibration {

/// One web page that needs nothing beside itself: charts are SVG, photographs are embedded, and
/// there are no scripts. It reads well on phones, in dark mode and on paper.
class HtmlPage {
 public:
  explicit HtmlPage(const std::string& title) : title_(title) {}

  /// Begins a section; `text` explains it (plain text).
  void section(const std::string& heading, const std::string& text = "");
  void paragraph(const std::string& text);
  /// A paragraph on a line of its own, which programs that compare pages can leave out: it begins
  /// with <p id="run">.
  void varying(const std::string& text);

  /// A line that leads to a page beside this one.
  void link(const std::string& text, const std::string& relative_path);

  /// The line at the top: a coloured word and a sentence.
  void verdict(const std::string& word, const std::string& css_colour, const std::string& sentence);

  /// Numbers side by side, each with what it is.
  void figures(const std::vector<std::pair<std::string, std::string>>& value_and_name);

  /// The first row is the header; cells are plain text, numbers are set to the right.
  void table(const std::vector<std::vector<std::string>>& rows);

  /// A symmetric matrix of correlations, -1 to 1, coloured by size.
  void correlations(const std::vector<std::string>& names, const Eigen::MatrixXd& matrix);

  /// Text to copy, below a line that opens and closes it.
  void text(const std::string& heading, const std::string& text, bool open);

  /// Charts side by side, each with a description for those who cannot see it.
  void charts(const std::vector<std::pair<Sheet, std::string>>& chart_and_description);

  /// Photographs (BGR or gray) side by side, each with a caption; those that are empty are left
  /// out.
  void photographs(const std::vector<std::pair<cv::Mat, std::string>>& picture_and_caption);

  std::string text() const;

 private:
  std::string title_;
  std::string body_;
};

}  // namespace camera_self_calibration
