#include "benchmark/program_arguments.h"

#include <cstdio>

namespace camera_self_calibration {

std::optional<ArgumentValues> readArguments(int argc, char** argv, ArgumentValues values) {
  const ArgumentValues defaults = values;
  bool sound = argc % 2 == 1;
  for (int i = 1; i + 1 < argc; i += 2) {
    sound = sound && defaults.count(argv[i]) > 0;
    values[argv[i]] = argv[i + 1];
  }
  if (sound) return values;
  std::fprintf(stderr, "usage: %s", argv[0]);
  for (const auto& [name, value] : defaults) {
    std::fprintf(stderr, " [%s %s]", name.c_str(), value.empty() ? "..." : value.c_str());
  }
  std::fprintf(stderr, "\n");
  return std::nullopt;
}

}  // namespace camera_self_calibration
