#include "rig_trajectory.h"

#include <map>

namespace camera_self_calibration {
namespace {

/// A keyframe in the camera's own map and in the rig's unit.
struct Anchor {
  int segment = 0;
  std::uint64_t map_id = 0;
  std::int64_t stamp_ns = 0;
  Rigid3 own;
  Rigid3 rig;
};

std::vector<Anchor> anchorsOf(const std::vector<TimedPose>& way,
                              const std::vector<RigPose>& poses) {
  std::map<std::int64_t, const TimedPose*> own;
  for (const TimedPose& pose : way) own[pose.stamp_ns] = &pose;
  std::vector<Anchor> anchors;
  for (const RigPose& pose : poses) {
    const auto found = own.find(pose.stamp_ns);
    if (found == own.end()) continue;
    anchors.push_back({pose.segment, found->second->map_id, pose.stamp_ns,
                       found->second->world_from_camera, pose.world_from_rig});
  }
  return anchors;
}

/// Units of the rig per unit of the map, of each segment: from the length of the way.
std::map<int, double> scalesOf(const std::vector<Anchor>& anchors) {
  std::map<int, std::pair<double, double>> ways;
  for (std::size_t i = 1; i < anchors.size(); ++i) {
    const Anchor& a = anchors[i - 1];
    const Anchor& b = anchors[i];
    if (a.segment != b.segment) continue;
    ways[a.segment].first += (b.rig.translation - a.rig.translation).norm();
    ways[a.segment].second += (b.own.translation - a.own.translation).norm();
  }
  std::map<int, double> scales;
  for (const auto& [segment, way] : ways) {
    scales[segment] = way.second > 0.0 ? way.first / way.second : 1.0;
  }
  return scales;
}

Rigid3 placed(const Anchor& anchor, double scale, const Rigid3& own) {
  Rigid3 step = anchor.own.inverse() * own;
  step.translation *= scale;
  return anchor.rig * step;
}

/// Moves each segment to where the one before it, if it is of the same map, says that it begins.
void chain(std::map<int, double> scales, std::vector<Anchor>* anchors) {
  Rigid3 moved;
  for (std::size_t i = 0; i < anchors->size(); ++i) {
    Anchor& anchor = (*anchors)[i];
    if (i > 0 && anchor.segment != (*anchors)[i - 1].segment) {
      const Anchor& before = (*anchors)[i - 1];
      moved = before.map_id == anchor.map_id
                  ? placed(before, scales[before.segment], anchor.own) * anchor.rig.inverse()
                  : Rigid3();
    }
    anchor.rig = moved * anchor.rig;
  }
}

}  // namespace

std::vector<TimedPose> onRig(const std::vector<TimedPose>& way, const std::vector<RigPose>& poses) {
  std::vector<Anchor> anchors = anchorsOf(way, poses);
  std::map<int, double> scales = scalesOf(anchors);
  chain(scales, &anchors);
  std::vector<TimedPose> result;
  for (const TimedPose& pose : way) {
    const Anchor* nearest = nullptr;
    for (const Anchor& anchor : anchors) {
      if (anchor.map_id != pose.map_id) continue;
      if (nearest != nullptr && anchor.stamp_ns > pose.stamp_ns) break;
      nearest = &anchor;
    }
    if (nearest == nullptr) continue;
    result.push_back(pose);
    result.back().world_from_camera =
        placed(*nearest, scales[nearest->segment], pose.world_from_camera);
  }
  return result;
}

}  // namespace camera_self_calibration
