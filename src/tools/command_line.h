#pragma once

#include <boost/program_options.hpp>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

namespace camera_self_calibration {

/// Reads a program's arguments into the variables that `all` names; `positional` are the options
/// that may stand without a name, in their order. Nothing if help was asked for: usage and options
/// are printed then. Throws boost::program_options::error with what is wrong with the arguments.
inline std::optional<boost::program_options::variables_map> readCommandLine(
    int argc, const char* const* argv, const boost::program_options::options_description& all,
    const std::vector<std::string>& positional, const char* usage) {
  namespace po = boost::program_options;
  po::positional_options_description unnamed;
  for (const std::string& name : positional) unnamed.add(name.c_str(), 1);
  po::variables_map given;
  po::store(po::command_line_parser(argc, argv).options(all).positional(unnamed).run(), given);
  po::notify(given);
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
