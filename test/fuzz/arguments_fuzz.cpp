// The command line of calibrate_bag and the files that it names: arguments within their bounds that
// can be read from, or an exception.

#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "camera_self_calibration/tools/calibrate_bag_arguments.h"
#include "camera_self_calibration/tools/image_source.h"
#include "fuzz_bytes.h"

namespace camera_self_calibration {
namespace {

/// A file of these contents, by its name.
std::string fileOf(const std::string& contents) {
  static const int file = ::memfd_create("given", 0);
  if (::ftruncate(file, 0) != 0 || ::pwrite(file, contents.data(), contents.size(), 0) < 0) {
    return "/dev/null";
  }
  return "/proc/self/fd/" + std::to_string(file);
}

/// One argument a line, up to an empty line; behind it the contents of the file that @ stands for.
/// Other files are not for a fuzzer.
std::vector<std::string> argumentsOf(const std::string& text) {
  std::vector<std::string> arguments = {"calibrate_bag"};
  std::istringstream in(text);
  std::string line;
  while (std::getline(in, line) && !line.empty()) arguments.push_back(line);
  const auto end = in.tellg();
  const std::string rest = end < 0 ? "" : text.substr(static_cast<std::size_t>(end));
  for (std::string& argument : arguments) {
    if (argument.find_first_of("/@") == std::string::npos) continue;
    argument = argument.substr(0, argument.find_first_of("/@")) + fileOf(rest);
  }
  return arguments;
}

/// A folder of three pictures, each a pixel.
struct Pictures {
  std::string folder = "/tmp/arguments_fuzz_XXXXXX";

  Pictures() {
    require(::mkdtemp(folder.data()) != nullptr, "there is a folder for pictures");
    for (const char* name : {"/1.pgm", "/2.pgm", "/3.pgm"}) {
      std::ofstream(folder + name) << "P5 1 1 255 x";
    }
  }
  ~Pictures() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  Pictures(const Pictures&) = delete;
  Pictures& operator=(const Pictures&) = delete;
};

/// That the times asked for lead to no picture that is not there.
void readPictures(SourceOptions source) {
  static const Pictures pictures;
  source.path = pictures.folder;
  source.topic.clear();
  const ImageSource images = openImages(source);
  std::int64_t count = 0;
  while (images.next()) ++count;
  require(count == images.count && count <= 3, "the images that are said to come do come");
}

}  // namespace
}  // namespace camera_self_calibration

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace camera_self_calibration;
  static std::ostringstream help;  // not on the terminal
  std::cout.rdbuf(help.rdbuf());
  help.str("");
  const std::vector<std::string> given =
      argumentsOf(std::string(reinterpret_cast<const char*>(bytes), size));
  std::vector<const char*> argv;
  for (const std::string& argument : given) argv.push_back(argument.c_str());
  try {
    const auto arguments = parseCalibrateBagArguments(static_cast<int>(argv.size()), argv.data());
    countInput(arguments.has_value());
    if (!arguments) return 0;
    require(arguments->options.problems().empty(), "options are within their bounds");
    require(!arguments->source.path.empty(), "there is something to read");
    readPictures(arguments->source);
  } catch (const std::exception& e) {
    countInput(false);
    require(!std::string(e.what()).empty(), "an error says what is wrong");
  }
  return 0;
}
