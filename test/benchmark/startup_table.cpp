#include "benchmark/startup_table.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

#include "benchmark/csv_rows.h"
#include "camera_self_calibration/base/median.h"

namespace camera_self_calibration {
namespace {

// Costs that exceed the optimum's by less are at the optimum.
constexpr double kExcessCost = 0.002;

// What the rows of a table count.
struct Tally {
  int trials = 0;
  int at_optimum = 0;
  int informed = 0;            // the optimum meets the convergence threshold
  int informed_converged = 0;  // ... and CONVERGED was reported
  int false_converged = 0;
  int early = 0;  // handed over while there was nothing to learn from
  std::vector<double> converged_s, error_px, slowdown;

  void add(const CsvRow& row) {
    const bool is_converged = row.at("state") == "CONVERGED";
    const bool is_informed = number(row, "optimum_rms_px") <= number(row, "threshold_px");
    ++trials;
    at_optimum += number(row, "excess_cost") < kExcessCost;
    informed += is_informed;
    informed_converged += is_informed && is_converged;
    false_converged += number(row, "false_converged") != 0.0;
    const double handover = number(row, "handover_s");
    early += handover >= 0.0 && handover < number(row, "idle_s");
    if (number(row, "first_idle_ms") > 0.0) {
      slowdown.push_back(number(row, "last_idle_ms") / number(row, "first_idle_ms"));
    }
    if (!is_converged) return;
    converged_s.push_back(number(row, "converged_s") - number(row, "idle_s"));
    error_px.push_back(number(row, "error_px"));
  }
};

void print(const std::string& name, const Tally& tally) {
  std::printf("| %s | %d | %d | %d of %d | %d | %d | %.1f | %.3f | %.2f |\n", name.c_str(),
              tally.trials, tally.at_optimum, tally.informed_converged, tally.informed,
              tally.false_converged, tally.early, median(tally.converged_s, NAN),
              median(tally.error_px, NAN), median(tally.slowdown, NAN));
}

void printSeries(const std::string& series, const std::vector<CsvRow>& rows) {
  std::map<std::string, Tally> groups;
  Tally all;
  for (const CsvRow& row : rows) {
    groups[row.at("group")].add(row);
    all.add(row);
  }
  // The guesses of one lens are too many for a row each.
  if (groups.size() <= 8) {
    for (const auto& [name, tally] : groups) print(series + ", " + name, tally);
  }
  print(series + ", all", all);
}

}  // namespace

std::string csvHeader() {
  return "series,group,number,state,handover_s,converged_s,idle_s,lost,keyframes,excess_cost,"
         "optimum_rms_px,threshold_px,error_px,stated_px,worst_sigmas,false_converged,"
         "idle_keyframes,first_idle_ms,last_idle_ms,cpu_s";
}

std::string csvLine(const TrialRecord& record) {
  const StartupOutcome& o = record.outcome;
  std::ostringstream line;
  line << record.series << ',' << record.group << ',' << record.number << ',' << o.state << ','
       << o.handover_s << ',' << o.converged_s << ',' << record.trial.idle_s << ',' << o.lost << ','
       << o.keyframes << ',' << o.excess_cost << ',' << o.optimum_rms_px << ',' << o.threshold_px
       << ',' << o.error_px << ',' << o.stated_px << ',' << o.worst_sigmas << ','
       << o.false_converged << ',' << o.idle_keyframes << ',' << o.first_idle_ms << ','
       << o.last_idle_ms << ',' << o.cpu_s;
  return line.str();
}

bool printTables(const std::vector<std::string>& files) {
  std::vector<CsvRow> rows;
  for (const std::string& file : files) {
    if (readCsvRows(file, &rows)) continue;
    std::cerr << "cannot read " << file << "\n";
    return false;
  }
  std::map<std::string, std::vector<CsvRow>> by_series;
  for (const CsvRow& row : rows) by_series[row.at("series")].push_back(row);
  std::printf(
      "| series | trials | at the optimum | CONVERGED, where the optimum is good enough for it "
      "| falsely CONVERGED | handed over too early | median time to CONVERGED [s] "
      "| median error [px] | cost of a keyframe, later / earlier |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [series, its_rows] : by_series) printSeries(series, its_rows);
  return true;
}

}  // namespace camera_self_calibration
