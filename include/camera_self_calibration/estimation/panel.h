#pragma once

#include <algorithm>
#include <vector>

namespace camera_self_calibration {

/// A tall matrix of few columns, made anew many times, and its product with its own transpose.
class Panel {
 public:
  static constexpr int kColumns = 24;

  /// All zero, with so many rows.
  void reset(int rows) {
    pitch_ = (rows + kBlock - 1) / kBlock * kBlock;
    const auto pitch = static_cast<std::size_t>(pitch_);
    values_.assign(pitch * kColumns, 0.0);
    if (product_.size() < pitch * pitch) product_.resize(pitch * pitch);
  }

  double* column(int c) { return values_.data() + c * pitch_; }
  int pitch() const { return pitch_; }

  /// The product of the first `columns` columns with their transpose; its lower triangle alone.
  void multiply(int columns);
  /// Column `c` of the product.
  const double* product(int c) const { return product_.data() + c * pitch_; }

 private:
  static constexpr int kBlock = 8;

  int pitch_ = 0;  // rows, to a multiple of kBlock
  std::vector<double> values_;
  std::vector<double> product_;
};

}  // namespace camera_self_calibration
