#include "camera_self_calibration/fleet/segment_store.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/state_file.h"

namespace camera_self_calibration {
namespace {

bool covers(const SegmentMark& mark, const Segment& segment) {
  return segment.beginNs() == mark.begin_ns && segment.endNs() == mark.end_ns;
}

// The bag that shows the segment; null where several may.
const BagRecord* bagOf(const std::vector<BagRecord>& records, const Segment& segment) {
  const BagRecord* found = nullptr;
  for (const BagRecord& record : records) {
    const bool has = std::any_of(record.segments.begin(), record.segments.end(),
                                 [&](const SegmentMark& mark) { return covers(mark, segment); });
    if (has && found) return nullptr;
    if (has) found = &record;
  }
  return found;
}

// A state that was learnt live has no record of its only bag.
const Candidate* find(const LearntState& state, const WantedSegment& wanted) {
  for (const Candidate& candidate : state.segments) {
    if (!covers(wanted.mark, candidate.segment)) continue;
    const BagRecord* bag = bagOf(state.bags, candidate.segment);
    if (state.bags.empty() || (bag && bag->bag == wanted.bag_path)) return &candidate;
  }
  return nullptr;
}

}  // namespace

void SegmentStore::note(const std::string& path, const std::vector<BagRecord>& records,
                        const LearntState& state) {
  paths_.push_back(path);
  for (const Candidate& candidate : state.segments) {
    const Segment& segment = candidate.segment;
    const BagRecord* bag = bagOf(records, segment);
    if (!bag) continue;
    path_of_.emplace(Key(bag->camera, bag->bag, segment.beginNs(), segment.endNs()),
                     paths_.size() - 1);
  }
}

std::string SegmentStore::fileOf(const std::string& camera, const WantedSegment& wanted) const {
  const auto found =
      path_of_.find(Key(camera, wanted.bag_path, wanted.mark.begin_ns, wanted.mark.end_ns));
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
      if (const Candidate* candidate = find(*decoded.state, wanted[i])) found[i] = *candidate;
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
