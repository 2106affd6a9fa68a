#include "camera_self_calibration/tools/synchronised_images.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;

// Images at these times [ms]; a negative one cannot be read.
ImageSource source(const std::vector<double>& times_ms) {
  ImageSource result;
  result.next = [times_ms, i = std::size_t{0}]() mutable -> std::optional<GrayImage> {
    if (i == times_ms.size()) return std::nullopt;
    const double time = times_ms[i++];
    if (time < 0.0) return GrayImage{std::nullopt, "damaged"};
    ImageView view;
    view.stamp_ns = static_cast<std::int64_t>(time * kMillisecond);
    return GrayImage{view, {}};
  };
  return result;
}

TEST(SynchronisedImages, PairsByStamp) {
  SynchronisedImages images({source({0, 50, 100, 150}), source({0.4, 100, -1, 150.2})});
  std::vector<double> times;
  while (const auto set = images.next()) {
    ASSERT_EQ(set->size(), 2u);
    times.push_back(static_cast<double>((*set)[0].stamp_ns) / kMillisecond);
  }
  EXPECT_EQ(times, (std::vector<double>{0, 100, 150}));
  EXPECT_EQ(images.sets(), 3);
  EXPECT_EQ(images.unmatched(), 1);
  EXPECT_EQ(images.problem(), "");
}

TEST(SynchronisedImages, SaysHowFarApartTheyAre) {
  SynchronisedImages images({source({0, 50, 100, 150}), source({7, 57, 107, 157})});
  EXPECT_FALSE(images.next());
  EXPECT_NE(images.problem().find("differ by 7.0 ms"), std::string::npos) << images.problem();
}

TEST(SynchronisedImages, EndsWithTheShortest) {
  SynchronisedImages images({source({0, 50, 100}), source({0}), source({0, 50})});
  EXPECT_TRUE(images.next());
  EXPECT_FALSE(images.next());
}

}  // namespace
}  // namespace camera_self_calibration
