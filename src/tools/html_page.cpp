#include "html_page.h"

#include <cctype>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>

namespace camera_self_calibration {
namespace {

constexpr const char* kStyle = R"(
body { font: 15px/1.5 "Helvetica Neue", Arial, "DejaVu Sans", sans-serif; color: #20262e;
  max-width: 1060px; margin: 0 auto; padding: 28px 24px 60px; background: #fff; }
h1 { font-size: 25px; margin: 0 0 4px; }
h2 { font-size: 18px; margin: 38px 0 4px; padding-top: 14px; border-top: 1px solid #dee2e8; }
p { margin: 4px 0 10px; max-width: 880px; color: #4a525c; }
.verdict { font-size: 17px; color: #20262e; margin: 14px 0 18px; max-width: none; }
.pill { color: #fff; font-weight: bold; font-size: 14px; padding: 3px 11px; border-radius: 4px;
  margin-right: 8px; }
.cards { display: flex; flex-wrap: wrap; gap: 12px; margin: 12px 0; }
.card { background: #f5f7fa; border-radius: 6px; padding: 9px 16px; }
.card b { display: block; font-size: 20px; }
.card span { color: #6b7480; font-size: 13px; }
table { border-collapse: collapse; margin: 10px 0; font-size: 14px; }
th, td { padding: 4px 14px 4px 0; border-bottom: 1px solid #e6e9ee; text-align: left; }
th { color: #6b7480; font-weight: normal; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
.row { display: flex; flex-wrap: wrap; gap: 18px; }
figure { margin: 10px 0; max-width: 100%; }
figure img { max-width: 100%; display: block; }
figcaption { color: #6b7480; font-size: 13px; max-width: 620px; }
@media print { h2 { break-after: avoid; } figure { break-inside: avoid; } }
)";

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

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
  if (cell.empty() || cell == "-") return true;
  const char c = cell.front();
  return std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '+' || c == '.';
}

}  // namespace

void HtmlPage::section(const std::string& heading, const std::string& text) {
  body_ += "<h2>" + escaped(heading) + "</h2>\n";
  if (!text.empty()) paragraph(text);
}

void HtmlPage::paragraph(const std::string& text) { body_ += "<p>" + escaped(text) + "</p>\n"; }

void HtmlPage::verdict(const std::string& word, const std::string& css_colour,
                       const std::string& sentence) {
  body_ += "<p class=\"verdict\"><span class=\"pill\" style=\"background:" + css_colour + "\">" +
           escaped(word) + "</span>" + escaped(sentence) + "</p>\n";
}

void HtmlPage::figures(const std::vector<std::pair<std::string, std::string>>& value_and_name) {
  body_ += "<div class=\"cards\">";
  for (const auto& [value, name] : value_and_name) {
    body_ +=
        "<div class=\"card\"><b>" + escaped(value) + "</b><span>" + escaped(name) + "</span></div>";
  }
  body_ += "</div>\n";
}

void HtmlPage::table(const std::vector<std::vector<std::string>>& rows) {
  body_ += "<table>\n";
  for (std::size_t r = 0; r < rows.size(); ++r) {
    body_ += "<tr>";
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      const std::string tag = r == 0 ? "th" : "td";
      // A column is set as its first cell below the header.
      const bool number = rows.size() > 1 && c < rows[1].size() && looksLikeNumber(rows[1][c]);
      body_ +=
          "<" + tag + (number ? " class=\"n\">" : ">") + escaped(rows[r][c]) + "</" + tag + ">";
    }
    body_ += "</tr>\n";
  }
  body_ += "</table>\n";
}

void HtmlPage::pictures(const std::vector<std::pair<cv::Mat, std::string>>& picture_and_caption) {
  body_ += "<div class=\"row\">\n";
  for (const auto& [picture, caption] : picture_and_caption) {
    if (picture.empty()) continue;
    std::vector<std::uint8_t> png;
    cv::imencode(".png", picture, png);
    body_ += "<figure><img width=\"" + std::to_string(picture.cols / 2) + "\" alt=\"" +
             escaped(caption) + "\" src=\"data:image/png;base64," + base64(png) + "\">";
    if (!caption.empty()) body_ += "<figcaption>" + escaped(caption) + "</figcaption>";
    body_ += "</figure>\n";
  }
  body_ += "</div>\n";
}

std::string HtmlPage::text() const {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escaped(title_) + "</title>\n<style>" + kStyle + "</style></head>\n<body>\n<h1>" +
         escaped(title_) + "</h1>\n" + body_ + "</body></html>\n";
}

}  // namespace camera_self_calibration
