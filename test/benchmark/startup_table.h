#pragma once

#include <string>
#include <vector>

#include "benchmark/startup_trial.h"

namespace camera_self_calibration {

/// A trial of a series, and what came of it.
struct TrialRecord {
  std::string series;
  std::string group;  ///< Row of the series' table.
  int number = 0;
  StartupTrial trial;
  StartupOutcome outcome;
};

std::string csvHeader();
/// One line, without its end.
std::string csvLine(const TrialRecord& record);

/// Prints a table of each series found in the files; false if one cannot be read.
bool printTables(const std::vector<std::string>& files);

}  // namespace camera_self_calibration
