#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "camera_self_calibration/pipeline/learnt_state.h"

namespace camera_self_calibration {

/// A segment of some bag of a camera.
struct WantedSegment {
  SegmentMark mark;
  std::size_t bag = 0;     ///< Index of its bag, of the caller's.
  std::string bag_path;    ///< BagRecord::bag.
  std::string state_file;  ///< BagRecord::state_file: where to look if no other file has it.
};

/// In which state files segments lie, so that only those that are wanted need be in memory.
class SegmentStore {
 public:
  /// The segments of a state that was read from `path`; `records` are those of its bags, one at
  /// least, of one camera. A segment that fits several of the bags is not noted: only their own
  /// states tell whose it is.
  void note(const std::string& path, const std::vector<BagRecord>& records,
            const LearntState& state);

  /// Whether the segment can be loaded, as far as is known without reading a file.
  bool has(const std::string& camera, const WantedSegment& wanted) const;

  /// The segments in the order in which they are wanted; those that a file no longer has are left
  /// out, and their numbers (in `wanted`) are added to `lost`.
  std::vector<Candidate> load(const std::string& camera, const std::vector<WantedSegment>& wanted,
                              std::vector<std::size_t>* lost) const;

 private:
  // Camera, bag, begin and end [ns].
  using Key = std::tuple<std::string, std::string, std::int64_t, std::int64_t>;

  std::string fileOf(const std::string& camera, const WantedSegment& wanted) const;

  std::vector<std::string> paths_;
  std::map<Key, std::size_t> path_of_;
};

}  // namespace camera_self_calibration
