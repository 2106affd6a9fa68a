// Bags as librosbag and this program's reading of them take them: images or an exception. What
// reads runs in a process of its own, as it does in the tool, since librosbag crashes where lengths
// are damaged; here it reads one bag after the other, which is faster than one process each.

#include <ros/package.h>
#include <rosbag/bag.h>
#include <sanitizer/common_interface_defs.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core/utility.hpp>
#include <random>
#include <set>

#include "fuzz_bytes.h"
#include "tools/bag_source.h"

// Every rosbag::Bag looks through all packages of the machine for plugins that decrypt bags, which
// takes a tenth of a second. Only librosbag's own are given here; without them it opens no bag.
namespace ros {
namespace package {

std::string getPath(const std::string& package) { return "/usr/share/" + package; }
void getPlugins(const std::string&, const std::string&, V_string& plugins, bool) {
  plugins = {getPath("rosbag_storage") + "/encryptor_plugins.xml"};
}

}  // namespace package
}  // namespace ros

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* bytes, std::size_t size, std::size_t most);

namespace {

enum Answer : char { kUnsound, kReason, kImages };

constexpr int kUndefined = 77;  // exit code of the sanitizer, which no library has

/// What a call returns that the alarm of libFuzzer, which watches the time, may interrupt.
template <typename Call>
auto uninterrupted(const Call& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

/// What reading that bag gives, in this process.
Answer readHere(const std::string& path) {
  using namespace camera_self_calibration;
  SourceOptions options;
  options.path = path;
  Answer answer = kReason;
  try {
    const ImageSource source = openBagHere(options);
    for (int i = 0; i < 100; ++i) {
      const std::optional<GrayImage> image = source.next();
      if (!image) break;
      if (image->view) answer = kImages;
      if (!image->view && image->error.empty()) return kUnsound;
    }
  } catch (const std::exception& e) {
    if (*e.what() == '\0') return kUnsound;
  }
  return answer;
}

/// The process that reads: the bag of `file`, whenever a byte comes, which its answer replaces.
class Reader {
 public:
  Reader() : file_(::memfd_create("bag", 0)), path_("/proc/self/fd/" + std::to_string(file_)) {
    start();
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  /// Where librosbag ends the process, that is a reason; undefined behaviour is unsound. What is
  /// unsound is read again by a process that has read nothing else,
  /// in which no earlier bag has led librosbag to write where it should not.
  Answer read(const void* bytes, std::size_t size) {
    const Answer answer = readOnce(bytes, size);
    if (answer != kUnsound) return answer;
    stop();
    start();
    return readOnce(bytes, size);
  }

 private:
  Answer readOnce(const void* bytes, std::size_t size) {
    const bool written =
        ::ftruncate(file_, 0) == 0 && ::pwrite(file_, bytes, size, 0) == static_cast<ssize_t>(size);
    camera_self_calibration::require(written, "a file in memory can be had");
    constexpr int kBagsOfOneProcess = 200;  // librosbag leaks where it throws
    if (++bags_ > kBagsOfOneProcess) {
      stop();
      start();
    }
    char answer = 0;
    const auto send = [&] { return ::send(socket_, &answer, 1, MSG_NOSIGNAL); };
    const auto receive = [&] { return ::read(socket_, &answer, 1); };
    if (uninterrupted(send) == 1 && uninterrupted(receive) == 1) {
      return static_cast<Answer>(answer);
    }
    const int status = reap();
    start();
    return WIFEXITED(status) && WEXITSTATUS(status) == kUndefined ? kUnsound : kReason;
  }

  void start() {
    int ends[2];
    const bool paired = ::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) == 0;
    camera_self_calibration::require(paired, "sockets can be had");
    process_ = ::fork();
    camera_self_calibration::require(process_ >= 0, "a process can be had");
    ::close(ends[process_ == 0 ? 0 : 1]);
    socket_ = ends[process_ == 0 ? 1 : 0];
    bags_ = 0;
    if (process_ == 0) serve();
  }

  void stop() {
    ::kill(process_, SIGKILL);
    reap();
  }

  /// How the process ended.
  int reap() {
    ::close(socket_);
    int status = 0;
    uninterrupted([&] { return ::waitpid(process_, &status, 0); });
    return status;
  }

  /// Crashes end in silence, as in the tool; what is reserved has an end.
  [[noreturn]] void serve() {
    constexpr rlim_t kMemory = rlim_t{1} << 30;
    const rlimit memory = {kMemory, kMemory};
    ::setrlimit(RLIMIT_AS, &memory);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    for (const int crash : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL}) ::signal(crash, SIG_DFL);
    ::__sanitizer_set_death_callback(nullptr);
    char answer = 0;
    while (::read(socket_, &answer, 1) == 1) {
      answer = readHere(path_);
      if (::write(socket_, &answer, 1) != 1) break;
    }
    ::_exit(0);
  }

  const rosbag::Bag plugins_;  // are loaded once, not for each bag
  const int file_;
  const std::string path_;
  pid_t process_ = -1;
  int socket_ = -1;
  int bags_ = 0;
};

Reader& reader() {
  static Reader it;
  return it;
}

std::vector<std::string> bags;  // that all others are made from

void keepBagsWithImages(const std::string& folder) {
  if (!std::filesystem::is_directory(folder)) return;
  std::set<std::filesystem::path> paths;  // in the same order each time
  for (const auto& entry : std::filesystem::directory_iterator(folder)) paths.insert(entry.path());
  for (const std::filesystem::path& path : paths) {
    std::ifstream file(path, std::ios::binary);
    const std::string bag{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (reader().read(bag.data(), bag.size()) == kImages) bags.push_back(bag);
  }
}

/// A number of 1, 2, 4 or 8 bytes becomes another one: nothing behind it moves, so that what a bag
/// says of places in it goes on being right.
void changeNumber(std::uint8_t* bytes, std::size_t size, std::mt19937* random) {
  const std::size_t width = std::size_t{1} << ((*random)() % 4);
  if (size < width) return;
  std::uint8_t* place = bytes + (*random)() % (size - width + 1);
  std::uint64_t number = 0;
  std::memcpy(&number, place, width);
  const std::uint64_t others[] = {0,          ~std::uint64_t{0},
                                  number + 1, number - 1,
                                  size,       std::uint64_t{(*random)()} << ((*random)() % 33)};
  number = others[(*random)() % std::size(others)];
  std::memcpy(place, &number, width);
}

}  // namespace

extern "C" const char* __ubsan_default_options() {
  static const std::string options = "exitcode=" + std::to_string(kUndefined);
  return options.c_str();
}

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  cv::setNumThreads(1);  // threads do not come along with a process
  for (int i = 1; i < *count; ++i) keepBagsWithImages((*arguments)[i]);
  return 0;
}

// What the other process reaches is not seen here, so that each input is made from a whole bag.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* bytes, std::size_t size,
                                               std::size_t most, unsigned seed) {
  constexpr unsigned kMostChanges = 8;
  std::mt19937 random(seed);
  if (!bags.empty()) {
    const std::string& bag = bags[random() % bags.size()];
    size = std::min(bag.size(), most);
    std::memcpy(bytes, bag.data(), size);
  }
  const bool moves = random() % 4 == 0;
  for (unsigned left = 1 + random() % kMostChanges; left > 0; --left) {
    if (moves) {
      size = LLVMFuzzerMutate(bytes, size, most);
    } else {
      changeNumber(bytes, size, &random);
    }
  }
  return size;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const Answer answer = reader().read(bytes, size);
  camera_self_calibration::countInput(answer == kImages);
  camera_self_calibration::require(answer != kUnsound, "a bag gives images, or a reason why not");
  return 0;
}
