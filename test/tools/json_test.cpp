#include "camera_self_calibration/tools/json.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

namespace camera_self_calibration {
namespace {

TEST(Json, NumbersReadBackAndOthersAreNull) {
  for (const double value : {0.1, -1.0 / 3.0, 311.2, 1e-300, 6.02214076e23, 0.0}) {
    EXPECT_EQ(std::strtod(json::number(value).c_str(), nullptr), value);
  }
  EXPECT_EQ(json::number(0.1), "0.1");
  EXPECT_EQ(json::number(std::int64_t{-7}), "-7");
  EXPECT_EQ(json::number(std::numeric_limits<double>::quiet_NaN()), "null");
  EXPECT_EQ(json::number(std::numeric_limits<double>::infinity()), "null");
  EXPECT_EQ(json::number(-std::numeric_limits<double>::infinity()), "null");
}

TEST(Json, SecondsAreExact) {
  EXPECT_EQ(json::seconds(1700000000123456789), "1700000000.123456789");
  EXPECT_EQ(json::seconds(5), "0.000000005");
  EXPECT_EQ(json::seconds(-1500000000), "-1.500000000");
}

TEST(Json, StringsAreEscaped) {
  EXPECT_EQ(json::string("a \"b\" \\ c\n\t\x01"), "\"a \\\"b\\\" \\\\ c\\n\\t\\u0001\"");
  EXPECT_EQ(json::string("± ä"), "\"± ä\"");
}

TEST(Json, ObjectsKeepTheirOrder) {
  EXPECT_EQ(json::object({{"b", json::number(1.5)}, {"a", json::array({"1", "2"})}}),
            "{\"b\": 1.5, \"a\": [1, 2]}");
  EXPECT_EQ(json::object({}), "{}");
  EXPECT_EQ(json::array({}), "[]");
}

}  // namespace
}  // namespace camera_self_calibration
