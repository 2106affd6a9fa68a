#include "opencv_storage.h"

#include <algorithm>
#include <cctype>
#include <climits>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string_view>

namespace camera_self_calibration {
namespace {

[[noreturn]] void missing(const std::string& key) {
  throw std::runtime_error("'" + key + "' is missing");
}

double numberOf(const cv::FileNode& node, const std::string& key) {
  if (node.empty()) missing(key);
  if (!node.isReal() && !node.isInt()) throw std::runtime_error("'" + key + "' is no number");
  return node.real();
}

/// Of the sides of a matrix, for which OpenCV reserves memory before it looks for its numbers.
bool isShort(const cv::FileNode& side) {
  constexpr int kLongest = 100;
  return side.isInt() && static_cast<int>(side) >= 0 && static_cast<int>(side) <= kLongest;
}

constexpr const char* kDigits = "0123456789";

/// OpenCV takes the lowest 32 bits of an integer that has more, and one that begins with 0 as
/// octal.
void refuseMisread(const std::string& word) {
  const std::size_t begin = word.front() == '-' || word.front() == '+' ? 1 : 0;
  const std::size_t end = std::min(word.find_first_not_of(kDigits, begin), word.size());
  const char behind = end < word.size() ? word[end] : ' ';
  if (begin == end || behind == '.' || behind == 'e') return;  // a word, or a number with decimals
  const long long value = std::strtoll(word.c_str(), nullptr, 0);
  if (value > INT_MAX || value < INT_MIN) {
    throw std::runtime_error("the number " + word + " is too large");
  }
  const bool hexadecimal = behind == 'x' || behind == 'X';
  if (hexadecimal || value == std::strtoll(word.c_str(), nullptr, 10)) return;
  throw std::runtime_error("the number " + word +
                           " begins with 0, which OpenCV takes as octal; leave the zeros out");
}

bool isOfWord(char c) {
  constexpr std::string_view kOthers = "+-._!";
  return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
         kOthers.find(c) != std::string_view::npos;
}

/// Where the quoted text ends that begins at `at`; the next character if none does on this line.
std::size_t behindQuoted(const std::string& text, std::size_t at) {
  for (std::size_t i = at + 1; i < text.size() && text[i] != '\n'; ++i) {
    if (text[i] == text[at]) return i + 1;
    if (text[i] == '\\') ++i;
  }
  return at + 1;
}

/// Throws at the first integer, outside of texts and comments, that OpenCV would take as another.
void refuseMisreadIntegers(const std::string& text) {
  const bool xml = text.compare(0, 1, "<") == 0;
  bool value = true;  // whether the next word is one, rather than the rest of an unquoted text
  for (std::size_t at = 0, next = 0; at < text.size(); at = next) {
    next = at + 1;
    if (isOfWord(text[at])) {
      while (next < text.size() && isOfWord(text[next])) ++next;
      const std::string word = text.substr(at, next - at);
      if (value || xml) refuseMisread(word);
      value = word == "-" || word.front() == '!';  // an item of a list, a type
    } else if (text[at] == '"' || text[at] == '\'') {
      next = behindQuoted(text, at);
    } else if (!xml && text[at] == '#') {
      next = std::min(text.find('\n', at), text.size());
    } else if (xml && text.compare(at, 4, "<!--") == 0) {
      next = std::min(text.find("-->", at), text.size());
    } else if (text[at] != ' ' && text[at] != '\t') {
      value = true;
    }
  }
}

}  // namespace

OpenCvStorage::OpenCvStorage(const std::string& text) {
  refuseMisreadIntegers(text);
  bool opened = false;
  try {
    opened = storage_.open(text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
  } catch (const cv::Exception& e) {
    throw std::runtime_error("OpenCV cannot read it: " + e.err);
  } catch (const std::exception&) {  // of strings and memory, at lengths that OpenCV misreads
    throw std::runtime_error("OpenCV cannot read it");
  }
  if (!opened) throw std::runtime_error("it is no file of OpenCV's FileStorage");
}

// Throws, in words of its own, where there is a document in the file that has no keys.
cv::FileNode OpenCvStorage::at(const std::string& key) const {
  try {
    return storage_[key];
  } catch (const cv::Exception&) {
    throw std::runtime_error("it is no file with keys and values");
  }
}

bool OpenCvStorage::has(const std::string& key) const { return !at(key).empty(); }

bool OpenCvStorage::hasIn(const std::string& group, const std::string& key) const {
  const cv::FileNode node = at(group);
  return node.isMap() && !node[key].empty();
}

double OpenCvStorage::number(const std::string& key) const { return numberOf(at(key), key); }

int OpenCvStorage::wholeNumber(const std::string& key) const {
  const cv::FileNode node = at(key);
  if (node.empty()) missing(key);
  if (!node.isInt()) throw std::runtime_error("'" + key + "' is no whole number");
  return static_cast<int>(node);
}

std::string OpenCvStorage::word(const std::string& key) const {
  const cv::FileNode node = at(key);
  if (node.empty()) missing(key);
  if (!node.isString()) throw std::runtime_error("'" + key + "' is no text");
  return node.string();
}

double OpenCvStorage::numberIn(const std::string& group, const std::string& key) const {
  const cv::FileNode node = at(group);
  if (!node.isMap()) missing(group);
  return numberOf(node[key], group + ": " + key);
}

std::vector<double> OpenCvStorage::matrix(const std::string& key) const {
  const cv::FileNode node = at(key);
  if (node.empty()) missing(key);
  try {
    if (node.isMap() && !(isShort(node["rows"]) && isShort(node["cols"]))) {
      throw std::runtime_error("'" + key + "' has too many rows or columns");
    }
    cv::Mat matrix;
    node.mat().convertTo(matrix, CV_64F);
    return std::vector<double>(matrix.begin<double>(), matrix.end<double>());
  } catch (const cv::Exception&) {
    throw std::runtime_error("'" + key + "' is no matrix of numbers");
  }
}

}  // namespace camera_self_calibration
