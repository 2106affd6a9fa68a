#include "rig_problem.h"

#include <ceres/loss_function.h>

#include <algorithm>
#include <numeric>

#include "camera_self_calibration/base/median.h"
#include "camera_self_calibration/reference/constraint.h"

namespace camera_self_calibration {
namespace {

double* rotationOf(Rigid3* pose) { return pose->rotation.coeffs().data(); }
double* positionOf(Rigid3* pose) { return pose->translation.data(); }

// Numbers the poses that an observation depends on.
struct PoseList {
  std::vector<double*> blocks;

  int number(Rigid3* pose) {
    const auto found = std::find(blocks.begin(), blocks.end(), rotationOf(pose));
    if (found != blocks.end()) return static_cast<int>((found - blocks.begin()) / 2);
    blocks.push_back(rotationOf(pose));
    blocks.push_back(positionOf(pose));
    return static_cast<int>(blocks.size() / 2) - 1;
  }
};

// Of each frame, by all cameras.
std::vector<double> observationsOf(const RigSegment& segment) {
  std::vector<double> counts(static_cast<std::size_t>(segment.frames()), 0.0);
  const RigViews views{static_cast<int>(segment.tracks.size())};
  for (const Segment& tracks : segment.tracks) {
    for (const Observation& seen : tracks.observations) counts[views.frame(seen.keyframe)] += 1.0;
  }
  return counts;
}

}  // namespace

RigProblem::RigProblem(const RigSolveOptions& options, std::vector<RigSegment>* segments, Rig* rig)
    : options_(options), segments_(segments), rig_(rig), charts_(segments->size()) {
  for (const Camera& camera : rig->cameras) intrinsics_.push_back(camera.parameters());
  for (std::size_t s = 0; s < segments->size(); ++s) {
    RigSegment& segment = (*segments)[s];
    toFirstFrame(&segment);
    charts_[s].resize(segment.tracks.size());
    for (int c = 0; c < rig->size(); ++c) addTracks(&segment, c, &charts_[s][c]);
    holdFirst(&segment);
    if (s == 0) holdScale(&segment);
  }
  constrainRig();
}

// The scale's gauge asks for it.
void RigProblem::toFirstFrame(RigSegment* segment) {
  if (segment->frames() == 0) return;
  const Rigid3 first_from_world = segment->world_from_rig.front().inverse();
  for (Rigid3& pose : segment->world_from_rig) pose = first_from_world * pose;
}

void RigProblem::addTracks(RigSegment* segment, int camera, std::vector<Chart>* charts) {
  const Segment& tracks = segment->tracks[camera];
  for (const Landmark& landmark : tracks.landmarks) {
    charts->push_back({0.0, 0.0, landmark.inverse_depth});
  }
  for (const Observation& seen : tracks.observations) {
    addObservation(segment, seen, tracks.landmarks[seen.landmark], &(*charts)[seen.landmark]);
    clusters_.push_back(landmarks_ + seen.landmark);
  }
  landmarks_ += static_cast<int>(tracks.landmarks.size());
}

void RigProblem::addObservation(RigSegment* segment, const Observation& seen,
                                const Landmark& landmark, Chart* chart) {
  const RigViews views{rig_->size()};
  const int camera = views.camera(seen.keyframe);
  const int reference_camera = views.camera(landmark.reference);
  const int frame = views.frame(seen.keyframe);
  const int reference_frame = views.frame(landmark.reference);
  PoseList poses;
  RigResidual::Roles roles;
  if (frame != reference_frame) {
    roles.observing_rig = poses.number(&segment->world_from_rig[frame]);
    roles.reference_rig = poses.number(&segment->world_from_rig[reference_frame]);
  }
  if (frame != reference_frame || camera != reference_camera) {
    roles.observing_camera = poses.number(&rig_->rig_from_camera[camera]);
    roles.reference_camera = poses.number(&rig_->rig_from_camera[reference_camera]);
  }
  roles.count = static_cast<int>(poses.blocks.size() / 2);
  poses.blocks.push_back(chart->data());
  poses.blocks.push_back(intrinsics_[camera].data());
  ceres::LossFunction* loss = options_.huber > 0.0 ? new ceres::HuberLoss(options_.huber) : nullptr;
  problem_.AddResidualBlock(
      new RigResidual(rig_->cameras[camera], roles, landmark.bearing, seen.pixel, seen.sigma), loss,
      poses.blocks);
}

void RigProblem::holdFirst(RigSegment* segment) {
  for (std::size_t k = 0; k < segment->world_from_rig.size(); ++k) {
    Rigid3& pose = segment->world_from_rig[k];
    if (!problem_.HasParameterBlock(rotationOf(&pose))) continue;
    keepUnitQuaternion(&problem_, rotationOf(&pose));
    if (k > 0) continue;
    problem_.SetParameterBlockConstant(rotationOf(&pose));
    problem_.SetParameterBlockConstant(positionOf(&pose));
  }
}

// A frame in which little is seen may stand anywhere, and would hold nothing.
void RigProblem::holdScale(RigSegment* segment) {
  const std::vector<double> seen = observationsOf(*segment);
  const double enough = 0.5 * median(seen, 0.0);
  Rigid3* farthest = nullptr;
  for (std::size_t k = 1; k < seen.size(); ++k) {
    Rigid3& pose = segment->world_from_rig[k];
    if (seen[k] < enough || !problem_.HasParameterBlock(positionOf(&pose))) continue;
    if (farthest == nullptr || pose.translation.norm() > farthest->translation.norm()) {
      farthest = &pose;
    }
  }
  // Keeps the vector's length, whatever it is.
  if (farthest != nullptr && farthest->translation.norm() > 0.0) {
    keepUnitVector(&problem_, positionOf(farthest));
  }
}

void RigProblem::constrainRig() {
  for (int c = 0; c < rig_->size(); ++c) {
    double* rotation = rotationOf(&rig_->rig_from_camera[c]);
    double* position = positionOf(&rig_->rig_from_camera[c]);
    if (problem_.HasParameterBlock(rotation)) {
      keepUnitQuaternion(&problem_, rotation);
      if (c == 0) {
        problem_.SetParameterBlockConstant(rotation);
        problem_.SetParameterBlockConstant(position);
      }
    }
    double* block = intrinsics_[c].data();
    if (!problem_.HasParameterBlock(block)) continue;
    const Camera& camera = rig_->cameras[c];
    if (held(options_, c)) {
      problem_.SetParameterBlockConstant(block);
    } else if (camera.estimatedCount() < camera.parameterCount()) {
      std::vector<int> held(camera.parameterCount() - camera.estimatedCount());
      std::iota(held.begin(), held.end(), camera.estimatedCount());
      keepEntries(&problem_, block, camera.parameterCount(), held);
    }
  }
}

bool RigProblem::shared(const double* block) const {
  for (int c = 0; c < rig_->size(); ++c) {
    if (block == rotationOf(&rig_->rig_from_camera[c]) ||
        block == positionOf(&rig_->rig_from_camera[c]) || block == intrinsics_[c].data()) {
      return true;
    }
  }
  return false;
}

int RigProblem::sharedSize() {
  int size = 0;
  for (double* block : freeBlocks()) {
    if (shared(block)) size += freedomsOf(problem_, block);
  }
  return size;
}

std::vector<double*> RigProblem::freeBlocks() {
  std::vector<double*> blocks;
  problem_.GetParameterBlocks(&blocks);
  blocks.erase(std::remove_if(blocks.begin(), blocks.end(),
                              [&](double* block) {  // not const for Ceres before 2.0
                                return shared(block) || problem_.IsParameterBlockConstant(block);
                              }),
               blocks.end());
  const auto add = [&](double* block) {
    if (problem_.HasParameterBlock(block) && !problem_.IsParameterBlockConstant(block)) {
      blocks.push_back(block);
    }
  };
  for (Rigid3& pose : rig_->rig_from_camera) {
    add(rotationOf(&pose));
    add(positionOf(&pose));
  }
  for (Intrinsics& intrinsics : intrinsics_) add(intrinsics.data());
  return blocks;
}

void RigProblem::takeOver() {
  for (std::size_t s = 0; s < segments_->size(); ++s) {
    for (std::size_t c = 0; c < charts_[s].size(); ++c) {
      Segment& tracks = (*segments_)[s].tracks[c];
      for (std::size_t l = 0; l < tracks.landmarks.size(); ++l) {
        const Chart& chart = charts_[s][c][l];
        Eigen::Vector3d& bearing = tracks.landmarks[l].bearing;
        bearing =
            (bearing + tangentBasis(bearing) * Eigen::Vector2d(chart[0], chart[1])).normalized();
        tracks.landmarks[l].inverse_depth = chart[2];
      }
    }
  }
  for (int c = 0; c < rig_->size(); ++c) rig_->cameras[c].setParameters(intrinsics_[c]);
  for (RigSegment& segment : *segments_) placeViews(*rig_, &segment);
}

}  // namespace camera_self_calibration
