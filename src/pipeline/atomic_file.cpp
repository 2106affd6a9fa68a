#include "camera_self_calibration/pipeline/atomic_file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>

namespace camera_self_calibration {
namespace {

constexpr std::uintmax_t kMaxBytes = 256u << 20;

// Behind it, the process that writes.
const char* const kBeside = ".new.";

std::string failure(const std::string& what, const std::string& path, int error) {
  return what + " " + path + ": " + std::strerror(error);
}

/// Flushed to the disk; 0 or the error's number.
int writeAndFlush(const std::string& path, const std::string& bytes) {
  constexpr int kMode = 0644;
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode);
  if (file < 0) return errno;
  std::size_t written = 0;
  int error = 0;
  while (written < bytes.size() && error == 0) {
    const ssize_t count = ::write(file, bytes.data() + written, bytes.size() - written);
    if (count > 0) written += static_cast<std::size_t>(count);
    if (count < 0 && errno != EINTR) error = errno;
  }
  if (error == 0 && ::fsync(file) != 0) error = errno;
  if (::close(file) != 0 && error == 0) error = errno;
  return error;
}

/// So that the new name outlives a loss of power. Some file systems cannot, which is no error.
void flushFolder(const std::string& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

/// The process that writes `name`, if that is a file beside `target` (see writeFileAtomically).
std::optional<pid_t> writerOf(const std::string& name, const std::string& target) {
  const std::string begin = target + kBeside;
  if (name.compare(0, begin.size(), begin) != 0) return std::nullopt;
  pid_t process = 0;
  const char* const end = name.data() + name.size();
  const auto [rest, error] = std::from_chars(name.data() + begin.size(), end, process);
  return error == std::errc() && rest == end && process > 0 ? std::optional(process) : std::nullopt;
}

/// What processes that were killed while they wrote have left beside `target`.
void removeLeftovers(const std::filesystem::path& folder, const std::string& target) {
  std::error_code error;
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error)) {
    const std::optional<pid_t> writer = writerOf(at->path().filename().string(), target);
    if (writer && ::kill(*writer, 0) != 0 && errno == ESRCH) ::unlink(at->path().c_str());
  }
}

}  // namespace

std::string writeFileAtomically(const std::string& given_path, const std::string& bytes) {
  // Behind a link the file itself is replaced, not the link.
  std::error_code unresolved;
  const std::filesystem::path resolved = std::filesystem::weakly_canonical(given_path, unresolved);
  const std::filesystem::path target = unresolved ? std::filesystem::path(given_path) : resolved;
  const std::string path = target.string();
  const std::string folder =
      target.has_parent_path() ? target.parent_path().string() : std::string(".");
  std::error_code made;
  std::filesystem::create_directories(folder, made);
  if (made) {
    return "cannot write " + path + ": the folder cannot be made: " + made.message();
  }
  removeLeftovers(folder, target.filename().string());
  const std::string beside = path + kBeside + std::to_string(::getpid());
  if (const int error = writeAndFlush(beside, bytes)) {
    ::unlink(beside.c_str());
    return failure("cannot write", beside, error);
  }
  const FileContents back = readFile(beside);
  if (back.bytes != bytes) {
    ::unlink(beside.c_str());
    return beside + " does not read back as it was written" +
           (back.error.empty() ? "" : ": " + back.error);
  }
  if (::rename(beside.c_str(), path.c_str()) != 0) {
    const int error = errno;
    ::unlink(beside.c_str());
    return failure("cannot replace", path, error);
  }
  flushFolder(folder);
  return "";
}

FileContents readFile(const std::string& path) {
  FileContents contents;
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) return contents;
  contents.exists = true;
  if (!error && !std::filesystem::is_regular_file(status)) {
    contents.error = path + " is not a file that can be read";
    return contents;
  }
  const std::uintmax_t size = error ? 0 : std::filesystem::file_size(path, error);
  if (error) {
    contents.error = failure("cannot read", path, error.value());
    return contents;
  }
  if (size > kMaxBytes) {
    contents.error = path + " is too large: more than " + std::to_string(kMaxBytes >> 20) + " MB";
    return contents;
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    contents.error = failure("cannot read", path, errno);
    return contents;
  }
  try {
    contents.bytes.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  } catch (const std::exception& e) {
    // As libstdc++ tells of a disk that fails.
    contents.error = "cannot read " + path + ": " + e.what();
  }
  return contents;
}

}  // namespace camera_self_calibration
