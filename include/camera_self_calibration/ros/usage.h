#pragma once

#include <algorithm>
#include <iostream>
#include <string>

namespace camera_self_calibration {

/// For a node, before ros::init(), which waits for a master: whether --help or -h is among the
/// arguments, upon which the usage is printed.
inline bool printsUsage(int argc, const char* const* argv, const char* usage) {
  const bool asked = std::any_of(argv + 1, argv + argc, [](const std::string& argument) {
    return argument == "--help" || argument == "-h";
  });
  if (asked) std::cout << usage;
  return asked;
}

}  // namespace camera_self_calibration
