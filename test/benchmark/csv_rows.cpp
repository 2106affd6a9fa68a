#include "benchmark/csv_rows.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace camera_self_calibration {
namespace {

std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result;
  std::istringstream stream(line + ",");  // an empty last field counts, too
  for (std::string field; std::getline(stream, field, ',');) result.push_back(field);
  return result;
}

}  // namespace

bool readCsvRows(const std::string& file, std::vector<CsvRow>* rows) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) return false;
  const std::vector<std::string> names = fields(line);
  while (std::getline(stream, line)) {
    const std::vector<std::string> values = fields(line);
    if (values.size() != names.size()) continue;
    CsvRow row;
    for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = values[i];
    rows->push_back(row);
  }
  return true;
}

double number(const CsvRow& row, const char* name) { return std::atof(row.at(name).c_str()); }

}  // namespace camera_self_calibration
