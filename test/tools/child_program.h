#pragma once

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

namespace camera_self_calibration {

/// A program whose standard error is a terminal that the test reads.
class ChildProgram {
 public:
  explicit ChildProgram(std::vector<std::string> command) : master_(posix_openpt(O_RDWR)) {
    if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0) return;
    const std::string terminal = ptsname(master_);
    std::vector<char*> arguments;
    for (std::string& word : command) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    dup2(open(terminal.c_str(), O_RDWR | O_NOCTTY), STDERR_FILENO);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  ~ChildProgram() {
    if (pid_ > 0) wait();
    if (master_ >= 0) close(master_);
  }
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

  /// Reads until the words have come; false if the program ends before.
  bool says(const std::string& words) {
    char buffer[256];
    while (text_.find(words) == std::string::npos) {
      const ssize_t count = read(master_, buffer, sizeof(buffer));
      if (count <= 0) return false;
      text_.append(buffer, static_cast<std::size_t>(count));
    }
    return true;
  }
  void send(int signal) const { kill(pid_, signal); }
  /// Its exit code, or -1 if it did not end by itself.
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  const std::string& text() const { return text_; }

 private:
  int master_;
  pid_t pid_ = -1;
  std::string text_;
};

}  // namespace camera_self_calibration
