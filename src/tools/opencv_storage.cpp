#include "opencv_storage.h"

#include <climits>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <regex>
#include <stdexcept>

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

/// OpenCV takes the lowest 32 bits of an integer that has more.
void refuseLongIntegers(const std::string& text) {
  static const std::regex kLong(R"((^|[\s:,\[>])([-+]?0*[1-9]\d{9,})(?=[\s,\]<]|$))");
  for (std::sregex_iterator it(text.begin(), text.end(), kLong), end; it != end; ++it) {
    const std::string digits = (*it)[2];
    const long long value = std::strtoll(digits.c_str(), nullptr, 10);
    if (value > INT_MAX || value < INT_MIN) {
      throw std::runtime_error("the number " + digits + " is too large");
    }
  }
}

}  // namespace

OpenCvStorage::OpenCvStorage(const std::string& text) {
  refuseLongIntegers(text);
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
