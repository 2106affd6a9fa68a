#pragma once

#include <map>
#include <string>
#include <vector>

namespace camera_self_calibration {

using CsvRow = std::map<std::string, std::string>;  ///< By the header's names.

/// Appends the rows of a file of comma-separated values; lines that are still being written are
/// left out. False if there is no header to read.
bool readCsvRows(const std::string& file, std::vector<CsvRow>* rows);

/// A field as a number. Throws std::out_of_range if there is no such field.
double number(const CsvRow& row, const char* name);

}  // namespace camera_self_calibration
