#pragma once

#include "camera_self_calibration/camera/camera.h"
#include "camera_self_calibration/pipeline/front_end.h"
#include "camera_self_calibration/pipeline/learnt_state.h"
#include "camera_self_calibration/pipeline/options.h"
#include "camera_self_calibration/pipeline/results.h"
#include "camera_self_calibration/queue/line_delay.h"
#include "camera_self_calibration/queue/segment_queue.h"
#include "camera_self_calibration/startup/startup.h"

namespace camera_self_calibration {

/// Learns the readout time of a rolling shutter, now and then, and frees observations of it.
class Shutter {
 public:
  /// `rows` of the image.
  Shutter(const Options& options, int rows);

  /// The message with its pixels moved to where a global shutter would have seen them. The front
  /// end may know an older line delay. Before anything is known of the lens (`scene_known` false)
  /// features move as each was seen to.
  KeyframeMessage freed(const KeyframeMessage& message, const Camera& camera,
                        bool scene_known) const;

  /// The candidate evaluated anew, if it was freed of another line delay. None that was well posed
  /// is lost by it.
  Candidate freed(const Candidate& candidate, const Camera& camera) const;
  std::vector<Candidate> freed(const std::vector<Candidate>& candidates,
                               const Camera& camera) const;

  /// Asks the startup batch if it has grown enough since the last time. True if the line delay in
  /// use is another now.
  bool ask(const Startup& startup);

  /// Asks the queue if it has changed enough since the last time, which takes three linearisations.
  /// `just_solved`: this keyframe has cost a joint estimate already.
  bool ask(const SegmentQueue& queue, bool just_solved);

  /// The queue begun anew with these, freed of the line delay in use, where the line delay has not
  /// been asked for in such intrinsics yet, as after a restart or with another lens model: what it
  /// leaves open in them counts in a second solution. How many were taken.
  int solve(const std::vector<Candidate>& candidates, const Camera& start, SegmentQueue* queue);

  /// The queue took so many candidates.
  void noteTaken(int candidates) { taken_ += candidates; }
  /// All of the queue is freed of the line delay in use.
  void noteFreed() { taken_ = 0; }

  /// What an earlier run learnt. A readout time that was given is believed rather than that.
  void restore(const LearntState& state);

  const LineDelay& lineDelay() const { return line_delay_; }
  /// From `camera` on, with the line delay as one of the unknowns.
  QueueStart startFrom(const Camera& camera) const;
  ShutterReport report() const;

 private:
  bool learns_;             // else the readout time was given
  double given_readout_s_;  // that, or where learning starts
  int row_steps_;           // times between rows that an image has
  int threads_;
  LineDelay line_delay_;
  int keyframes_ = 0;  // of the startup batch, when it was asked last
  int taken_ = 0;      // by the queue since it was asked last
};

}  // namespace camera_self_calibration
