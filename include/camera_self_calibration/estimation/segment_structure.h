#pragma once

#include <limits>
#include <vector>

#include "camera_self_calibration/estimation/problem.h"

namespace camera_self_calibration {

/// Which variables of a segment meet in which observations: where each one's part of the normal
/// equations lies. Depends on who sees whom, not on any value.
struct SegmentStructure {
  /// Two keyframes that share observations; all their Jacobians have a common factor.
  struct Pair {
    int reference = 0;
    int observing = 0;
  };

  struct LandmarkPlace {
    int dimension = 1;                 ///< 1: inverse depth; 3: and the bearing.
    bool inverse_depth_fixed = false;  ///< The inverse depth is held: its derivatives are zero.
    int row = 0;  ///< Of its first free variable among the segment's landmark rows.
    /// Of the free poses that it touches, each once, in poses; the reference keyframe's is the
    /// first if it is free.
    int first_entry = 0;
    int entries = 0;
    bool reference_free = false;
    int first_pose = std::numeric_limits<int>::max();  ///< Of the free ones that it touches,
    int last_pose = -1;                                ///< and the last.

    int rows() const { return dimension - (inverse_depth_fixed ? 1 : 0); }
  };

  struct ObservationPlace {
    int pair = 0;
    int entry = -1;  ///< The observing keyframe's; -1 if it is fixed, or the reference itself.
  };

  int free_poses = 0;
  int landmark_rows = 0;
  std::vector<Pair> pairs;                     // in the order of their first observations
  std::vector<LandmarkPlace> landmarks;        // as the segment's
  std::vector<ObservationPlace> observations;  // as the segment's
  std::vector<int> entry_poses;                // per entry: index of the free pose
  std::vector<int> elimination_order;          // landmarks, by their first pose and their last

  /// Memory is kept from one segment to the next.
  void build(const SegmentBlock& block);

 private:
  void placeLandmarks(const SegmentBlock& block);
  void sortByLandmark(const Segment& segment);
  void sortByPoses();
  void placeObservation(const SegmentBlock& block, const Observation& observation,
                        ObservationPlace* place);

  std::vector<int> next_;         // scratch of sortByLandmark
  std::vector<int> order_;        // observations, sorted by landmark
  std::vector<int> pair_of_;      // scratch: [reference * keyframes + observing], -1: none
  std::vector<int> entry_of_;     // scratch: [keyframe], entry of the present landmark
  std::vector<int> landmark_of_;  // scratch: [keyframe], whose entry that is
};

}  // namespace camera_self_calibration
