#pragma once

#include <string>

namespace camera_self_calibration {

/// Puts `bytes` into a file such that, whatever happens meanwhile, it holds either what it held
/// before or all of the new contents: written beside it, flushed to the disk, read back, renamed.
/// Missing folders are made; what processes that were killed meanwhile have left beside it goes.
/// Returns what went wrong, in words with the path; empty if nothing.
std::string writeFileAtomically(const std::string& path, const std::string& bytes);

/// Contents of a file, of at most 256 MB.
struct FileContents {
  bool exists = false;
  std::string bytes;
  std::string error;  ///< Empty if it was read, or if there is no such file.
};

FileContents readFile(const std::string& path);

}  // namespace camera_self_calibration
