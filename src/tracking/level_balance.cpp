#include "camera_self_calibration/tracking/level_balance.h"

#include <cmath>

namespace camera_self_calibration {
namespace {

// Twice the information brings four times the features: most go where they give most, some go on
// trying the other level, and levels of about the same worth share.
constexpr double kPreference = 2.0;
constexpr double kMemory = 300.0;  // [images] Some seconds: the light and the motion change.

}  // namespace

void LevelBalance::forget() {
  for (Account& account : accounts_) {
    account.information *= 1.0 - 1.0 / kMemory;
    account.ends *= 1.0 - 1.0 / kMemory;
  }
}

void LevelBalance::measured(int level, double sigma) {
  accounts_[static_cast<std::size_t>(level)].information += 1.0 / (sigma * sigma);
}

void LevelBalance::ended(int level) { accounts_[static_cast<std::size_t>(level)].ends += 1.0; }

int LevelBalance::next(const Counts& features) const {
  // Measurements over ends is the mean life also while most tracks live on.
  Account all;
  for (const Account& account : accounts_) {
    all.information += account.information;
    all.ends += account.ends;
  }
  const double usual = all.information / (all.ends + 1.0);
  // The one whose next feature would exceed its share least.
  const auto crowding = [&](std::size_t level) {
    const Account& account = accounts_[level];
    // One more track, a usual one: what is not known, or not any more, is tried.
    const double told = (account.information + usual) / (account.ends + 1.0);
    const double share = usual > 0.0 ? std::pow(told / usual, kPreference) : 1.0;
    return static_cast<double>(features[level] + 1) / share;
  };
  std::size_t best = 0;
  for (std::size_t level = 1; level < accounts_.size(); ++level) {
    if (crowding(level) < crowding(best)) best = level;
  }
  return static_cast<int>(best);
}

}  // namespace camera_self_calibration
