// Bags as librosbag and this program's reading of them take them: images or an exception. What
// reads runs in a process of its own, so that only what gets through to this one counts.

#include <pthread.h>
#include <ros/package.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core/utility.hpp>
#include <stdexcept>

#include "camera_self_calibration/tools/image_source.h"
#include "fuzz_bytes.h"

// Every rosbag::Bag looks through all packages of the machine for plugins that decrypt bags, which
// takes a tenth of a second. Here there are none.
namespace ros {
namespace package {

std::string getPath(const std::string& package) { return "/usr/share/" + package; }
void getPlugins(const std::string&, const std::string&, V_string& plugins, bool) {
  plugins.clear();
}

}  // namespace package
}  // namespace ros

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t size, std::size_t most);

namespace {

std::vector<std::string> bags;  // that all others are made from

void readBags(const std::string& folder) {
  if (!std::filesystem::is_directory(folder)) return;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    bags.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
}

/// A child that crashes ends in silence, as it does in the tool; what it reserves has an end.
void limitChild() {
  constexpr rlim_t kMemory = rlim_t{1} << 30;
  const rlimit memory = {kMemory, kMemory};
  ::setrlimit(RLIMIT_AS, &memory);
  for (const int crash : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL}) ::signal(crash, SIG_DFL);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  for (int i = 1; i < *count; ++i) readBags((*arguments)[i]);
  cv::setNumThreads(1);  // once, not in each child
  return ::pthread_atfork(nullptr, nullptr, limitChild);
}

// What a child reaches is not seen here, so that each input is made from a whole bag.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t size,
                                               std::size_t most, unsigned seed) {
  constexpr unsigned kMostChanges = 8;
  if (!bags.empty()) {
    const std::string& bag = bags[seed % bags.size()];
    size = std::min(bag.size(), most);
    std::memcpy(bytes, bag.data(), size);
  }
  for (unsigned i = 0; i <= seed / 7 % kMostChanges; ++i)
    size = LLVMFuzzerMutate(bytes, size, most);
  return size;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace camera_self_calibration;
  static const int file = ::memfd_create("bag", 0);
  if (::ftruncate(file, 0) != 0) return 0;
  if (::pwrite(file, bytes, size, 0) != static_cast<ssize_t>(size)) return 0;
  SourceOptions options;
  options.path = "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(file);
  try {
    const ImageSource source = openBag(options);
    for (int i = 0; i < 100; ++i) {
      const std::optional<GrayImage> image = source.next();
      if (!image) break;
      require(image->view || !image->error.empty(), "a refusal has a reason");
    }
  } catch (const std::runtime_error& e) {
    require(!std::string(e.what()).empty(), "an error says what is wrong");
  }
  return 0;
}
