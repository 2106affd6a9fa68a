#pragma once

#include <boost/program_options.hpp>
#include <cstring>
#include <exception>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace camera_self_calibration {

/// Refuses the words that boost puts what was wrong in place of: it never comes to an end where
/// that holds such a word itself. Throws std::runtime_error.
inline void refusePlaceholders(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    for (const char* word :
         {"%option%", "%canonical_option%", "%original_token%", "%prefix%", "%value%"}) {
      if (std::strstr(argv[i], word) == nullptr) continue;
      throw std::runtime_error("the argument '" + std::string(argv[i]) + "' holds " + word +
                               ", which nothing here is called");
    }
  }
}

/// The arguments by option; `positional` are the options that may stand without a name.
inline boost::program_options::parsed_options parseCommandLine(
    int argc, const char* const* argv, const boost::program_options::options_description& all,
    const std::vector<std::string>& positional) {
  namespace po = boost::program_options;
  refusePlaceholders(argc, argv);
  po::positional_options_description unnamed;
  for (const std::string& name : positional) {
    const bool many = all.find(name, false).semantic()->max_tokens() > 1;
    unnamed.add(name.c_str(), many ? -1 : 1);
  }
  return po::command_line_parser(argc, argv).options(all).positional(unnamed).run();
}

/// Reads a program's arguments into the variables that `all` names; `positional` are the options
/// that may stand without a name, in their order; one of many values takes all that follow. Nothing
/// if help was asked for: usage and options are printed then. Throws std::exception with what is
/// wrong with the arguments.
inline std::optional<boost::program_options::variables_map> readCommandLine(
    int argc, const char* const* argv, const boost::program_options::options_description& all,
    const std::vector<std::string>& positional, const char* usage) {
  boost::program_options::variables_map given;
  boost::program_options::store(parseCommandLine(argc, argv, all, positional), given);
  boost::program_options::notify(given);
  if (given.count("help") == 0) return given;
  std::cout << usage << '\n' << all;
  return std::nullopt;
}

/// A program: `parse` gives its arguments, or nothing where help was asked for, and `run` the exit
/// code. What either throws is printed after the program's name; exit code 1.
template <typename Parse, typename Run>
int runProgram(const char* name, Parse parse, Run run) {
  try {
    const auto arguments = parse();
    return arguments ? run(*arguments) : 0;
  } catch (const std::exception& e) {
    std::cerr << name << ": " << e.what() << '\n';
    return 1;
  }
}

}  // namespace camera_self_calibration
