#include "camera_self_calibration/pipeline/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

namespace camera_self_calibration {
namespace {

namespace fs = std::filesystem;

class AtomicFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("atomic_file_test_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override {
    fs::permissions(folder_, fs::perms::owner_all);
    fs::remove_all(folder_);
  }
  std::string path(const std::string& name) const { return folder_ / name; }
  int files() const { return static_cast<int>(std::distance(fs::directory_iterator(folder_), {})); }

  fs::path folder_;
};

TEST_F(AtomicFile, WritesReadsAndReplaces) {
  const std::string path = folder_ / "deep" / "deeper" / "state";
  EXPECT_FALSE(readFile(path).exists);
  EXPECT_EQ(writeFileAtomically(path, std::string("a\0b", 3)), "");
  EXPECT_EQ(readFile(path).bytes, std::string("a\0b", 3));
  EXPECT_EQ(writeFileAtomically(path, "second"), "");
  EXPECT_EQ(readFile(path).bytes, "second");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "deep" / "deeper"), {}), 1)
      << "nothing is left beside it";
}

// Else a node that is killed now and then fills the folder.
TEST_F(AtomicFile, WhatKilledProcessesLeftBesideItGoes) {
  const pid_t dead = ::fork();
  if (dead == 0) ::_exit(0);
  ASSERT_EQ(::waitpid(dead, nullptr, 0), dead);
  const std::string ended = ".new." + std::to_string(dead);
  const std::string living = path("kept.new.") + std::to_string(::getppid());
  ASSERT_EQ(writeFileAtomically(path("kept") + ended, "half a fi"), "");
  ASSERT_EQ(writeFileAtomically(path("other") + ended, "of another file"), "");
  ASSERT_EQ(writeFileAtomically(path("kept.new.1x"), "of the user"), "");
  ASSERT_EQ(writeFileAtomically(living, "being written"), "");
  ASSERT_EQ(writeFileAtomically(path("kept"), "new"), "");
  EXPECT_FALSE(fs::exists(path("kept") + ended));
  EXPECT_TRUE(fs::exists(path("other") + ended));
  EXPECT_TRUE(fs::exists(path("kept.new.1x")));
  EXPECT_TRUE(fs::exists(living));
}

TEST_F(AtomicFile, BehindALinkTheFileIsReplaced) {
  const std::string path = folder_ / "file";
  const std::string link = folder_ / "link";
  ASSERT_EQ(writeFileAtomically(path, "first"), "");
  fs::create_symlink(path, link);
  EXPECT_EQ(writeFileAtomically(link, "second"), "");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(readFile(path).bytes, "second");
}

TEST_F(AtomicFile, SaysWhyItCannotWrite) {
  ASSERT_EQ(writeFileAtomically(folder_ / "file", "x"), "");
  const std::string under_a_file = folder_ / "file" / "state";
  EXPECT_NE(writeFileAtomically(under_a_file, "y").find("file"), std::string::npos);
  fs::create_directories(folder_ / "folder" / "inside");
  EXPECT_NE(writeFileAtomically(folder_ / "folder", "y").find("folder"), std::string::npos);
  EXPECT_EQ(files(), 2) << "nothing is left beside it";
  EXPECT_FALSE(readFile(folder_ / "folder").error.empty());
}

// As without permission, which tests that run as root cannot be denied.
TEST_F(AtomicFile, SaysWhyItCannotRead) {
  ASSERT_EQ(writeFileAtomically(folder_ / "file", "x"), "");
  rlimit before = {};
  getrlimit(RLIMIT_NOFILE, &before);
  const rlimit none = {0, before.rlim_max};
  setrlimit(RLIMIT_NOFILE, &none);
  const FileContents contents = readFile(folder_ / "file");
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_TRUE(contents.exists);
  EXPECT_NE(contents.error.find(std::strerror(EMFILE)), std::string::npos) << contents.error;
  // As in a folder without permission: whether there is a file cannot be told.
  fs::create_symlink("loop", folder_ / "loop");
  const FileContents unknown = readFile(folder_ / "loop");
  EXPECT_TRUE(unknown.exists);
  EXPECT_NE(unknown.error.find(std::strerror(ELOOP)), std::string::npos) << unknown.error;
}

// A file of one byte more than the limit is refused before it is read; the bytes are a hole here.
TEST_F(AtomicFile, RefusesToReadMoreThanItsLimit) {
  ASSERT_EQ(writeFileAtomically(folder_ / "file", "x"), "");
  fs::resize_file(folder_ / "file", (std::uintmax_t{256} << 20) + 1);
  const FileContents contents = readFile(folder_ / "file");
  EXPECT_TRUE(contents.exists);
  EXPECT_TRUE(contents.bytes.empty());
  EXPECT_NE(contents.error.find("more than 256 MB"), std::string::npos) << contents.error;
}

// As of a disk that fails: at its beginning no memory is mapped.
TEST_F(AtomicFile, SaysThatReadingFails) {
  const std::string path = "/proc/self/mem";
  if (!fs::exists(path)) GTEST_SKIP();
  const FileContents contents = readFile(path);
  EXPECT_TRUE(contents.exists);
  EXPECT_NE(contents.error.find(path), std::string::npos) << contents.error;
  EXPECT_TRUE(contents.bytes.empty());
}

// A disk that is full: the old contents stay.
TEST_F(AtomicFile, AFullDiskLeavesTheOldContents) {
  if (!fs::exists("/dev/full")) GTEST_SKIP();
  const std::string path = folder_ / "state";
  ASSERT_EQ(writeFileAtomically(path, "old"), "");
  // The file beside it is a link to the full device.
  fs::create_symlink("/dev/full", path + ".new." + std::to_string(::getpid()));
  EXPECT_NE(writeFileAtomically(path, "new"), "");
  EXPECT_EQ(readFile(path).bytes, "old");
  EXPECT_EQ(files(), 1);
}

}  // namespace
}  // namespace camera_self_calibration
