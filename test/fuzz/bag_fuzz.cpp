// Bags as librosbag and this program's reading of them take them: images or an exception. What
// reads runs in a process of its own, so that only what gets through to this one counts.

#include <pthread.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <stdexcept>

#include "camera_self_calibration/tools/image_source.h"
#include "fuzz_bytes.h"

namespace {

/// A child that crashes ends in silence, as it does in the tool; what it reserves has an end.
void limitChild() {
  constexpr rlim_t kMemory = rlim_t{1} << 30;
  const rlimit memory = {kMemory, kMemory};
  ::setrlimit(RLIMIT_AS, &memory);
  for (const int crash : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL}) ::signal(crash, SIG_DFL);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  return ::pthread_atfork(nullptr, nullptr, limitChild);
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
