#include "camera_self_calibration/tools/json.h"

#include <gtest/gtest.h>

#include <limits>

#include "camera_self_calibration/base/stamp.h"

namespace camera_self_calibration {
namespace {

TEST(Json, NumbersThatAreNotFiniteAreNull) {
  const double infinity = std::numeric_limits<double>::infinity();
  const Json value = {{"a", infinity}, {"b", std::numeric_limits<double>::quiet_NaN()}, {"c", 0.1}};
  EXPECT_EQ(toText(value), "{\n  \"a\": null,\n  \"b\": null,\n  \"c\": 0.1\n}\n");
}

// A bag may have any name.
TEST(Json, BytesThatAreNoTextDoNoHarm) {
  const std::string text = toText({{"file", "a\xff\"\n.bag"}});
  EXPECT_EQ(Json::parse(text)["file"], "a\xEF\xBF\xBD\"\n.bag");
}

TEST(Json, StampsAreGoodToAFractionOfAMicrosecond) {
  const std::string text = toText({{"stamp", toSeconds(1700000000123456789)}});
  EXPECT_NEAR(Json::parse(text)["stamp"].get<double>() - 1700000000.0, 0.123456789, 2e-7);
}

}  // namespace
}  // namespace camera_self_calibration
