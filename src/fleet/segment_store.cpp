#include "camera_self_calibration/fleet/segment_store.h"

#include <filesystem>
#include <memory>
#include <optional>

#include "camera_self_calibration/pipeline/atomic_file.h"

namespace camera_self_calibration {
namespace {

const Candidate* find(const LearntState& state, const SegmentMark& mark) {
  for (const Candidate& candidate : state.segments) {
    if (candidate.segment.beginNs() == mark.begin_ns && candidate.segment.endNs() == mark.end_ns) {
      return &candidate;
    }
  }
  return nullptr;
}

}  // namespace

DecodedState readStateFile(const std::string& path) {
  const FileContents contents = readFile(path);
  if (!contents.exists) return {nullptr, "there is no such file"};
  if (!contents.error.empty()) return {nullptr, contents.error};
  return decodeState(contents.bytes);
}

void SegmentStore::note(const std::string& path, const std::string& camera,
                        const LearntState& state) {
  paths_.push_back(path);
  for (const Candidate& candidate : state.segments) {
    path_of_.emplace(Key(camera, candidate.segment.beginNs(), candidate.segment.endNs()),
                     paths_.size() - 1);
  }
}

std::string SegmentStore::fileOf(const std::string& camera, const WantedSegment& wanted) const {
  const auto found = path_of_.find(Key(camera, wanted.mark.begin_ns, wanted.mark.end_ns));
  return found == path_of_.end() ? wanted.state_file : paths_[found->second];
}

bool SegmentStore::has(const std::string& camera, const WantedSegment& wanted) const {
  const std::string path = fileOf(camera, wanted);
  std::error_code ignored;
  return !path.empty() && std::filesystem::exists(path, ignored);
}

// Each file is read once.
std::vector<Candidate> SegmentStore::load(const std::string& camera,
                                          const std::vector<WantedSegment>& wanted,
                                          std::vector<std::size_t>* lost) const {
  std::map<std::string, std::vector<std::size_t>> by_file;
  for (std::size_t i = 0; i < wanted.size(); ++i) by_file[fileOf(camera, wanted[i])].push_back(i);
  std::vector<std::optional<Candidate>> found(wanted.size());
  for (const auto& [path, numbers] : by_file) {
    const DecodedState decoded = readStateFile(path);
    if (!decoded.state) continue;
    for (const std::size_t i : numbers) {
      if (const Candidate* candidate = find(*decoded.state, wanted[i].mark)) found[i] = *candidate;
    }
  }
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    if (found[i]) {
      candidates.push_back(std::move(*found[i]));
    } else {
      lost->push_back(i);
    }
  }
  return candidates;
}

}  // namespace camera_self_calibration
