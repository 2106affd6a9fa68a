#include "camera_self_calibration/tracking/level_balance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

namespace camera_self_calibration {
namespace {

// Of one level: tracks that live for some images, each time measured with that sigma.
struct Kind {
  double sigma = 0.1;  // [px]
  int life = 10;       // [images]
};

constexpr std::size_t kFeatures = 128;

// How many features each level has once `images` images have been seen, when every feature that
// ends is replaced at the level that is due.
LevelBalance::Counts follow(LevelBalance* balance, const Kind& fine, const Kind& coarse,
                            int images) {
  const std::array<Kind, 2> kinds = {fine, coarse};
  std::array<std::vector<int>, 2> ages;
  LevelBalance::Counts counts{};
  for (int image = 0; image < images; ++image) {
    balance->forget();
    for (std::size_t level = 0; level < 2; ++level) {
      for (int& age : ages[level]) {
        ++age;
        balance->measured(static_cast<int>(level), kinds[level].sigma);
      }
      const auto ended = std::remove_if(ages[level].begin(), ages[level].end(),
                                        [&](int age) { return age >= kinds[level].life; });
      for (auto i = ended; i != ages[level].end(); ++i) balance->ended(static_cast<int>(level));
      ages[level].erase(ended, ages[level].end());
      counts[level] = ages[level].size();
    }
    while (counts[0] + counts[1] < kFeatures) {
      const int level = balance->next(counts);
      ages[static_cast<std::size_t>(level)].push_back(0);
      ++counts[static_cast<std::size_t>(level)];
    }
  }
  return counts;
}

TEST(LevelBalance, LevelsOfTheSameWorthShare) {
  LevelBalance balance;
  const LevelBalance::Counts counts = follow(&balance, {0.1, 10}, {0.1, 10}, 300);
  EXPECT_NEAR(static_cast<double>(counts[0]), kFeatures / 2.0, kFeatures / 8.0);
}

TEST(LevelBalance, MostGoWhereATrackGivesMore) {
  LevelBalance precise;
  EXPECT_GT(follow(&precise, {0.1, 10}, {0.2, 10}, 300)[0], kFeatures * 9 / 10);
  LevelBalance lasting;
  EXPECT_GT(follow(&lasting, {0.1, 4}, {0.1, 16}, 300)[1], kFeatures * 9 / 10);
  LevelBalance both;  // Half as precise, but four times as long: the same information.
  const LevelBalance::Counts counts = follow(&both, {0.1, 5}, {0.2, 20}, 600);
  EXPECT_GT(counts[0], kFeatures / 4);
  EXPECT_GT(counts[1], kFeatures / 4);
}

TEST(LevelBalance, ALevelIsNeverGivenUp) {
  LevelBalance balance;
  ASSERT_GT(follow(&balance, {0.05, 20}, {0.2, 5}, 600)[0], kFeatures * 9 / 10);
  EXPECT_GT(follow(&balance, {0.4, 5}, {0.1, 20}, 1500)[1], kFeatures * 9 / 10);
}

}  // namespace
}  // namespace camera_self_calibration
