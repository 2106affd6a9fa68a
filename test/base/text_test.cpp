#include "camera_self_calibration/base/text.h"

#include <gtest/gtest.h>

namespace camera_self_calibration {
namespace {

TEST(Text, IsNotWhatYamlCppTakesForAnotherEncoding) {
  EXPECT_TRUE(isText("fx: 420 \xC3\xA4"));
  EXPECT_FALSE(isText(std::string("fx\0", 3)));
  EXPECT_FALSE(isText("\xFF\xFE"));
}

TEST(Text, AListThatEndsInAColonIsFound) {
  for (const char* bad : {"[0, :]", "[0, 1: ]", "[0,\n 1:\n]", "a: [0, 1:", "[a: 1, :]", "[0:\n"}) {
    EXPECT_TRUE(hasListThatEndsInColon(bad)) << bad;
  }
  for (const char* good : {"", "a:", "a: [0, 1]\nb:\n", "[a: 1]", "{a: }", "[0, 1]: 2", "]"}) {
    EXPECT_FALSE(hasListThatEndsInColon(good)) << good;
  }
}

}  // namespace
}  // namespace camera_self_calibration
