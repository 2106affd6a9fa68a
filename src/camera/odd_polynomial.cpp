#include "odd_polynomial.h"

#include <algorithm>
#include <cmath>

namespace camera_self_calibration {
namespace {

constexpr int kDegree = 4;  // of the slope, as a polynomial in t = x^2

using Coefficients = std::array<double, kDegree + 1>;  // ascending powers of t

double evaluate(const Coefficients& a, double t) {
  double sum = 0.0;
  for (int i = kDegree; i >= 0; --i) sum = sum * t + a[i];
  return sum;
}

Coefficients derivative(const Coefficients& a) {
  Coefficients d{};
  for (int i = 1; i <= kDegree; ++i) d[i - 1] = i * a[i];
  return d;
}

// The last point before the sign change between lo and hi.
double bisect(const Coefficients& a, double lo, double hi) {
  const bool positive = evaluate(a, lo) > 0.0;
  for (;;) {
    const double middle = 0.5 * (lo + hi);
    if (middle <= lo || middle >= hi) return lo;
    ((evaluate(a, middle) > 0.0) == positive ? lo : hi) = middle;
  }
}

struct Roots {
  std::array<double, kDegree> t;
  int count = 0;
};

// Sign changes of `a` in (0, end), ascending. Between two neighbouring extrema there is at most
// one, and the extrema are the roots of the derivative, found in the same way.
Roots rootsBelow(const Coefficients& a, double end, int degree) {
  Roots roots;
  if (degree == 0) return roots;
  const Roots extrema = rootsBelow(derivative(a), end, degree - 1);
  double lo = 0.0;
  for (int i = 0; i <= extrema.count; ++i) {
    const double hi = i < extrema.count ? extrema.t[i] : end;
    if ((evaluate(a, lo) > 0.0) != (evaluate(a, hi) > 0.0)) {
      roots.t[roots.count++] = bisect(a, lo, hi);
    }
    lo = hi;
  }
  return roots;
}

}  // namespace

double OddPolynomial::value(double x) const {
  const double t = x * x;
  return x * (1.0 + t * (c[0] + t * (c[1] + t * (c[2] + t * c[3]))));
}

double OddPolynomial::slope(double x) const {
  const double t = x * x;
  return 1.0 + t * (3.0 * c[0] + t * (5.0 * c[1] + t * (7.0 * c[2] + t * 9.0 * c[3])));
}

double OddPolynomial::monotonicLimit(double end) const {
  if (std::all_of(c.begin(), c.end(), [](double v) { return v >= 0.0; })) return end;
  const Coefficients slope_in_t{1.0, 3.0 * c[0], 5.0 * c[1], 7.0 * c[2], 9.0 * c[3]};
  const Roots roots = rootsBelow(slope_in_t, end * end, kDegree);
  return roots.count > 0 ? std::sqrt(roots.t[0]) : end;
}

std::optional<double> OddPolynomial::inverse(double y, double limit) const {
  if (!(y >= 0.0) || !(y <= value(limit))) return std::nullopt;
  double lo = 0.0;
  double hi = limit;
  double x = std::min(y, limit);
  for (int i = 0; i < 100; ++i) {
    const double error = value(x) - y;
    (error > 0.0 ? hi : lo) = x;
    double next = x - error / slope(x);
    if (!(next >= lo && next <= hi)) next = 0.5 * (lo + hi);
    const bool done = std::abs(next - x) <= 1e-16 * limit;
    x = next;
    if (done) break;
  }
  return x;
}

}  // namespace camera_self_calibration
