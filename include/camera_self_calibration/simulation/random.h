#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <random>

namespace camera_self_calibration {

/// Combines two numbers to a seed, so that streams with neighbouring seeds are unrelated
/// (the finaliser of splitmix64).
inline std::uint64_t mixSeed(std::uint64_t a, std::uint64_t b) {
  std::uint64_t x = a * 0x9e3779b97f4a7c15ULL + b + 0x632be59bd9b4e019ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Seeded random numbers whose sequence does not depend on the standard library (the standard fixes
/// the generator but not the distributions).
class Random {
 public:
  explicit Random(std::uint64_t seed) : generator_(mixSeed(seed, 0)) {}

  /// In [0, 1).
  double uniform() { return static_cast<double>(generator_() >> 11) * 0x1.0p-53; }
  /// In [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In {low, ..., high}.
  int integer(int low, int high) {
    return low + static_cast<int>(uniform() * static_cast<double>(high - low + 1));
  }
  bool chance(double probability) { return uniform() < probability; }

  /// Of mean 0 and standard deviation 1 (Box and Muller).
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * M_PI * uniform());
  }
  Eigen::Vector2d normal2() {
    const double x = normal();
    return {x, normal()};
  }
  Eigen::Vector3d normal3() {
    const double x = normal();
    const double y = normal();
    return {x, y, normal()};
  }

 private:
  std::mt19937_64 generator_;
};

}  // namespace camera_self_calibration
