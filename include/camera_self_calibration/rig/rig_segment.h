#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "camera_self_calibration/map/segment.h"
#include "camera_self_calibration/rig/rig.h"
#include "camera_self_calibration/tracking/image_view.h"
#include "camera_self_calibration/tracking/track.h"

namespace camera_self_calibration {

/// What one camera contributes to a keyframe of the rig.
struct RigView {
  std::vector<Track> tracks;                ///< As its own tracker follows them.
  std::optional<Rigid3> world_from_camera;  ///< In the camera's own map; none where it has none.
  std::uint64_t map_id = 0;  ///< Poses of one camera's different maps do not compare.
  ImageView image;           ///< Empty where there is none (tracks from elsewhere).
};

/// A keyframe of the rig: the images that its cameras took at one time.
struct RigFrame {
  std::int64_t stamp_ns = 0;
  std::vector<RigView> views;  ///< One for each camera.
};

/// In the order of time, of one map of the first camera: what a segment is made of.
using RigFrames = std::vector<RigFrame>;

/// A feature of one camera's track as another camera sees it at the same time.
struct SeenAcross {
  int frame = 0;  ///< Index into the frames of a segment.
  int from = 0;   ///< The camera that follows the track,
  std::int64_t track_id = 0;
  int to = 0;  ///< and the other one.
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double sigma = 1.0;  ///< Per axis [px].
};

/// A segment of the rig's way that stands for itself: what Segment is for one camera. Poses are the
/// rig's; the tracks of each camera are a Segment of their own over the images of all cameras
/// (RigViews), so that another camera's view of a landmark is an observation like any other.
struct RigSegment {
  std::vector<std::int64_t> stamps_ns;  ///< Of the frames, in the order of time.
  std::vector<Rigid3> world_from_rig;   ///< Of each frame.
  std::vector<Segment> tracks;          ///< One for each camera.

  int frames() const { return static_cast<int>(stamps_ns.size()); }
};

/// Builds a segment from frames of one map of the first camera, whose poses are the rig's. Each
/// track that is seen in at least `min_views` frames is a landmark with a bearing of its own
/// (Landmark::anchored is false), as deep as the frames' poses say.
RigSegment makeRigSegment(const std::vector<RigFrame>& frames, const Rig& rig, int min_views = 3);

/// Puts the views where the rig is: poses and cameras of the keyframes of all tracks, for whatever
/// looks at them as at the segment of one camera (gates, predictions).
void placeViews(const Rig& rig, RigSegment* segment);

/// Adds what cameras see of each other's landmarks; of tracks that are no landmarks nothing.
void addSeenAcross(const std::vector<SeenAcross>& seen, RigSegment* segment);

/// Removes all observations of landmarks by other cameras than their own.
void removeSeenAcross(RigSegment* segment);

/// Number of landmarks of a camera that at least one other camera sees.
int sharedLandmarks(const RigSegment& segment, int camera);

/// Multiplies all lengths: positions by `factor`, inverse depths by its inverse.
void scaleSegment(double factor, RigSegment* segment);

}  // namespace camera_self_calibration
