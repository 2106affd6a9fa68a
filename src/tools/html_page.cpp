#include "html_page.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>

#include "camera_self_calibration/base/formatted.h"

namespace camera_self_calibration {
namespace {

// Charts are drawn 420 px wide: letters are readable from 340 px on.
constexpr const char* kStyle = R"(
* { box-sizing: border-box; }
body { font: 15px/1.5 "Helvetica Neue", Arial, "DejaVu Sans", sans-serif; color: var(--text);
  max-width: 1080px; margin: 0 auto; padding: 24px 20px 60px; background: var(--background); }
h1 { font-size: 25px; margin: 0 0 4px; line-height: 1.25; overflow-wrap: anywhere; }
a { color: inherit; }
h2 { font-size: 19px; margin: 34px 0 4px; padding-top: 14px; border-top: 1px solid var(--grid); }
p { margin: 4px 0 10px; max-width: 860px; overflow-wrap: break-word; }
#run, figcaption, .card span, th { color: var(--faint-text); }
.verdict { font-size: 17px; margin: 14px 0 18px; max-width: none; }
.pill { color: #fff; font-weight: bold; font-size: 14px; padding: 3px 11px; border-radius: 4px;
  margin-right: 8px; white-space: nowrap; }
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(150px, 1fr)); gap: 10px;
  margin: 12px 0; }
.card { background: var(--panel); border: 1px solid var(--grid); border-radius: 6px;
  padding: 8px 14px; }
.card b { display: block; font-size: 20px; }
.card span { font-size: 13px; display: block; line-height: 1.3; }
.wide { overflow-x: auto; margin: 10px 0; }
table { border-collapse: collapse; font-size: 14px; }
th, td { padding: 4px 14px 4px 0; border-bottom: 1px solid var(--grid); text-align: left;
  vertical-align: top; }
th { font-weight: normal; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.matrix td, .matrix th { padding: 4px 8px; text-align: right; border: 1px solid var(--background);
  font-variant-numeric: tabular-nums; }
details { margin: 8px 0; }
summary { cursor: pointer; }
pre { background: var(--panel); border: 1px solid var(--grid); border-radius: 6px;
  padding: 10px 14px; font-size: 13px; line-height: 1.35; overflow-x: auto; user-select: all; }
.row { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 340px), 1fr));
  gap: 14px 20px; margin: 10px 0; }
figure { margin: 0; max-width: 680px; }
.photo:only-child { max-width: none; }
figure img, figure svg { width: 100%; height: auto; display: block; }
figure svg svg { overflow: hidden; }
figure rect { shape-rendering: crispEdges; }
figcaption { font-size: 13px; margin-top: 4px; }
@media print {
  body { max-width: none; padding: 0; font-size: 12px; }
  h1 { font-size: 20px; } h2 { font-size: 15px; margin-top: 20px; }
  .verdict { font-size: 14px; } .card b { font-size: 15px; }
  .card span, table, figcaption { font-size: 11px; }
  h2, h2 + p { break-after: avoid; }
  figure, tr, .card, .matrix { break-inside: avoid; }
  .row { grid-template-columns: 1fr 1fr; }
  pre { white-space: pre-wrap; overflow-wrap: anywhere; font-size: 9px; }
  .wide { overflow: visible; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
)";

std::string base64(const std::vector<std::uint8_t>& bytes) {
  constexpr const char* kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() * 4 / 3 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
    }
    for (int k = 3; k >= 0; --k) {
      const bool filled = i + 2 < bytes.size() + static_cast<std::size_t>(k);
      text += filled ? kLetters[group >> (6 * k) & 63u] : '=';
    }
  }
  return text;
}

bool looksLikeNumber(const std::string& cell) {
  return cell.find_first_not_of("0123456789+-.e<% \u00b1") == std::string::npos;
}

}  // namespace

void HtmlPage::section(const std::string& heading, const std::string& text) {
  body_ += "<h2>" + htmlEscaped(heading) + "</h2>\n";
  if (!text.empty()) paragraph(text);
}

void HtmlPage::paragraph(const std::string& text) { body_ += "<p>" + htmlEscaped(text) + "</p>\n"; }

void HtmlPage::link(const std::string& text, const std::string& relative_path) {
  body_ += "<p><a href=\"" + htmlEscaped(relative_path) + "\">" + htmlEscaped(text) + "</a></p>\n";
}

void HtmlPage::varying(const std::string& text) {
  body_ += "<p id=\"run\">" + htmlEscaped(text) + "</p>\n";
}

void HtmlPage::verdict(const std::string& word, const std::string& css_colour,
                       const std::string& sentence) {
  body_ += "<p class=\"verdict\"><span class=\"pill\" style=\"background:" + css_colour + "\">" +
           htmlEscaped(word) + "</span>" + htmlEscaped(sentence) + "</p>\n";
}

void HtmlPage::figures(const std::vector<std::pair<std::string, std::string>>& value_and_name) {
  body_ += "<div class=\"cards\">";
  for (const auto& [value, name] : value_and_name) {
    body_ += "<div class=\"card\"><b>" + htmlEscaped(value) + "</b><span>" + htmlEscaped(name) +
             "</span></div>";
  }
  body_ += "</div>\n";
}

void HtmlPage::table(const std::vector<std::vector<std::string>>& rows) {
  body_ += "<div class=\"wide\"><table>\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const bool empty = std::all_of(rows[r].begin(), rows[r].end(),
                                   [](const std::string& cell) { return cell.empty(); });
    if (r == 0 && empty) continue;
    body_ += "<tr>";
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      const std::string tag = r == 0 ? "th" : "td";
      // A column is set as its first cell below the header.
      const bool number = rows.size() > 1 && c < rows[1].size() && looksLikeNumber(rows[1][c]);
      body_ +=
          "<" + tag + (number ? " class=\"n\">" : ">") + htmlEscaped(rows[r][c]) + "</" + tag + ">";
    }
    body_ += "</tr>\n";
  }
  body_ += "</table></div>\n";
}

void HtmlPage::correlations(const std::vector<std::string>& names, const Eigen::MatrixXd& matrix) {
  body_ += "<div class=\"wide\"><table class=\"matrix\">\n<tr><th></th>";
  for (const std::string& name : names) body_ += "<th>" + htmlEscaped(name) + "</th>";
  body_ += "</tr>\n";
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    body_ += "<tr><th>" + htmlEscaped(names[static_cast<std::size_t>(row)]) + "</th>";
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
      const double value = matrix(row, column);
      const double share = row == column ? 0.0 : 0.6 * std::abs(value);
      body_ += formatted("<td style=\"background:rgba(226,110,20,%.2f)\">%.2f</td>", share, value);
    }
    body_ += "</tr>\n";
  }
  body_ += "</table></div>\n";
}

void HtmlPage::text(const std::string& heading, const std::string& text, bool open) {
  body_ += std::string("<details") + (open ? " open" : "") + "><summary>" + htmlEscaped(heading) +
           "</summary><pre>" + htmlEscaped(text) + "</pre></details>\n";
}

void HtmlPage::charts(const std::vector<std::pair<Sheet, std::string>>& chart_and_description) {
  body_ += "<div class=\"row\">\n";
  for (const auto& [chart, description] : chart_and_description) {
    body_ += "<figure>" + chart.svg(description) + "</figure>\n";
  }
  body_ += "</div>\n";
}

void HtmlPage::photographs(
    const std::vector<std::pair<cv::Mat, std::string>>& picture_and_caption) {
  body_ += "<div class=\"row\">\n";
  for (const auto& [picture, caption] : picture_and_caption) {
    if (picture.empty()) continue;
    std::vector<std::uint8_t> jpeg;
    cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, 88});
    body_ += "<figure class=\"photo\"><img alt=\"" + htmlEscaped(caption) +
             "\" src=\"data:image/jpeg;base64," + base64(jpeg) + "\"><figcaption>" +
             htmlEscaped(caption) + "</figcaption></figure>\n";
  }
  body_ += "</div>\n";
}

std::string HtmlPage::text() const {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
         htmlEscaped(title_) + "</title>\n<style>\n:root { " + paletteCss(Theme::kLight) +
         " }\n@media screen and (prefers-color-scheme: dark) { :root { " +
         paletteCss(Theme::kDark) + " } }" + kStyle + "</style></head>\n<body>\n<h1>" +
         htmlEscaped(title_) + "</h1>\n" + body_ + "</body></html>\n";
}

}  // namespace camera_self_calibration
