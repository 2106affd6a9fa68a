#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <string>

namespace camera_self_calibration {

/// Numbers as bytes, the least significant first, whatever the machine.
class ByteWriter {
 public:
  void integer(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) {
      bytes_.push_back(static_cast<char>((value >> shift) & 0xff));
    }
  }
  void real(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    integer(bits);
  }
  template <typename Derived>
  void matrix(const Eigen::DenseBase<Derived>& values) {
    integer(static_cast<std::uint64_t>(values.rows()));
    integer(static_cast<std::uint64_t>(values.cols()));
    for (Eigen::Index c = 0; c < values.cols(); ++c) {
      for (Eigen::Index r = 0; r < values.rows(); ++r) real(values(r, c));
    }
  }
  void text(const std::string& value) {
    integer(value.size());
    bytes_ += value;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads what a ByteWriter wrote. After the end, and for sizes that do not fit, everything is zero
/// and ok() is false.
class ByteReader {
 public:
  ByteReader(const char* begin, std::size_t size) : next_(begin), left_(size) {}

  bool ok() const { return ok_; }
  bool atEnd() const { return ok_ && left_ == 0; }

  std::uint64_t integer() {
    if (left_ < 8) ok_ = false;
    if (!ok_) return 0;
    std::uint64_t value = 0;
    for (int i = 0; i < 8; ++i) {
      value |= static_cast<std::uint64_t>(static_cast<unsigned char>(next_[i])) << (8 * i);
    }
    next_ += 8;
    left_ -= 8;
    return value;
  }
  /// A number that is not larger than `most`.
  std::size_t upTo(std::size_t most) {
    const std::uint64_t value = integer();
    if (value > most) ok_ = false;
    return ok_ ? static_cast<std::size_t>(value) : 0;
  }
  /// A count of things of at least so many bytes each: never more than can still follow.
  std::size_t count(std::size_t bytes_each) {
    const std::uint64_t value = integer();
    if (value > left_ / bytes_each) ok_ = false;
    return ok_ ? static_cast<std::size_t>(value) : 0;
  }
  double real() {
    const std::uint64_t bits = integer();
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }
  std::string text() {
    const std::size_t size = count(1);
    if (!ok_) return "";
    const std::string value(next_, size);
    next_ += size;
    left_ -= size;
    return value;
  }
  /// At most max_rows x max_columns.
  Eigen::MatrixXd matrix(std::uint64_t max_rows, std::uint64_t max_columns) {
    const std::uint64_t rows = integer();
    const std::uint64_t columns = integer();
    if (rows > max_rows || columns > max_columns) ok_ = false;
    if (!ok_) return Eigen::MatrixXd();
    Eigen::MatrixXd values(rows, columns);
    for (Eigen::Index c = 0; c < values.cols(); ++c) {
      for (Eigen::Index r = 0; r < values.rows(); ++r) values(r, c) = real();
    }
    return values;
  }

 private:
  const char* next_;
  std::size_t left_;
  bool ok_ = true;
};

}  // namespace camera_self_calibration
