#pragma once

#include <cstddef>
#include <vector>

namespace camera_self_calibration {

/// A dense matrix that is made anew many times, and its product with its own transpose. Its memory
/// is kept.
class Panel {
 public:
  /// All zero.
  void reset(int rows, int columns) {
    columns_ = columns;
    pitch_ = (rows + kBlock - 1) / kBlock * kBlock;
    const auto pitch = static_cast<std::size_t>(pitch_);
    values_.assign(pitch * static_cast<std::size_t>(columns), 0.0);
    if (product_.size() < pitch * pitch) product_.resize(pitch * pitch);
  }

  double* column(int c) { return values_.data() + c * pitch_; }
  /// From one column to the next.
  int pitch() const { return pitch_; }

  /// Forms the product with the transpose; its lower triangle alone.
  void multiply();
  /// Column `c` of the product.
  const double* product(int c) const { return product_.data() + c * pitch_; }

 private:
  static constexpr int kBlock = 8;

  int columns_ = 0;
  int pitch_ = 0;  // rows, to a multiple of kBlock
  std::vector<double> values_;
  std::vector<double> product_;
};

}  // namespace camera_self_calibration
