#pragma once

#include <ros/node_handle.h>

#include <string>
#include <utility>
#include <vector>

namespace camera_self_calibration {

/// Reads parameters one by one and remembers what is wrong with them, so that all of it can be said
/// at once.
class ParameterReader {
 public:
  explicit ParameterReader(const ros::NodeHandle& node) : node_(node) {}

  /// What is absent keeps its default; a wrong type becomes a problem.
  template <typename T>
  void operator()(const std::string& name, T* value) {
    known_.push_back(name);
    if (!node_.hasParam(name)) return;
    if (node_.getParam(name, *value)) return;
    problems_.push_back(name + " must be " + typeName(*value));
  }

  /// A name that may be "off", which is false where YAML reads it without quotes.
  void orOff(const std::string& name, std::string* value) {
    bool on = true;
    if (node_.getParam(name, on) && !on) {
      known_.push_back(name);
      *value = "off";
    } else {
      (*this)(name, value);
    }
  }

  /// A word, or a number as it would be written; what YAML reads as false is "off".
  void word(const std::string& name, std::string* value);

  const std::vector<std::string>& problems() const { return problems_; }

  /// All names that were asked for.
  const std::vector<std::string>& known() const { return known_; }

  /// Parameters of the namespace that nobody asked for, each in a sentence with the nearest name
  /// that somebody did ask for. Namespaces inside it are others' business.
  std::vector<std::string> unknown() const;

 private:
  static const char* typeName(const std::string&) { return "a string"; }
  static const char* typeName(bool) { return "true or false"; }
  static const char* typeName(int) { return "a whole number"; }
  static const char* typeName(double) { return "a number"; }
  static const char* typeName(const std::vector<double>&) { return "a list of numbers"; }
  static const char* typeName(const std::vector<std::string>&) { return "a list of strings"; }

  const ros::NodeHandle& node_;
  std::vector<std::string> known_;
  std::vector<std::string> problems_;
};

/// Options as they were read.
template <typename Options>
struct OptionsReading {
  Options options;
  std::vector<std::string> problems;  ///< Wrong types and violated bounds; empty if all is well.
  std::vector<std::string> warnings;  ///< Parameters that are not known.
  std::vector<std::string> known;     ///< Names of all parameters.
};

/// What `reader` read into `options`, with the bounds that these violate.
template <typename Options>
OptionsReading<Options> readingOf(const ParameterReader& reader, Options options) {
  OptionsReading<Options> reading{std::move(options), reader.problems(), reader.unknown(),
                                  reader.known()};
  const std::vector<std::string> violated = reading.options.problems();
  reading.problems.insert(reading.problems.end(), violated.begin(), violated.end());
  return reading;
}

/// The name that is reached with the fewest changed, missing, superfluous or exchanged letters;
/// empty if none is near (more than a third of the letters differ).
std::string nearestName(const std::string& name, const std::vector<std::string>& known);

}  // namespace camera_self_calibration
