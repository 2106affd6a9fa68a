#include "camera_self_calibration/ros/parameter_reader.h"

#include <algorithm>
#include <numeric>
#include <sstream>

namespace camera_self_calibration {
namespace {

// Read by diagnostic_updater and nodelet in the same namespace.
const char* const kOthers[] = {"diagnostic_period", "diagnostic_updater_use_fqn",
                               "num_worker_threads"};

/// Damerau's distance, in the variant in which no letter is touched twice.
std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  std::iota(d[0].begin(), d[0].end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, changed});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

void ParameterReader::word(const std::string& name, std::string* value) {
  XmlRpc::XmlRpcValue given;
  if (node_.getParam(name, given) && (given.getType() == XmlRpc::XmlRpcValue::TypeDouble ||
                                      given.getType() == XmlRpc::XmlRpcValue::TypeInt)) {
    known_.push_back(name);
    double number = 0.0;
    node_.getParam(name, number);
    std::ostringstream text;
    text << number;
    *value = text.str();
  } else {
    orOff(name, value);
  }
}

std::vector<std::string> ParameterReader::unknown() const {
  std::vector<std::string> sentences;
  XmlRpc::XmlRpcValue all;
  if (!node_.getParam(node_.getNamespace(), all) || all.getType() != all.TypeStruct) {
    return sentences;
  }
  for (const auto& parameter : all) {
    const std::string& name = parameter.first;
    if (parameter.second.getType() == XmlRpc::XmlRpcValue::TypeStruct) continue;
    if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
    if (std::find(std::begin(kOthers), std::end(kOthers), name) != std::end(kOthers)) continue;
    const std::string near = nearestName(name, known_);
    sentences.push_back("the parameter ~" + name + " is not known" +
                        (near.empty() ? "" : "; is ~" + near + " meant?"));
  }
  return sentences;
}

std::string nearestName(const std::string& name, const std::vector<std::string>& known) {
  std::string best;
  std::size_t least = std::max<std::size_t>(1, name.size() / 3) + 1;
  for (const std::string& candidate : known) {
    const std::size_t distance = editDistance(name, candidate);
    if (distance >= least) continue;
    least = distance;
    best = candidate;
  }
  return best;
}

}  // namespace camera_self_calibration
