#pragma once

namespace camera_self_calibration {

/// Values that are computed side by side: as many as a processor with AVX2 takes at a time; the
/// compiler splits them for others. See SELFCAL_CPU_CLONES.
constexpr int kFloatBlock = 8;
using FloatBlock = float
    __attribute__((vector_size(kFloatBlock * sizeof(float)), aligned(sizeof(float)), may_alias));

/// The block that begins at `first`.
inline const FloatBlock& floatBlock(const float* first) {
  return *reinterpret_cast<const FloatBlock*>(first);
}
inline FloatBlock& floatBlock(float* first) { return *reinterpret_cast<FloatBlock*>(first); }

/// The count that fills the last block.
constexpr int wholeBlocks(int count) {
  return (count + kFloatBlock - 1) / kFloatBlock * kFloatBlock;
}

}  // namespace camera_self_calibration
