#include "camera_self_calibration/estimation/panel.h"

#include <cstring>

#include "camera_self_calibration/base/cpu_clones.h"

namespace camera_self_calibration {
namespace {

// As many as a processor with AVX2 takes at a time; the compiler splits them for others.
using Four = double __attribute__((vector_size(32)));

// Blocks of 8 rows and 4 columns, whose sums stay in registers.
SELFCAL_CPU_CLONES void multiplyByTranspose(const double* panel, int pitch, int columns,
                                            double* product) {
  for (int c = 0; c < pitch; c += 4) {
    for (int r = c / 8 * 8; r < pitch; r += 8) {
      Four low0 = {}, low1 = {}, low2 = {}, low3 = {};
      Four high0 = {}, high1 = {}, high2 = {}, high3 = {};
      const double* column = panel;
      for (int k = 0; k < columns; ++k, column += pitch) {
        Four low, high;
        std::memcpy(&low, column + r, sizeof(low));
        std::memcpy(&high, column + r + 4, sizeof(high));
        const double* x = column + c;
        low0 += x[0] * low;
        high0 += x[0] * high;
        low1 += x[1] * low;
        high1 += x[1] * high;
        low2 += x[2] * low;
        high2 += x[2] * high;
        low3 += x[3] * low;
        high3 += x[3] * high;
      }
      const Four sums[8] = {low0, high0, low1, high1, low2, high2, low3, high3};
      double* out = product + c * pitch + r;
      for (int j = 0; j < 4; ++j, out += pitch) std::memcpy(out, sums + 2 * j, 2 * sizeof(Four));
    }
  }
}

}  // namespace

void Panel::multiply() { multiplyByTranspose(values_.data(), pitch_, columns_, product_.data()); }

}  // namespace camera_self_calibration
