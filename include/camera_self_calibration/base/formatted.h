#pragma once

#include <cstdint>
#include <string>

namespace camera_self_calibration {

/// The text that printf would print, whatever its length. The compiler checks the values against
/// the format.
[[gnu::format(printf, 1, 2)]] std::string formatted(const char* format, ...);

/// The text with a full stop at its end, unless it ends with punctuation already. Empty stays
/// empty.
std::string withFullStop(const std::string& text);

/// The text with a capital letter at its beginning and a full stop at its end, unless it ends with
/// punctuation already. Empty stays empty. What begins with a word that is written with other than
/// small letters, such as a path, begins as it is.
std::string asSentence(const std::string& text);

/// Two texts as sentences, one after the other; either may be empty.
std::string sentencesOf(const std::string& text, const std::string& more);

/// Shortest text that reads back as the same number.
std::string exactText(double value);

/// The same with a decimal point, by which readers of YAML tell a real number from an integer
/// (ORB-SLAM3 accepts no other) and from a word (Python's: 5e-05).
std::string realText(double value);

/// A stamp in seconds with nine decimals, which is exact.
std::string stampText(std::int64_t nanoseconds);

/// "640 x 480".
std::string sizeText(int width, int height);

}  // namespace camera_self_calibration
