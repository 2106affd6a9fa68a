#pragma once

#include <opencv2/core/persistence.hpp>
#include <string>
#include <vector>

namespace camera_self_calibration {

/// A text of cv::FileStorage; all functions throw std::runtime_error that says what is wrong.
class OpenCvStorage {
 public:
  explicit OpenCvStorage(const std::string& text);

  bool has(const std::string& key) const;
  bool hasIn(const std::string& group, const std::string& key) const;
  double number(const std::string& key) const;
  int wholeNumber(const std::string& key) const;
  std::string word(const std::string& key) const;
  /// An entry of a map.
  double numberIn(const std::string& group, const std::string& key) const;
  /// All values of a matrix, row by row.
  std::vector<double> matrix(const std::string& key) const;

 private:
  cv::FileNode at(const std::string& key) const;

  cv::FileStorage storage_;
};

}  // namespace camera_self_calibration
