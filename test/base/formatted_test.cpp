#include "camera_self_calibration/base/formatted.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace camera_self_calibration {
namespace {

TEST(Formatted, IsWhatPrintfWouldPrint) {
  EXPECT_EQ(formatted("nothing"), "nothing");
  EXPECT_EQ(formatted("%s: %.2f px, %d of %d", "error", 0.125, 3, 10), "error: 0.12 px, 3 of 10");
  EXPECT_EQ(formatted("%.*f %%", 3, 1.0), "1.000 %");
  EXPECT_EQ(formatted("%s", ""), "");
}

TEST(Formatted, CutsNothingOff) {
  const std::string word(5000, 'x');
  EXPECT_EQ(formatted("<%s>", word.c_str()), "<" + word + ">");
  EXPECT_EQ(formatted("%.1f", 1e300).size(), 303u);
}

TEST(Formatted, NumbersReadBack) {
  for (const double value : {0.1, -1.0 / 3.0, 311.2, 1e-300, 6.02214076e23, 0.0}) {
    EXPECT_EQ(std::strtod(exactText(value).c_str(), nullptr), value);
  }
  EXPECT_EQ(exactText(0.1), "0.1");
}

TEST(Formatted, RealNumbersHaveAPoint) {
  for (const double value : {615.0, -2.0, 5e-5, 1e-300, 6.02214076e23, 0.1, 0.0}) {
    const std::string text = realText(value);
    EXPECT_NE(text.find('.'), std::string::npos) << text;
    EXPECT_EQ(std::strtod(text.c_str(), nullptr), value) << text;
  }
  EXPECT_EQ(realText(615.0), "615.0");
  EXPECT_EQ(realText(5e-5), "5.0e-05");
}

TEST(Formatted, SecondsAreExact) {
  EXPECT_EQ(stampText(1700000000123456789), "1700000000.123456789");
  EXPECT_EQ(stampText(5), "0.000000005");
  EXPECT_EQ(stampText(-1500000000), "-1.500000000");
}

TEST(Formatted, BecomesASentence) {
  EXPECT_EQ(asSentence(""), "");
  EXPECT_EQ(asSentence("not saved: the disk is full"), "Not saved: the disk is full.");
  EXPECT_EQ(asSentence("Is it so?"), "Is it so?");
  EXPECT_EQ(asSentence("/tmp/x cannot be read"), "/tmp/x cannot be read.");
  EXPECT_EQ(asSentence("camera_info stays zero"), "camera_info stays zero.");
}

TEST(SentencesOf, TheSecondMayBeMissing) {
  EXPECT_EQ(sentencesOf("it is good", "go on"), "It is good. Go on.");
  EXPECT_EQ(sentencesOf("it is good", ""), "It is good.");
  EXPECT_EQ(sentencesOf("", "go on"), "Go on.");
  EXPECT_EQ(sentencesOf("", ""), "");
}

}  // namespace
}  // namespace camera_self_calibration
