#include "camera_self_calibration/pipeline/state_file.h"

#include "camera_self_calibration/pipeline/atomic_file.h"

namespace camera_self_calibration {

DecodedState readStateFile(const std::string& path) {
  const FileContents contents = readFile(path);
  if (!contents.exists) return {nullptr, "there is no such file"};
  if (!contents.error.empty()) return {nullptr, contents.error};
  return decodeState(contents.bytes);
}

}  // namespace camera_self_calibration
