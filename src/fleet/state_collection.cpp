#include "camera_self_calibration/fleet/state_collection.h"

#include <filesystem>
#include <optional>

#include "camera_self_calibration/fleet/state_solution.h"
#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/state_file.h"

namespace camera_self_calibration {
namespace {

std::vector<BagRecord> recordsIn(const std::string& path, const LearntState& state) {
  std::vector<BagRecord> records = state.bags;
  if (records.empty()) {
    const std::optional<BagRecord> record = recordOf(state);
    if (!record) return {};
    records.push_back(*record);
    records[0].bag = path;
    records[0].camera = std::filesystem::path(path).stem().string();
  }
  // A merged state keeps where each bag's own state is.
  if (records.size() == 1 && records[0].state_file.empty()) records[0].state_file = path;
  return records;
}

}  // namespace

StateCollection readStates(const std::vector<std::string>& paths) {
  StateCollection read;
  for (const std::string& path : paths) {
    const DecodedState decoded = readStateFile(path);
    if (!decoded.state) {
      read.problems.push_back(path + " is left out: " + decoded.error);
      continue;
    }
    const std::vector<BagRecord> records = recordsIn(path, *decoded.state);
    if (records.empty()) {
      read.problems.push_back(path + " is left out: its segments have no solution");
      continue;
    }
    read.store.note(path, records, *decoded.state);
    read.records.insert(read.records.end(), records.begin(), records.end());
  }
  return read;
}

}  // namespace camera_self_calibration
