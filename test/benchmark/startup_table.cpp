#include "benchmark/startup_table.h"

#include <algorithm>
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
  int converged = 0;
  int false_converged = 0;
  int lost = 0;
  int early = 0;  // handed over while there was nothing to learn from
  std::vector<double> converged_s, error_px, slowdown;

  void add(const CsvRow& row) {
    const bool is_converged = row.at("state") == "CONVERGED";
    const bool is_informed = number(row, "optimum_rms_px") <= number(row, "threshold_px");
    ++trials;
    at_optimum += number(row, "excess_cost") < kExcessCost;
    informed += is_informed;
    informed_converged += is_informed && is_converged;
    converged += is_converged;
    false_converged += number(row, "false_converged") != 0.0;
    lost += number(row, "lost") != 0.0;
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
  std::printf("%-18s %6d %10d (%5.1f %%) %8d %9d (%5.1f %%) %9d %6d %5d %5d %8.1f %8.3f %8.2f\n",
              name.c_str(), tally.trials, tally.at_optimum, 100.0 * tally.at_optimum / tally.trials,
              tally.informed, tally.informed_converged,
              100.0 * tally.informed_converged / std::max(1, tally.informed), tally.converged,
              tally.false_converged, tally.early, tally.lost, median(tally.converged_s, 0.0),
              median(tally.error_px, 0.0), median(tally.slowdown, 0.0));
}

void printTable(const std::string& series, const std::vector<CsvRow>& rows) {
  std::map<std::string, Tally> groups;
  Tally all;
  for (const CsvRow& row : rows) {
    groups[row.at("group")].add(row);
    all.add(row);
  }
  std::printf("\n%s\n%-18s %6s %20s %8s %19s %9s %6s %5s %5s %8s %8s %8s\n", series.c_str(), "",
              "trials", "at the optimum", "informed", "of them converged", "converged", "false",
              "early", "lost", "after s", "error px", "slowdown");
  for (const auto& [name, tally] : groups) print(name, tally);
  print("all", all);
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
  for (const auto& [series, its_rows] : by_series) printTable(series, its_rows);
  return true;
}

}  // namespace camera_self_calibration
